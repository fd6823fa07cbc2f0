// SPDX-License-Identifier: Apache-2.0
// Values of options that are more than one number, and the command line as text. All parsers throw UsageError that names the
// option.
#ifndef QUINTET_CLI_VALUES_H
#define QUINTET_CLI_VALUES_H

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/math.h"
#include "job/request.h"
#include "output/plan.h"
#include "render/tone_map/tone_map.h"

namespace quintet::cli {

// A number in [min, max]; empty for an empty text.
std::optional<double> parseReal(const std::string& option, const std::string& text, double min, double max);
std::optional<std::uint64_t> parseInteger(const std::string& option, const std::string& text, double min, double max);

// "1500000", "64M", "2.5G": at least 1 byte; K, M, G and T are powers of 1024. Empty for an empty text.
std::optional<std::size_t> parseBytes(const std::string& option, const std::string& text);

uvec2 parseSize(const std::string& option, const std::string& text);             // "800x600"; "800" leaves the height 0
render::Region parseRegion(const std::string& option, const std::string& text);  // "x,y,width,height", pixels
// "center", "all", "x,y" or "x,y,width,height", pixels; empty for an empty text.
std::optional<job::PrintRequest> parsePrint(const std::string& option, const std::string& text);
std::optional<vec3> parsePoint(const std::string& option, const std::string& text);  // "1,2.5,-3"
// "0,0.5" or "-0.25,0.25": open and close, in frames; empty for an empty text.
std::optional<job::ShutterRequest> parseShutter(const std::string& option, const std::string& text);
job::BatchRange parseBatches(const std::string& option, const std::string& text);  // "3" or "0-7"
// "0-7" or "0:7": first frame and number of frames, the last one below `limit`.
std::pair<std::uint32_t, std::uint32_t> parseFrames(const std::string& option, const std::string& text, double limit);
std::optional<render::ToneMap> parseToneMap(const std::string& option, const std::string& name);

// The position of `name` in `names`.
std::size_t parseChoice(const std::string& option, const std::string& name, const std::vector<std::string>& names);
// "half", "float"; "dwaa", "dwaa:45"; "64". Empty texts leave the defaults; nothing if all are empty.
std::optional<output::ExrFormat> parseExrFormat(const std::string& type, const std::string& compression,
                                                const std::string& tiles);

// The command as the user typed it, with quotes where a shell needs them.
std::string commandLine(std::string_view command, std::span<const std::string> arguments);

}  // namespace quintet::cli
#endif

// Values of options that are more than one number. All throw UsageError "--size: 0x5 …".
#ifndef QUINTET_APP_VALUES_H
#define QUINTET_APP_VALUES_H

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "render/film.h"
#include "render/tone_map.h"

namespace quintet::app {

inline constexpr std::uint32_t kMaxSide = 65536;  // pixels

// "800x600"; "800" leaves the height 0.
uvec2 parseSize(const std::string& option, const std::string& text);
// "x,y,width,height" in pixels from the top left corner.
render::Region parseRegion(const std::string& option, const std::string& text);
// "1,2.5,-3", finite.
vec3 parseVec3(const std::string& option, const std::string& text);
render::ToneMap parseToneMap(const std::string& option, const std::string& name);
// Not a number, or outside [min, max]: UsageError.
double parseNumber(const std::string& option, const std::string& text, double min, double max);

// "a", or "'a b'" where a shell would need the quotes.
std::string shellQuoted(std::string_view text);
std::string commandLine(std::string_view command, std::span<const std::string> arguments);

// Text of files and devices on one line: control characters become '?'.
std::string plain(std::string_view text);

// "3.2 MiB"
std::string bytesText(std::uint64_t bytes);
// "75 s", "2:05", "1:02:05"
std::string durationText(double seconds);
// " (did you mean 'size'?)" or nothing
std::string suggestion(const std::string& name, const std::vector<std::string>& candidates);

}  // namespace quintet::app
#endif

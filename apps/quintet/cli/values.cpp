// SPDX-License-Identifier: Apache-2.0
#include "cli/values.h"

#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/parse.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "io/codec.h"

namespace quintet::cli {
namespace {

constexpr std::uint32_t kMinTile = 8;  // pixels; a file of smaller ones consists of headers

[[noreturn]] void fail(const std::string& option, const std::string& text, const std::string& problem) {
  throw UsageError(fmt::format("{}: '{}' {}", option, printable(text), problem));
}

}  // namespace

std::optional<double> parseReal(const std::string& option, const std::string& text, double min, double max) {
  if (text.empty()) return std::nullopt;
  const std::optional<double> value = parseNumber<double>(text);
  if (!value || !std::isfinite(*value)) fail(option, text, "is not a number");
  if (*value >= min && *value <= max) return value;
  if (max < std::numeric_limits<double>::infinity()) fail(option, text, fmt::format("is not in [{}, {}]", min, max));
  fail(option, text, fmt::format("is less than {}", min));
}

std::optional<std::uint64_t> parseInteger(const std::string& option, const std::string& text, double min, double max) {
  const std::optional<double> value = parseReal(option, text, min, max);
  if (!value) return std::nullopt;
  if (std::floor(*value) != *value) fail(option, text, "is not an integer");
  return static_cast<std::uint64_t>(*value);
}

std::optional<std::size_t> parseBytes(const std::string& option, const std::string& text) {
  if (text.empty()) return std::nullopt;
  constexpr std::string_view kUnits = "KMGT";
  const std::size_t unit = kUnits.find(text.back());
  const double factor = unit == std::string_view::npos ? 1.0 : std::exp2(10.0 * static_cast<double>(unit + 1));
  const std::optional<double> value =
      parseNumber<double>(unit == std::string_view::npos ? text : text.substr(0, text.size() - 1));
  constexpr double kMax = 1e15;
  if (!value || !(*value * factor >= 1.0 && *value * factor <= kMax))
    fail(option, text, "is not a number of bytes like 500000000, 512M or 2.5G, at least 1");
  return static_cast<std::size_t>(*value * factor);
}

uvec2 parseSize(const std::string& option, const std::string& text) {
  const std::string form = fmt::format("is not a size in pixels like 1280x720, each 1 to {}", io::kMaxImageSide);
  const std::vector<std::string> parts = splitText(text, 'x');
  if (parts.size() > 2) fail(option, text, form);
  uvec2 size{0};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::optional<std::uint32_t> value = parseNumber<std::uint32_t>(parts[i]);
    if (!value || *value < 1 || *value > io::kMaxImageSide) fail(option, text, form);
    size[static_cast<glm::length_t>(i)] = *value;
  }
  return size;
}

render::Region parseRegion(const std::string& option, const std::string& text) {
  const std::vector<std::string> parts = splitText(text, ',');
  std::array<std::uint32_t, 4> values{};
  bool good = parts.size() == values.size();
  for (std::size_t i = 0; good && i < values.size(); ++i) {
    const std::optional<std::uint32_t> value = parseNumber<std::uint32_t>(parts[i]);
    good = value && *value <= io::kMaxImageSide && (i < 2 || *value > 0);
    if (good) values[i] = *value;
  }
  if (!good) fail(option, text, "is not a part of the image like 100,50,320,200 (x,y,width,height in pixels)");
  return {values[0], values[1], values[2], values[3]};
}

std::optional<job::PrintRequest> parsePrint(const std::string& option, const std::string& text) {
  if (text.empty()) return std::nullopt;
  job::PrintRequest request;
  if (text == "center") return request;
  request.all = text == "all";
  if (request.all) return request;
  const std::vector<std::string> parts = splitText(text, ',');
  std::vector<std::uint32_t> values;
  for (const std::string& part : parts)
    if (const auto value = parseNumber<std::uint32_t>(part); value && *value <= io::kMaxImageSide)
      values.push_back(*value);
  const bool isPixel = parts.size() == 2 && values.size() == 2;
  const bool isRegion = parts.size() == 4 && values.size() == 4 && values[2] > 0 && values[3] > 0;
  if (!isPixel && !isRegion)
    fail(option, text, "is neither a pixel like 100,50, a part of the image like 100,50,3,2, center, nor all");
  request.pixels = {values[0], values[1], isRegion ? values[2] : 1, isRegion ? values[3] : 1};
  return request;
}

std::optional<vec3> parsePoint(const std::string& option, const std::string& text) {
  if (text.empty()) return std::nullopt;
  const std::optional<vec3> value = parseVec3(text);
  if (!value) fail(option, text, "is not three numbers like 1,2.5,-3");
  return value;
}

std::optional<job::ShutterRequest> parseShutter(const std::string& option, const std::string& text) {
  if (text.empty()) return std::nullopt;
  const std::vector<std::string> parts = splitText(text, ',');
  const std::optional<double> open = parseNumber<double>(parts.front()), close = parseNumber<double>(parts.back());
  const auto isValid = [](const std::optional<double>& time) { return time && std::abs(*time) <= job::kMaxShutter; };
  if (parts.size() != 2 || !isValid(open) || !isValid(close) || *close < *open)
    fail(option, text,
         fmt::format("is not OPEN,CLOSE with OPEN <= CLOSE: frames from {} to {}, like 0,0.5", -job::kMaxShutter,
                     job::kMaxShutter));
  return job::ShutterRequest{*open, *close};
}

job::BatchRange parseBatches(const std::string& option, const std::string& text) {
  const std::vector<std::string> parts = splitText(text, '-');
  const std::optional<std::uint64_t> first = parseNumber<std::uint64_t>(parts.front());
  const std::optional<std::uint64_t> last = parseNumber<std::uint64_t>(parts.back());
  if (!first || !last || parts.size() > 2 || *first > *last)
    fail(option, text,
         fmt::format("is not A-B with A <= B: batches of {} samples from 0, B included", render::kBatchSamples));
  return {*first, *last};
}

std::pair<std::uint32_t, std::uint32_t> parseFrames(const std::string& option, const std::string& text, double limit) {
  const std::vector<std::string> parts = splitText(text, text.find(':') != text.npos ? ':' : '-');
  const std::optional<std::uint32_t> first = parseNumber<std::uint32_t>(parts.front());
  const std::optional<std::uint32_t> last = parseNumber<std::uint32_t>(parts.back());
  if (!first || !last || parts.size() > 2 || *first > *last || *last >= limit)
    fail(option, text, "is not A-B with A <= B: frames from 0, B included");
  return {*first, *last - *first + 1};
}

std::size_t parseChoice(const std::string& option, const std::string& name, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return i;
  throw UsageError(fmt::format("{}: unknown value '{}'{}; available: {}", option, printable(name),
                               suggestion(name, names), fmt::join(names, ", ")));
}

std::optional<render::ToneMap> parseToneMap(const std::string& option, const std::string& name) {
  if (name.empty()) return std::nullopt;
  return static_cast<render::ToneMap>(parseChoice(option, name, render::toneMapNames()));
}

std::optional<output::ExrFormat> parseExrFormat(const std::string& type, const std::string& compression,
                                                const std::string& tiles) {
  if (type.empty() && compression.empty() && tiles.empty()) return std::nullopt;
  output::ExrFormat format;
  if (!type.empty())
    format.colors = parseChoice("--exr-type", type, {"half", "float"}) == 0 ? io::ExrType::half : io::ExrType::f32;
  if (const auto side = parseInteger("--exr-tiles", tiles, kMinTile, io::kMaxExrTile))
    format.options.tileSize = static_cast<std::uint32_t>(*side);
  if (compression.empty()) return format;

  const std::string option = "--exr-compression";
  const std::size_t colon = compression.find(':');
  const std::string name = compression.substr(0, colon);
  format.options.compression = static_cast<io::ExrCompression>(parseChoice(option, name, io::exrCompressionNames()));
  if (colon == compression.npos) return format;
  const std::string level = compression.substr(colon + 1);
  if (level.empty()) fail(option, compression, "has no level after the colon");
  switch (format.options.compression) {
    case io::ExrCompression::zip:
    case io::ExrCompression::zips:
      format.options.level = static_cast<float>(*parseInteger(option, level, 1, 9));
      return format;
    case io::ExrCompression::dwaa:
    case io::ExrCompression::dwab:
      format.options.level = static_cast<float>(*parseReal(option, level, 0, 10000));
      return format;
    default: throw UsageError(fmt::format("{}: {} has no level", option, name));
  }
}

std::string commandLine(std::string_view command, std::span<const std::string> arguments) {
  std::string line = fmt::format("quintet {}", command);
  for (const std::string& argument : arguments) line += " " + shellQuoted(argument);
  return line;
}

}  // namespace quintet::cli

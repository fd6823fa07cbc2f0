#include "values.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "program/parameter.h"

namespace quintet::app {
namespace {

[[noreturn]] void fail(const std::string& option, const std::string& text, const std::string& problem) {
  throw UsageError(fmt::format("{}: '{}' {}", option, text, problem));
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

// The whole text, or nothing.
template <class T>
std::optional<T> number(const std::string& text) {
  const char* begin = text.data();
  const char* end = begin + text.size();
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') ++begin;
  T value{};
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc{} || stop != end || text.empty()) return std::nullopt;
  return value;
}

}  // namespace

uvec2 parseSize(const std::string& option, const std::string& text) {
  static const std::string kForm = fmt::format("is not a size in pixels like 1280x720, each 1 to {}", kMaxSide);
  const auto parts = split(text, 'x');
  if (parts.size() > 2) fail(option, text, kForm);
  uvec2 size{0};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto value = number<std::uint32_t>(parts[i]);
    if (!value || *value < 1 || *value > kMaxSide) fail(option, text, kForm);
    size[static_cast<glm::length_t>(i)] = *value;
  }
  return size;
}

render::Region parseRegion(const std::string& option, const std::string& text) {
  const auto parts = split(text, ',');
  std::array<std::uint32_t, 4> values{};
  bool good = parts.size() == values.size();
  for (std::size_t i = 0; good && i < values.size(); ++i) {
    const auto value = number<std::uint32_t>(parts[i]);
    good = value && *value <= kMaxSide && (i < 2 || *value > 0);
    if (good) values[i] = *value;
  }
  if (!good) fail(option, text, "is not a part of the image like 100,50,320,200 (x,y,width,height in pixels)");
  return {values[0], values[1], values[2], values[3]};
}

vec3 parseVec3(const std::string& option, const std::string& text) {
  const auto parts = split(text, ',');
  vec3 result{0.0f};
  bool good = parts.size() == 3;
  for (std::size_t i = 0; good && i < 3; ++i) {
    const auto value = number<float>(parts[i]);
    good = value && std::isfinite(*value);
    if (good) result[static_cast<glm::length_t>(i)] = *value;
  }
  if (!good) fail(option, text, "is not three numbers like 1,2.5,-3");
  return result;
}

render::ToneMap parseToneMap(const std::string& option, const std::string& name) {
  const std::vector<std::string> names = render::toneMapNames();
  const auto toneMap = render::toneMapByName(name);
  if (!toneMap)
    throw UsageError(fmt::format("{}: there is no '{}'{}; there are {}", option, name, suggestion(name, names),
                                 fmt::join(names, ", ")));
  return *toneMap;
}

double parseNumber(const std::string& option, const std::string& text, double min, double max) {
  const auto value = number<double>(text);
  if (!value || !std::isfinite(*value)) fail(option, text, "is not a number");
  if (*value >= min && *value <= max) return *value;
  if (max < std::numeric_limits<double>::infinity()) fail(option, text, fmt::format("is not in [{}, {}]", min, max));
  fail(option, text, fmt::format("is less than {}", min));
}

std::string shellQuoted(std::string_view text) {
  constexpr std::string_view kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-./,=:+@%";
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string_view::npos) return std::string(text);
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string commandLine(std::string_view command, std::span<const std::string> arguments) {
  std::string line = fmt::format("quintet {}", command);
  for (const std::string& argument : arguments) line += " " + shellQuoted(argument);
  return line;
}

std::string plain(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return result;
}

std::string bytesText(std::uint64_t bytes) {
  constexpr std::array kUnits{"bytes", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
  double value = static_cast<double>(bytes);
  std::size_t unit = 0;
  while (value >= 1024.0 && unit + 1 < kUnits.size()) value /= 1024.0, ++unit;
  return unit == 0 ? fmt::format("{} bytes", bytes) : fmt::format("{:.1f} {}", value, kUnits[unit]);
}

std::string durationText(double seconds) {
  if (!(seconds < 1e9)) return "?";
  if (seconds < 10.0) return fmt::format("{:.1f} s", std::max(seconds, 0.0));
  const auto whole = static_cast<long>(std::lround(seconds));
  if (whole < 100) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string suggestion(const std::string& name, const std::vector<std::string>& candidates) {
  const std::string nearest = program::nearestName(name, candidates);
  return nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest);
}

}  // namespace quintet::app

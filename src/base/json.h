// SPDX-License-Identifier: Apache-2.0
// The only way to parse JSON that this program has not written itself. nlohmann's parser needs no stack, but copying,
// comparing and printing a value are recursive: 200,000 nested arrays would overflow the stack. So depth and size are
// checked in the text before it is parsed.
#ifndef QUINTET_BASE_JSON_H
#define QUINTET_BASE_JSON_H

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "base/error.h"

namespace quintet {

inline constexpr int kMaxJsonDepth = 256;  // far above that of any format that Quintet reads
inline constexpr std::size_t kMaxJsonBytes = std::size_t{64} << 20;

struct JsonLimits {
  std::size_t bytes = kMaxJsonBytes;
  bool comments = false;  // // and /* */ are allowed
};

// The text is too large or too deep.
class JsonLimitError : public UsageError {
 public:
  JsonLimitError(const std::string& problem, std::string location)
      : UsageError((location.empty() ? "" : location + ": ") + problem), problem_(problem), location_(location) {}
  const std::string& problem() const { return problem_; }
  const std::string& location() const { return location_; }  // "line 1, column 2"; empty if the text is too large

 private:
  std::string problem_, location_;
};

// "line 1, column 2" of a byte, which counts from 1 as in nlohmann's errors.
std::string lineAndColumn(std::string_view text, std::size_t byte);

// Throws JsonLimitError.
void requireJsonLimits(std::string_view text, const JsonLimits& limits = {});

// Throws JsonLimitError, and what Json::parse() throws.
template <class Json = nlohmann::json>
Json parseJson(std::string_view text, const JsonLimits& limits = {}) {
  requireJsonLimits(text, limits);
  return Json::parse(text, nullptr, true, limits.comments);
}

// The text of a file. Throws FileError for one beyond the limits, and what Json::parse() throws.
template <class Json = nlohmann::json>
Json parseJson(const std::filesystem::path& file, std::string_view text, const JsonLimits& limits = {}) {
  try {
    return parseJson<Json>(text, limits);
  } catch (const JsonLimitError& error) {
    throw FileError(file, error.location(), error.problem());
  }
}

// Nothing for what parseJson() rejects.
template <class Json = nlohmann::json>
std::optional<Json> findJson(std::string_view text, const JsonLimits& limits = {}) {
  try {
    return parseJson<Json>(text, limits);
  } catch (const JsonLimitError&) {
    return {};
  } catch (const typename Json::exception&) {
    return {};
  }
}

}  // namespace quintet
#endif

// Strict, typed access to one table of a scene file: every error names the file, the line, the key and the table,
// and what is not asked for is refused with the nearest name that would have been.
#ifndef QUINTET_SCENE_SCENE_TOML_READER_H
#define QUINTET_SCENE_SCENE_TOML_READER_H

#include <filesystem>
#include <initializer_list>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "scene/toml_value.h"

namespace quintet::scene {

// Throws FileError "file: line N: problem", made safe for one line.
[[noreturn]] void failAt(const std::filesystem::path& file, const TomlValue& at, std::string_view problem);

// "; did you mean 'metallic'?" or nothing.
std::string didYouMean(const std::string& name, const std::vector<std::string>& candidates);

struct NumberRange {
  double low = -std::numeric_limits<float>::max();
  double high = std::numeric_limits<float>::max();
  bool lowExcluded = false;
  bool highExcluded = false;
};
inline constexpr NumberRange kAnyNumber{};
inline constexpr NumberRange kUnit{0.0, 1.0};
inline constexpr NumberRange kPositive{0.0, std::numeric_limits<float>::max(), true};
inline constexpr NumberRange kNotNegative{0.0};

class TomlReader {
 public:
  // `what` stands for the table in messages: "[[spheres]] 'balls'".
  TomlReader(const TomlValue& table, std::string what, const std::filesystem::path& file);

  [[noreturn]] void fail(const TomlValue& at, std::string_view problem) const { failAt(file_, at, problem); }
  const TomlValue& table() const { return table_; }
  const std::string& what() const { return what_; }
  const std::filesystem::path& file() const { return file_; }

  // The key is one that may be there; null if it is not.
  const TomlValue* find(const std::string& key);
  bool has(const std::string& key) { return find(key) != nullptr; }
  const TomlValue& require(const std::string& key);
  // At most one of the keys; null if there is none.
  const TomlValue* findOneOf(std::initializer_list<const char*> keys);

  std::string text(const std::string& key, std::string fallback = {});
  bool boolean(const std::string& key, bool fallback = false);
  std::uint32_t integer(const std::string& key, std::uint32_t fallback, std::uint32_t low, std::uint32_t high);
  float number(const std::string& key, float fallback, const NumberRange& range = kAnyNumber);
  vec2 pair(const std::string& key, const vec2& fallback, const NumberRange& range = kAnyNumber);
  vec3 triple(const std::string& key, const vec3& fallback, const NumberRange& range = kAnyNumber);
  // Three linear numbers from 0 up, or "#rrggbb", which is decoded from sRGB.
  vec3 color(const std::string& key, const vec3& fallback, const NumberRange& range = kUnit);
  // One of the names; `fallback` if the key is absent.
  std::size_t choice(const std::string& key, const std::vector<std::string>& names, std::size_t fallback);
  // The elements of a list; none if the key is absent.
  const std::vector<TomlValue>& list(const std::string& key);

  // The same for a value that is already at hand; `name` stands for it in messages.
  float toNumber(const TomlValue& value, std::string_view name, const NumberRange& range = kAnyNumber) const;
  std::uint32_t toInteger(const TomlValue& value, std::string_view name, std::uint32_t low, std::uint32_t high) const;
  std::string toText(const TomlValue& value, std::string_view name) const;
  // Exactly `count` numbers.
  std::vector<float> toNumbers(const TomlValue& value, std::string_view name, std::size_t count,
                               const NumberRange& range = kAnyNumber) const;
  vec2 toPair(const TomlValue& value, std::string_view name, const NumberRange& range = kAnyNumber) const;
  vec3 toTriple(const TomlValue& value, std::string_view name, const NumberRange& range = kAnyNumber) const;
  vec3 toColor(const TomlValue& value, std::string_view name, const NumberRange& range) const;
  vec3 toDirection(const TomlValue& value, std::string_view name) const;  // unit length
  const TomlValue& toTable(const TomlValue& value, std::string_view name) const;

  // Refuses the keys that nobody asked for.
  void finish() const;

 private:
  [[noreturn]] void wrong(const TomlValue& value, std::string_view name, std::string_view wanted) const;

  const TomlValue& table_;
  std::string what_;
  const std::filesystem::path& file_;
  std::set<std::string> known_;
};

}  // namespace quintet::scene
#endif

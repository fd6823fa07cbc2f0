// SPDX-License-Identifier: Apache-2.0
// Strict, typed access to one table of a TOML document. Every error is a FileError at "line N" that names the key and
// the table; unknown keys are rejected with the nearest known key.
#ifndef QUINTET_BASE_TOML_READER_H
#define QUINTET_BASE_TOML_READER_H

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "base/toml_value.h"

namespace quintet {

// Throws FileError "file: line N: problem"; unprintable characters of the problem become '?'.
[[noreturn]] void failAt(const std::filesystem::path& file, const TomlValue& at, std::string_view problem);

// An interval of numbers; the default is all finite floats. Numbers beyond the range of float count as its largest numbers,
// and those closer to 0 than the smallest normal float as that one.
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
  // `what` names the table in messages: "[[spheres]] 'balls'". The table is kept by reference.
  TomlReader(const TomlValue& table, std::string what, std::filesystem::path file);

  const TomlValue& table() const { return table_; }
  const std::string& what() const { return what_; }
  const std::filesystem::path& file() const { return file_; }
  int line() const { return table_.line; }

  [[noreturn]] void fail(const TomlValue& at, std::string_view problem) const { failAt(file_, at, problem); }
  // Reports a problem of the whole table.
  [[noreturn]] void fail(std::string_view problem) const { fail(table_, problem); }
  // Reports that '`name`' of this table must be `expected`.
  [[noreturn]] void failType(const TomlValue& value, std::string_view name, std::string_view expected) const;

  // Returns the value of a key, which counts as known from then on; null if it is absent.
  const TomlValue* find(const std::string& key);
  bool has(const std::string& key) { return find(key) != nullptr; }
  // Returns the value of a key that must be present.
  const TomlValue& require(const std::string& key);
  // Returns the value of the only one of the keys that is present; null if none is. Several are an error.
  const TomlValue* findOneOf(std::initializer_list<const char*> keys);

  // Values of optional keys; an absent key gives `fallback`.
  std::string text(const std::string& key, std::string fallback = {});
  bool boolean(const std::string& key, bool fallback = false);
  std::uint32_t integer(const std::string& key, std::uint32_t fallback, std::uint32_t low, std::uint32_t high);
  float number(const std::string& key, float fallback, const NumberRange& range = kAnyNumber);
  double number(const std::string& key, double fallback);  // any number, infinities and NaN included
  vec2 pair(const std::string& key, const vec2& fallback, const NumberRange& range = kAnyNumber);
  vec3 triple(const std::string& key, const vec3& fallback, const NumberRange& range = kAnyNumber);
  // The index of the value in `names`.
  std::size_t choice(const std::string& key, const std::vector<std::string>& names, std::size_t fallback);

  std::string requiredText(const std::string& key);
  // The elements of a list; none if the key is absent.
  const std::vector<TomlValue>& list(const std::string& key);
  // A string or a list of strings, none of them empty; none if the key is absent.
  std::vector<std::string> texts(const std::string& key);
  // The tables of [[key]]; none if the key is absent.
  const std::vector<TomlValue>& tables(const std::string& key);
  // The table of `key = { ... }`; null if the key is absent. The error message shows `example`.
  const TomlValue* inlineTable(const std::string& key, std::string_view example);

  // Typed values of a TOML value; `name` names it in messages.
  float toNumber(const TomlValue& value, std::string_view name, const NumberRange& range = kAnyNumber) const;
  std::uint32_t toInteger(const TomlValue& value, std::string_view name, std::uint32_t low, std::uint32_t high) const;
  std::string toText(const TomlValue& value, std::string_view name) const;
  std::vector<float> toNumbers(const TomlValue& value, std::string_view name, std::size_t count,
                               const NumberRange& range = kAnyNumber) const;
  vec2 toPair(const TomlValue& value, std::string_view name, const NumberRange& range = kAnyNumber) const;
  vec3 toTriple(const TomlValue& value, std::string_view name, const NumberRange& range = kAnyNumber) const;
  vec3 toDirection(const TomlValue& value, std::string_view name) const;  // normalized; a zero vector is an error
  const TomlValue& toTable(const TomlValue& value, std::string_view name) const;

  // Reports the first key that was never looked up.
  void rejectUnknownKeys() const;

 private:
  const TomlValue& table_;
  std::string what_;
  std::filesystem::path file_;
  std::set<std::string> known_;
};

}  // namespace quintet
#endif

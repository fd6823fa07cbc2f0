// SPDX-License-Identifier: Apache-2.0
// A TOML document as plain values that know their line. Only toml_value.cpp includes the parser (toml++).
#ifndef QUINTET_BASE_TOML_VALUE_H
#define QUINTET_BASE_TOML_VALUE_H

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace quintet {

struct TomlMember;

struct TomlValue {
  enum class Kind { boolean, integer, real, text, array, table };
  Kind kind = Kind::table;
  bool boolean = false;
  std::int64_t integer = 0;
  double real = 0.0;  // also set for an integer
  std::string text;
  std::vector<TomlValue> elements;  // of an array
  std::vector<TomlMember> members;  // of a table, sorted by key
  int line = 1;                     // 1-based

  bool isNumber() const { return kind == Kind::integer || kind == Kind::real; }
  // Returns the value of a table's key; null if it is absent.
  const TomlValue* find(std::string_view key) const;
};

struct TomlMember {
  std::string key;
  TomlValue value;
};

// Dots of the deepest dotted key that parseToml accepts.
inline constexpr int kMaxTomlKeyDots = 16;

// Parses a document. Throws FileError at "line N" for syntax errors, for dates and times, which no file of this project
// uses, and for nesting that would overflow the stack.
TomlValue parseToml(std::string_view text, const std::filesystem::path& file);

}  // namespace quintet
#endif

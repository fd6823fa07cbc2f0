// A TOML document as plain values that know their line. Only this file's source knows the parser.
#ifndef QUINTET_SCENE_TOML_VALUE_H
#define QUINTET_SCENE_TOML_VALUE_H

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace quintet::scene {

struct TomlValue {
  enum class Kind { boolean, integer, real, text, array, table };
  Kind kind = Kind::table;
  bool boolean = false;
  std::int64_t integer = 0;
  double real = 0.0;  // also of an integer
  std::string text;
  std::vector<TomlValue> elements;                         // array
  std::vector<std::pair<std::string, TomlValue>> members;  // table, sorted by key
  unsigned line = 1;

  bool isNumber() const { return kind == Kind::integer || kind == Kind::real; }
  const TomlValue* find(std::string_view key) const;
};

// Throws FileError "file: line 3: ...": what the parser says, or a date or time, which have no place in a scene.
TomlValue parseToml(std::string_view text, const std::filesystem::path& file);

}  // namespace quintet::scene
#endif

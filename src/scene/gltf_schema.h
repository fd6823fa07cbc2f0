// The shape of a glTF file as one table (gltf_schema.cpp): every property that the importer reads, with
// its type, range and the array that an index points into. What passes the check can be read without
// further checks of type or index; what the table does not name never reaches the parser.
#ifndef QUINTET_SCENE_GLTF_SCHEMA_H
#define QUINTET_SCENE_GLTF_SCHEMA_H

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

namespace quintet::scene {

enum class PropertyKind {
  boolean,
  string,
  strings,
  integer,
  number,
  numbers,
  index,      // into `target`
  indices,    // array of them
  indexMap,   // object of them: a primitive's attributes
  indexMaps,  // array of those: morph targets
  integerMap,
  object,
  objects,
};

// An array of the file that indices may point into, by its JSON pointer.
struct Collection {
  const char* pointer;
  const char* noun;
};

struct Property {
  std::string_view name;
  PropertyKind kind;
  bool required = false;
  double low = -std::numeric_limits<double>::infinity();  // integer, number, numbers: each element
  double high = std::numeric_limits<double>::infinity();
  std::size_t minCount = 0;  // numbers: how many
  std::size_t maxCount = std::numeric_limits<std::size_t>::max();
  const Collection* target = nullptr;
  std::span<const Property> object{};           // object, objects: what is inside
  std::span<const std::string_view> choices{};  // string
  std::span<const int> values{};                // integer
};

// Returns the part of `root` that the table names (strings are moved out of it). Integral numbers that were
// written as 1.0 become integers. Throws FileError with the JSON pointer of the first violation.
nlohmann::json checkSchema(const std::filesystem::path& file, nlohmann::json& root);

}  // namespace quintet::scene
#endif

// SPDX-License-Identifier: Apache-2.0
// Checks the JSON of a glTF file against one table of all properties that the importer reads: type, range, and the
// array that an index points into.
#ifndef QUINTET_SCENE_GLTF_SCHEMA_H
#define QUINTET_SCENE_GLTF_SCHEMA_H

#include <cstddef>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace quintet::scene {

// Properties that the importer does not read, of objects of one type.
struct UnreadProperty {
  enum class Cause {
    noEffect,   // cannot change the image
    extension,  // of an extension that is not supported, or not for this type of object
    unknown,    // not a property of glTF or of a supported extension
  };
  Cause cause;
  std::string name;      // of the property
  std::string location;  // JSON pointer of the first one
  std::string reason;    // why it has no effect; otherwise empty
  std::size_t count = 1;
};

// Objects of one supported extension.
struct ExtensionUse {
  std::string location;  // JSON pointer of the first one
  std::size_t count = 0;
};

struct CheckedSchema {
  // The part of the JSON that the table names. Its types and indices need no further checks. Integers written as 1.0
  // become integers, and numbers beyond the range of float its largest numbers.
  nlohmann::json json;
  std::vector<UnreadProperty> unread;
  std::map<std::string, ExtensionUse> extensions;  // by name
};

// Moves strings out of `root`. Throws FileError with the JSON pointer of the first violation.
CheckedSchema checkSchema(const std::filesystem::path& file, nlohmann::json& root);

}  // namespace quintet::scene
#endif

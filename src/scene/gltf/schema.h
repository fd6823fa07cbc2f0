// SPDX-License-Identifier: Apache-2.0
// Checks the JSON of a glTF file against one table of all properties that the importer reads: type, range, and the
// array that an index points into.
#ifndef QUINTET_SCENE_GLTF_SCHEMA_H
#define QUINTET_SCENE_GLTF_SCHEMA_H

#include <filesystem>
#include <nlohmann/json.hpp>

namespace quintet::scene {

// Returns the part of `root` that the table names; strings are moved out of `root`. Its types and indices need no
// further checks. Integers written as 1.0 become integers. Throws FileError with the JSON pointer of the first
// violation.
nlohmann::json checkSchema(const std::filesystem::path& file, nlohmann::json& root);

}  // namespace quintet::scene
#endif

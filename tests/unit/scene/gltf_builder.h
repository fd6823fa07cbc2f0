// SPDX-License-Identifier: Apache-2.0
// Builds small glTF files in tests: JSON and one buffer, as .glb, or as .gltf with a data URI.
#ifndef QUINTET_TESTS_GLTF_BUILDER_H
#define QUINTET_TESTS_GLTF_BUILDER_H

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "scene/model/scene.h"
#include "temp_folder.h"

namespace quintet::test {

using Json = nlohmann::json;

// glTF's component types.
inline constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125,
                     kFloat = 5126;

template <class T>
constexpr int componentTypeOf() {
  if constexpr (std::is_same_v<T, std::int8_t>)
    return kByte;
  else if constexpr (std::is_same_v<T, std::uint8_t>)
    return kUnsignedByte;
  else if constexpr (std::is_same_v<T, std::int16_t>)
    return kShort;
  else if constexpr (std::is_same_v<T, std::uint16_t>)
    return kUnsignedShort;
  else if constexpr (std::is_same_v<T, std::uint32_t>)
    return kUnsignedInt;
  else
    return kFloat;
}

inline std::size_t componentsOf(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "MAT4") return 16;
  return static_cast<std::size_t>(type[3] - '0');
}

class GltfBuilder {
 public:
  Json root = {{"asset", {{"version", "2.0"}}}};
  std::vector<std::byte> binary;

  // Appends at the next multiple of four and returns the index of the view.
  template <class T>
  int addView(const std::vector<T>& values, int byteStride = 0) {
    binary.resize((binary.size() + 3) / 4 * 4);
    const std::size_t offset = binary.size(), size = values.size() * sizeof(T);
    binary.resize(offset + size);
    if (size > 0) std::memcpy(binary.data() + offset, values.data(), size);
    Json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}};
    if (byteStride > 0) view["byteStride"] = byteStride;
    return add("bufferViews", view);
  }
  // `values` are the components, tightly packed.
  template <class T>
  int addAccessor(const std::vector<T>& values, const std::string& type, bool normalized = false) {
    Json accessor = {{"bufferView", addView(values)},
                     {"componentType", componentTypeOf<T>()},
                     {"count", values.size() / componentsOf(type)},
                     {"type", type}};
    if (normalized) accessor["normalized"] = true;
    return add("accessors", accessor);
  }
  int add(const std::string& array, const Json& object) {
    root[array].push_back(object);
    return static_cast<int>(root[array].size()) - 1;
  }
  // Adds a mesh of one primitive and its node; returns the index of the node.
  int addMesh(const Json& primitive) {
    const int mesh = add("meshes", {{"primitives", Json::array({primitive})}});
    return add("nodes", {{"mesh", mesh}});
  }
  // Adds the triangle (0,0,0) (1,0,0) (0,1,0), not indexed, and its node; returns the position accessor.
  int addTriangle() {
    const int positions = addAccessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    addMesh({{"attributes", {{"POSITION", positions}}}});
    return positions;
  }
  Json& primitive(std::size_t mesh = 0) { return root["meshes"][mesh]["primitives"][0]; }

  std::string json() const;  // `binary` is buffer 0, without uri
  std::vector<std::byte> glb() const;
  std::string gltf() const;  // `binary` is a data URI

  // Writes a temporary .glb and loads it.
  scene::Scene load() const;
};

std::string base64(const std::vector<std::byte>& bytes);
std::vector<std::byte> makeGlb(std::string json, const std::vector<std::byte>* binary);

// Writes "scene.<extension>" to a temporary folder and loads it.
scene::Scene loadBytes(const std::vector<std::byte>& bytes, const std::string& extension = "glb");
scene::Scene loadText(std::string_view text, const std::string& extension = "gltf");

// Loads the file and returns "location: problem" of the FileError, or "" if it loads. The file of the error must be the
// scene.
std::string errorOf(const GltfBuilder&);
std::string errorOfBytes(const std::vector<std::byte>& bytes, const std::string& extension = "glb");
std::string errorOfText(std::string_view text);

// A 2 × 2 PNG: red, green / blue, white.
std::vector<std::byte> tinyPng();

}  // namespace quintet::test
#endif

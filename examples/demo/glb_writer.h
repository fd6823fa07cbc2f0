// SPDX-License-Identifier: Apache-2.0
// Writes a generated scene as one binary glTF 2.0 file: images as embedded PNG, attributes as floats, extensions only
// if a material requires them. The same calls give the same bytes.
#ifndef QUINTET_DEMO_GLB_WRITER_H
#define QUINTET_DEMO_GLB_WRITER_H

#include <cstddef>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "demo/mesh.h"
#include "io/image.h"

namespace quintet::demo {

inline constexpr int kNoTexture = -1;

// Constants of glTF: types of components, and targets of buffer views.
inline constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
inline constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;

// The glTF material with the defaults of the specification, except for `metallic`.
struct Material {
  std::string name;
  vec4 baseColor{1.0f};  // linear
  int baseColorTexture = kNoTexture;
  float metallic = 0.0f;
  float roughness = 1.0f;
  int metallicRoughnessTexture = kNoTexture;
  int normalTexture = kNoTexture;
  float normalScale = 1.0f;
  vec3 emissive{0.0f};       // radiance; above 1 requires KHR_materials_emissive_strength
  float alphaCutoff = 0.0f;  // above 0 sets alpha mode MASK
  bool doubleSided = false;
  float ior = 1.5f;
  float transmission = 0.0f;
  float thickness = 0.0f;  // above 0 means a solid (KHR_materials_volume)
  vec3 attenuationColor{1.0f};
  float attenuationDistance = 0.0f;  // meters; 0 means no attenuation
  float clearcoat = 0.0f;
  float clearcoatRoughness = 0.0f;
  float specular = 1.0f;
};

class GlbWriter {
 public:
  GlbWriter();

  // Return the index of the new object. An image must be u8 or u16.
  int addTexture(const std::string& name, const io::Image& image);
  int addMaterial(const Material& material);
  int addMesh(const std::string& name, const TriangleMesh& mesh, int material);

  // Add nodes to the scene.
  void addInstance(const std::string& name, int mesh, const mat4& worldFromObject = mat4(1.0f));
  void addObject(const std::string& name, const TriangleMesh& mesh, int material);  // a mesh and its only instance
  void addCamera(const std::string& name, vec3 eye, vec3 target, float verticalFovDegrees, float aspect);

  // Bytes of the file.
  std::vector<std::byte> finish() const;

 private:
  int addBufferView(std::span<const std::byte> data, int target);
  template <class T>
  int addAccessor(const std::vector<T>& values, const char* type, int componentType, int target);
  void addNode(nlohmann::ordered_json node, const mat4& worldFromObject);
  nlohmann::ordered_json materialExtensions(const Material& material);

  nlohmann::ordered_json root_;
  std::set<std::string> extensions_;
  std::vector<std::byte> binary_;
};

}  // namespace quintet::demo
#endif

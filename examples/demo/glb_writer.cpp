// SPDX-License-Identifier: Apache-2.0
#include "demo/glb_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "io/codec.h"

namespace quintet::demo {
namespace {

using Json = nlohmann::ordered_json;
static_assert(std::endian::native == std::endian::little, "glTF's buffers are little-endian");

// glTF's constants for component types, targets, filters and wrap modes.
constexpr int kNoTarget = 0;  // of a buffer view
constexpr int kLinear = 9729, kLinearMipmapLinear = 9987, kRepeat = 10497;

// The shortest decimal that reads back as the same float.
Json number(float value) { return std::stod(fmt::format("{}", value)); }

template <class Vector>
Json numbers(const Vector& v) {
  Json array = Json::array();
  for (glm::length_t i = 0; i < v.length(); ++i) array.push_back(number(v[i]));
  return array;
}

Json numbers(const mat4& m) {
  Json array = Json::array();
  for (glm::length_t c = 0; c < 4; ++c) {
    for (glm::length_t r = 0; r < 4; ++r) array.push_back(number(m[c][r]));
  }
  return array;
}

Json textureUse(int texture) { return {{"index", texture}}; }

int lastIndex(const Json& array) { return static_cast<int>(array.size()) - 1; }

void pad(std::vector<std::byte>& bytes, char filler) {
  while (bytes.size() % 4 != 0) bytes.push_back(static_cast<std::byte>(filler));
}

void appendWord(std::vector<std::byte>& bytes, std::size_t value) {
  for (unsigned shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::byte>((value >> shift) & 255u));
}

void appendChunk(std::vector<std::byte>& file, const char* type, std::span<const std::byte> data) {
  appendWord(file, data.size());
  for (int i = 0; i < 4; ++i) file.push_back(static_cast<std::byte>(type[i]));
  file.insert(file.end(), data.begin(), data.end());
}

}  // namespace

GlbWriter::GlbWriter() {
  root_["asset"] = {{"version", "2.0"}, {"generator", "Quintet"}, {"copyright", "Quintet"}};
  root_["scene"] = 0;
  root_["scenes"] = Json::array({{{"nodes", Json::array()}}});
}

int GlbWriter::addTexture(const std::string& name, const io::Image& image) {
  const int view = addBufferView(io::encodePng(image), kNoTarget);
  root_["images"].push_back({{"name", name}, {"mimeType", "image/png"}, {"bufferView", view}});
  if (!root_.contains("samplers")) {
    root_["samplers"] = Json::array(
        {{{"magFilter", kLinear}, {"minFilter", kLinearMipmapLinear}, {"wrapS", kRepeat}, {"wrapT", kRepeat}}});
  }
  root_["textures"].push_back({{"name", name}, {"sampler", 0}, {"source", lastIndex(root_["images"])}});
  return lastIndex(root_["textures"]);
}

int GlbWriter::addMaterial(const Material& m) {
  Json pbr = {{"baseColorFactor", numbers(m.baseColor)},
              {"metallicFactor", number(m.metallic)},
              {"roughnessFactor", number(m.roughness)}};
  if (m.baseColorTexture != kNoTexture) pbr["baseColorTexture"] = textureUse(m.baseColorTexture);
  if (m.metallicRoughnessTexture != kNoTexture) {
    pbr["metallicRoughnessTexture"] = textureUse(m.metallicRoughnessTexture);
  }
  Json material = {{"name", m.name}, {"pbrMetallicRoughness", std::move(pbr)}};
  if (m.normalTexture != kNoTexture) {
    material["normalTexture"] = textureUse(m.normalTexture);
    if (m.normalScale != 1.0f) material["normalTexture"]["scale"] = number(m.normalScale);
  }
  if (m.emissive != vec3(0.0f)) {
    material["emissiveFactor"] = numbers(m.emissive / std::max({m.emissive.x, m.emissive.y, m.emissive.z, 1.0f}));
  }
  if (m.alphaCutoff > 0.0f) {
    material["alphaMode"] = "MASK";
    material["alphaCutoff"] = number(m.alphaCutoff);
  }
  if (m.doubleSided) material["doubleSided"] = true;
  Json extensions = materialExtensions(m);
  if (!extensions.empty()) material["extensions"] = std::move(extensions);
  root_["materials"].push_back(std::move(material));
  return lastIndex(root_["materials"]);
}

Json GlbWriter::materialExtensions(const Material& m) {
  Json list = Json::object();
  if (const float strength = std::max({m.emissive.x, m.emissive.y, m.emissive.z}); strength > 1.0f) {
    list["KHR_materials_emissive_strength"] = {{"emissiveStrength", number(strength)}};
  }
  if (m.ior != 1.5f) list["KHR_materials_ior"] = {{"ior", number(m.ior)}};
  if (m.transmission > 0.0f) list["KHR_materials_transmission"] = {{"transmissionFactor", number(m.transmission)}};
  if (m.thickness > 0.0f) {
    Json volume = {{"thicknessFactor", number(m.thickness)}};
    if (m.attenuationDistance > 0.0f) {
      volume["attenuationDistance"] = number(m.attenuationDistance);
      volume["attenuationColor"] = numbers(m.attenuationColor);
    }
    list["KHR_materials_volume"] = std::move(volume);
  }
  if (m.clearcoat > 0.0f) {
    list["KHR_materials_clearcoat"] = {{"clearcoatFactor", number(m.clearcoat)},
                                       {"clearcoatRoughnessFactor", number(m.clearcoatRoughness)}};
  }
  if (m.specular != 1.0f) list["KHR_materials_specular"] = {{"specularFactor", number(m.specular)}};
  for (const auto& entry : list.items()) extensions_.insert(entry.key());
  return list;
}

int GlbWriter::addMesh(const std::string& name, const TriangleMesh& mesh, int material) {
  const Bounds3 box = bounds(mesh);
  const int positions = addAccessor(mesh.positions, "VEC3", kFloat, kArrayBuffer);
  root_["accessors"].back()["min"] = {box.min.x, box.min.y, box.min.z};  // exact, as the specification requires
  root_["accessors"].back()["max"] = {box.max.x, box.max.y, box.max.z};
  Json attributes = {{"POSITION", positions}};
  if (!mesh.normals.empty()) attributes["NORMAL"] = addAccessor(mesh.normals, "VEC3", kFloat, kArrayBuffer);
  if (!mesh.tangents.empty()) attributes["TANGENT"] = addAccessor(mesh.tangents, "VEC4", kFloat, kArrayBuffer);
  if (!mesh.uvs.empty()) attributes["TEXCOORD_0"] = addAccessor(mesh.uvs, "VEC2", kFloat, kArrayBuffer);

  int indices = 0;
  if (mesh.positions.size() < 65535) {  // 65535 is the primitive restart value
    std::vector<std::uint16_t> small;
    for (const uvec3& t : mesh.triangles) {
      for (unsigned k = 0; k < 3; ++k) small.push_back(static_cast<std::uint16_t>(t[k]));
    }
    indices = addAccessor(small, "SCALAR", kUnsignedShort, kElementArrayBuffer);
  } else {
    std::vector<std::uint32_t> large;
    for (const uvec3& t : mesh.triangles) large.insert(large.end(), {t.x, t.y, t.z});
    indices = addAccessor(large, "SCALAR", kUnsignedInt, kElementArrayBuffer);
  }
  Json primitive = {{"attributes", std::move(attributes)}, {"indices", indices}, {"material", material}};
  root_["meshes"].push_back({{"name", name}, {"primitives", Json::array({std::move(primitive)})}});
  return lastIndex(root_["meshes"]);
}

void GlbWriter::addInstance(const std::string& name, int mesh, const mat4& worldFromObject) {
  addNode({{"name", name}, {"mesh", mesh}}, worldFromObject);
}

void GlbWriter::addObject(const std::string& name, const TriangleMesh& mesh, int material) {
  addInstance(name, addMesh(name, mesh, material));
}

void GlbWriter::addCamera(const std::string& name, vec3 eye, vec3 target, float verticalFovDegrees, float aspect) {
  Json perspective = {
      {"yfov", number(glm::radians(verticalFovDegrees))}, {"aspectRatio", number(aspect)}, {"znear", 0.01}};
  root_["cameras"].push_back({{"name", name}, {"type", "perspective"}, {"perspective", std::move(perspective)}});
  const vec3 up = std::abs(glm::normalize(target - eye).y) > 0.999f ? vec3(0, 0, -1) : vec3(0, 1, 0);
  addNode({{"name", name}, {"camera", lastIndex(root_["cameras"])}}, glm::inverse(glm::lookAt(eye, target, up)));
}

std::vector<std::byte> GlbWriter::finish() const {
  Json root = root_;
  if (!extensions_.empty()) root["extensionsUsed"] = extensions_;
  root["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
  const std::string text = root.dump();
  std::vector<std::byte> json(text.size());
  std::memcpy(json.data(), text.data(), text.size());
  pad(json, ' ');
  std::vector<std::byte> binary = binary_;
  pad(binary, '\0');

  std::vector<std::byte> file;
  appendWord(file, 0x46546C67u);  // "glTF"
  appendWord(file, 2);
  appendWord(file, 12 + 8 + json.size() + 8 + binary.size());
  appendChunk(file, "JSON", json);
  appendChunk(file, "BIN\0", binary);
  return file;
}

int GlbWriter::addBufferView(std::span<const std::byte> data, int target) {
  pad(binary_, '\0');
  Json view = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", data.size()}};
  if (target != kNoTarget) view["target"] = target;
  binary_.insert(binary_.end(), data.begin(), data.end());
  root_["bufferViews"].push_back(std::move(view));
  return lastIndex(root_["bufferViews"]);
}

template <class T>
int GlbWriter::addAccessor(const std::vector<T>& values, const char* type, int componentType, int target) {
  const int view = addBufferView(std::as_bytes(std::span(values)), target);
  root_["accessors"].push_back(
      {{"bufferView", view}, {"componentType", componentType}, {"count", values.size()}, {"type", type}});
  return lastIndex(root_["accessors"]);
}

void GlbWriter::addNode(Json node, const mat4& worldFromObject) {
  if (worldFromObject != mat4(1.0f)) node["matrix"] = numbers(worldFromObject);
  root_["nodes"].push_back(std::move(node));
  root_["scenes"][0]["nodes"].push_back(lastIndex(root_["nodes"]));
}

}  // namespace quintet::demo

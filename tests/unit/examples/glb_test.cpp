// SPDX-License-Identifier: Apache-2.0
// Reads the generated files back. Every reference and every accessor must satisfy glTF 2.0.
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "demo/glb_writer.h"
#include "demo/mesh_builder.h"
#include "demo/still_life.h"
#include "demo/test_scenes.h"
#include "io/codec.h"

namespace quintet::demo {
namespace {

using Json = nlohmann::json;

struct Glb {
  Json json;
  std::span<const std::byte> binary;
};

std::uint32_t word(std::span<const std::byte> bytes, std::size_t offset) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.subspan(offset, 4).data(), 4);
  return value;
}

Glb parse(std::span<const std::byte> file) {
  EXPECT_EQ(word(file, 0), 0x46546C67u);
  EXPECT_EQ(word(file, 4), 2u);
  EXPECT_EQ(word(file, 8), file.size());
  const std::uint32_t jsonSize = word(file, 12);
  EXPECT_EQ(jsonSize % 4, 0u);
  EXPECT_EQ(word(file, 16), 0x4E4F534Au);  // JSON
  const std::uint32_t binarySize = word(file, 20 + jsonSize);
  EXPECT_EQ(binarySize % 4, 0u);
  EXPECT_EQ(word(file, 24 + jsonSize), 0x004E4942u);  // BIN
  EXPECT_EQ(28u + jsonSize + binarySize, file.size());
  const auto* text = reinterpret_cast<const char*>(file.data());
  return {Json::parse(text + 20, text + 20 + jsonSize), file.subspan(28 + jsonSize, binarySize)};
}

std::size_t componentSize(int type) { return type == 5126 || type == 5125 ? 4 : type == 5123 ? 2 : 0; }

std::size_t componentCount(const std::string& type) {
  return type == "SCALAR" ? 1u : static_cast<std::size_t>(type.back() - '0');
}

std::span<const std::byte> accessorBytes(const Glb& glb, const Json& accessor) {
  const Json& view = glb.json.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
  return glb.binary.subspan(view.at("byteOffset").get<std::size_t>(), view.at("byteLength").get<std::size_t>());
}

void checkAccessors(const Glb& glb) {
  for (const Json& view : glb.json.at("bufferViews")) {
    EXPECT_EQ(view.at("byteOffset").get<std::size_t>() % 4, 0u);
    EXPECT_LE(view.at("byteOffset").get<std::size_t>() + view.at("byteLength").get<std::size_t>(), glb.binary.size());
  }
  for (const Json& accessor : glb.json.at("accessors")) {
    const std::size_t element =
        componentSize(accessor.at("componentType").get<int>()) * componentCount(accessor.at("type").get<std::string>());
    EXPECT_EQ(accessorBytes(glb, accessor).size(), accessor.at("count").get<std::size_t>() * element);
  }
}

void checkPrimitive(const Glb& glb, const Json& primitive) {
  const Json& accessors = glb.json.at("accessors");
  const Json& positions = accessors.at(primitive.at("attributes").at("POSITION").get<std::size_t>());
  const auto count = positions.at("count").get<std::size_t>();
  for (const auto& attribute : primitive.at("attributes").items()) {
    EXPECT_EQ(accessors.at(attribute.value().get<std::size_t>()).at("count").get<std::size_t>(), count)
        << attribute.key();
  }
  // min and max must be exactly those of the data.
  const std::span<const std::byte> bytes = accessorBytes(glb, positions);
  std::vector<vec3> points(count);
  std::memcpy(points.data(), bytes.data(), bytes.size());
  Bounds3 box;
  for (const vec3& p : points) box.extend(p);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(positions.at("min").at(i).get<double>(), static_cast<double>(box.min[i]));
    EXPECT_EQ(positions.at("max").at(i).get<double>(), static_cast<double>(box.max[i]));
  }
  const Json& indices = accessors.at(primitive.at("indices").get<std::size_t>());
  EXPECT_EQ(indices.at("count").get<std::size_t>() % 3, 0u);
  const std::span<const std::byte> indexBytes = accessorBytes(glb, indices);
  const std::size_t size = componentSize(indices.at("componentType").get<int>());
  for (std::size_t i = 0; i < indexBytes.size(); i += size) {
    std::uint32_t index = 0;
    std::memcpy(&index, indexBytes.subspan(i, size).data(), size);
    ASSERT_LT(index, count);
  }
  EXPECT_LT(primitive.at("material").get<std::size_t>(), glb.json.at("materials").size());
}

// Every extension that a material uses is declared, and nothing else.
void checkExtensions(const Json& root) {
  std::set<std::string> used;
  for (const Json& material : root.at("materials")) {
    const Json extensions = material.value("extensions", Json::object());
    for (const auto& entry : extensions.items()) used.insert(entry.key());
  }
  EXPECT_EQ(root.value("extensionsUsed", Json::array()).get<std::set<std::string>>(), used);
}

std::size_t checkFile(std::span<const std::byte> file) {
  const Glb glb = parse(file);
  const Json& root = glb.json;
  EXPECT_EQ(root.at("asset").at("version"), "2.0");
  EXPECT_EQ(root.at("asset").at("generator"), "Quintet");
  EXPECT_EQ(root.at("buffers").at(0).at("byteLength").get<std::size_t>(), glb.binary.size());
  checkAccessors(glb);
  checkExtensions(root);
  std::size_t triangles = 0;
  for (const Json& node : root.at("nodes")) {
    if (!node.contains("mesh")) continue;
    for (const Json& primitive : root.at("meshes").at(node.at("mesh").get<std::size_t>()).at("primitives")) {
      checkPrimitive(glb, primitive);
      triangles +=
          root.at("accessors").at(primitive.at("indices").get<std::size_t>()).at("count").get<std::size_t>() / 3;
    }
  }
  for (const Json& image : root.value("images", Json::array())) {
    const Json accessor = {{"bufferView", image.at("bufferView")}};
    EXPECT_FALSE(io::decodeImage(accessorBytes(glb, accessor), image.at("name").get<std::string>()).empty());
  }
  EXPECT_EQ(root.at("cameras").size(), 1u);
  return triangles;
}

TEST(Glb, TestScenesAreValid) {
  for (const TestScene& scene : testScenes()) {
    SCOPED_TRACE(scene.name);
    const std::vector<std::byte> file = scene.make();
    EXPECT_GT(checkFile(file), 0u);
    EXPECT_EQ(file, scene.make());  // deterministic
  }
}

TEST(Glb, StillLifeIsValid) {
  const std::vector<std::byte> file = stillLife({.oakTextureSize = 64, .textureSize = 64});
  const std::size_t triangles = checkFile(file);
  EXPECT_GT(triangles, 50'000u);
  EXPECT_LT(triangles, 250'000u);
  EXPECT_EQ(file, stillLife({.oakTextureSize = 64, .textureSize = 64}));
  const Json root = parse(file).json;
  EXPECT_EQ(root.at("cameras").at(0).at("name"), "hero");
}

TEST(Glb, WritesOnlyRequiredMaterialExtensions) {
  GlbWriter glb;
  const int glass = glb.addMaterial({.name = "glass",
                                     .roughness = 0.0f,
                                     .ior = 1.3f,
                                     .transmission = 1.0f,
                                     .thickness = 0.5f,
                                     .attenuationColor = {0.5f, 0.75f, 1.0f},
                                     .attenuationDistance = 0.25f});
  const int lamp = glb.addMaterial({.name = "lamp", .emissive = {2.0f, 4.0f, 8.0f}, .specular = 0.0f});
  glb.addObject("box", box(vec3(0), vec3(1)), glass);
  glb.addObject("quad", quad(vec3(0), {1, 0, 0}, {0, 1, 0}), lamp);
  glb.addCamera("main", {0, 0, 5}, vec3(0), 40.0f, 1.5f);
  const Json root = parse(glb.finish()).json;
  const Json& first = root.at("materials").at(0).at("extensions");
  EXPECT_FLOAT_EQ(first.at("KHR_materials_ior").at("ior").get<float>(), 1.3f);
  EXPECT_FLOAT_EQ(first.at("KHR_materials_transmission").at("transmissionFactor").get<float>(), 1.0f);
  EXPECT_EQ(first.at("KHR_materials_volume"), Json::parse(R"({"thicknessFactor": 0.5, "attenuationDistance": 0.25,
                                                              "attenuationColor": [0.5, 0.75, 1.0]})"));
  const Json& second = root.at("materials").at(1);
  EXPECT_EQ(second.at("emissiveFactor"), Json::parse("[0.25, 0.5, 1.0]"));
  EXPECT_EQ(second.at("extensions").at("KHR_materials_emissive_strength").at("emissiveStrength"), 8.0);
  EXPECT_EQ(second.at("extensions").at("KHR_materials_specular").at("specularFactor"), 0.0);
  EXPECT_EQ(root.at("nodes").at(2).at("matrix").at(14), 5.0);  // the camera is at z = 5
}

}  // namespace
}  // namespace quintet::demo

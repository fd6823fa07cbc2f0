// SPDX-License-Identifier: Apache-2.0
// Deterministic mutations of one file that uses all features. Every result loads or throws an Error. Most useful under
// -DQUINTET_SANITIZE=address,undefined.
#include <gtest/gtest.h>

#include <random>

#include "base/error.h"
#include "scene/gltf_builder.h"

namespace quintet::test {
namespace {

// A small scene with a skin, morph targets, textures, indices, sparse data and instances.
GltfBuilder everything() {
  GltfBuilder b;
  const int positions = b.addAccessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3");
  const int normals = b.addAccessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  const int uvs = b.addAccessor<std::uint16_t>({0, 0, 65535, 0, 0, 65535, 65535, 65535}, "VEC2", true);
  const int colors =
      b.addAccessor<std::uint8_t>({255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 9, 9, 9, 9}, "VEC4", true);
  const int joints = b.addAccessor<std::uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, "VEC4");
  const int weights = b.addAccessor<float>({1, 0, 0, 0, 1, 0, 0, 0, .5f, .5f, 0, 0, 1, 0, 0, 0}, "VEC4");
  const int indices = b.addAccessor<std::uint16_t>({0, 1, 2, 2, 1, 3}, "SCALAR");
  const int target = b.addAccessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  const int sparseIndices = b.addView<std::uint8_t>({1, 3}), sparseValues = b.addView<float>({1, 0, 0, 1, 1, 1});
  b.root["accessors"][static_cast<std::size_t>(target)]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", sparseIndices}, {"componentType", kUnsignedByte}}},
      {"values", {{"bufferView", sparseValues}}}};
  const int bind = b.addAccessor<float>(
      {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "MAT4");
  const int translations = b.addAccessor<float>({0, 0, 0, 5, 0, 0}, "VEC3");
  const Json base = {{"POSITION", positions}, {"NORMAL", normals}, {"TEXCOORD_0", uvs}, {"COLOR_0", colors}};
  Json skinned = base;
  skinned["JOINTS_0"] = joints, skinned["WEIGHTS_0"] = weights;
  b.add("meshes", {{"primitives", Json::array({{{"attributes", skinned}, {"indices", indices}, {"material", 0}}})}});
  b.add("meshes", {{"primitives", Json::array({{{"attributes", base},
                                                {"mode", 5},
                                                {"material", 0},
                                                {"targets", Json::array({{{"POSITION", target}}})}}})},
                   {"weights", {0.5}}});
  b.add("images", {{"bufferView", b.addView(tinyPng())}, {"mimeType", "image/png"}});
  b.add("samplers", {{"wrapS", 33071}});
  b.add("textures", {{"source", 0}, {"sampler", 0}});
  b.add("materials",
        {{"pbrMetallicRoughness",
          {{"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"scale", {2, 2}}}}}}}}}},
         {"normalTexture", {{"index", 0}}},
         {"extensions",
          {{"KHR_materials_ior", {{"ior", 1.4}}}, {"KHR_materials_volume", {{"attenuationDistance", 2}}}}}});
  b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}});
  b.add("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", bind}});
  b.root["extensions"]["KHR_lights_punctual"]["lights"] =
      Json::array({{{"type", "spot"}, {"spot", {{"outerConeAngle", 0.4}}}}});
  b.add("nodes", {{"mesh", 0}, {"skin", 0}});
  b.add("nodes", {{"children", {2}}, {"scale", {1, 2, 1}}});
  b.add("nodes", {{"translation", {0, 1, 0}}, {"camera", 0}});
  b.add("nodes", {{"mesh", 1},
                  {"extensions",
                   {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", translations}}}}},
                    {"KHR_lights_punctual", {{"light", 0}}}}}});
  b.root["scenes"] = Json::array({{{"nodes", {0, 1, 3}}}});
  b.root["scene"] = 0;
  b.root["extensionsUsed"] = {"KHR_lights_punctual", "KHR_texture_transform", "EXT_mesh_gpu_instancing"};
  return b;
}

// Loads and validates the file. An Error is accepted if its message is one line.
void survive(const std::vector<std::byte>& file, const std::string& what) {
  SCOPED_TRACE(what);
  try {
    loadBytes(file);
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_FALSE(message.empty());
    for (const char c : message) EXPECT_FALSE(c >= 0 && c < ' ') << message;
  }
}

TEST(GltfFuzz, LoadsTheOriginal) {
  const scene::Scene scene = everything().load();
  EXPECT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.lights.size(), 1u);
  EXPECT_EQ(scene.cameras.size(), 1u);
}

TEST(GltfFuzz, SurvivesTruncation) {
  const auto glb = everything().glb();
  for (std::size_t size = 0; size < glb.size(); size += 7) {
    auto file = glb;
    file.resize(size);
    if (size >= 12)  // adapts the stated length, so that the error is found further inside
      for (std::size_t i = 0; i < 4; ++i) file[8 + i] = static_cast<std::byte>(size >> (8 * i) & 0xFF);
    survive(file, "truncated to " + std::to_string(size));
  }
}

TEST(GltfFuzz, SurvivesReplacedBytes) {
  const auto glb = everything().glb();
  std::mt19937 random(1);
  for (int round = 0; round < 1500; ++round) {
    auto file = glb;
    const int flips = 1 + static_cast<int>(random() % 4);
    for (int i = 0; i < flips; ++i) file[random() % file.size()] = static_cast<std::byte>(random() & 0xFF);
    survive(file, "round " + std::to_string(round));
  }
}

TEST(GltfFuzz, SurvivesReplacedBinaryData) {
  const GltfBuilder original = everything();
  std::mt19937 random(2);
  for (int round = 0; round < 1000; ++round) {
    GltfBuilder broken = original;
    for (int i = 0; i < 6; ++i)
      broken.binary[random() % broken.binary.size()] = static_cast<std::byte>(random() & 0xFF);
    survive(broken.glb(), "round " + std::to_string(round));
  }
}

// Replaces one value at a time, anywhere in the JSON, by invalid and extreme ones.
void mutateEach(const GltfBuilder& original, const Json::json_pointer& pointer, const Json& value) {
  static const std::vector<Json> kReplacements = {-1,
                                                  0,
                                                  1,
                                                  3,
                                                  65536,
                                                  2147483647,
                                                  4294967295u,
                                                  9007199254740991,
                                                  18446744073709551615u,
                                                  -2147483648ll,
                                                  1e30,
                                                  0.5,
                                                  "",
                                                  "VEC4",
                                                  nullptr,
                                                  true,
                                                  Json::array(),
                                                  Json::object(),
                                                  Json::array({0, 0, 0, 0})};
  if (value.is_structured()) {
    for (const auto& [key, inside] : value.items())
      mutateEach(original, value.is_array() ? pointer / static_cast<std::size_t>(std::stoul(key)) : pointer / key,
                 inside);
  }
  for (const Json& replacement : kReplacements) {
    GltfBuilder broken = original;
    broken.root[pointer] = replacement;
    survive(broken.glb(), pointer.to_string() + " = " + replacement.dump());
  }
}

TEST(GltfFuzz, SurvivesReplacedJsonValues) {
  const GltfBuilder original = everything();
  for (const auto& [key, value] : original.root.items()) mutateEach(original, Json::json_pointer("/" + key), value);
}

}  // namespace
}  // namespace quintet::test

// SPDX-License-Identifier: Apache-2.0
// Valid files, each with a feature that a reader could reject: all of them load, with all of their triangles.
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "scene/gltf_builder.h"
#include "scene/model/validate.h"

namespace quintet::test {
namespace {

struct ValidFile {
  const char* name;
  std::uint64_t triangles;  // of all instances
  std::function<void(GltfBuilder&)> build;
};

void addAttribute(GltfBuilder& b, const char* name, int accessor) { b.primitive()["attributes"][name] = accessor; }

const std::vector<ValidFile>& validFiles() {
  static const std::vector<ValidFile> files{
      {"AssetWithMinimumVersion", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         b.root["asset"] = {{"version", "2.0"}, {"minVersion", "2.0"}, {"generator", ""}, {"copyright", "x"}};
       }},
      {"SeveralScenes", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         b.add("scenes", {{"name", "empty"}});
         b.add("scenes", {{"nodes", {0}}});
         b.root["scene"] = 1;
       }},
      {"EmptyNode", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         b.add("nodes", Json::object());
       }},
      {"NodesInNodes", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         b.add("nodes", {{"children", {0}}, {"translation", {1, 2, 3}}});
         b.add("nodes", {{"children", {1}}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}});
         b.add("scenes", {{"nodes", {2}}});
       }},
      {"SharedMesh", 2,
       [](GltfBuilder& b) {
         b.addTriangle();
         b.add("nodes", {{"mesh", 0}, {"scale", {-1, 2, 0.5}}});
       }},
      {"ZeroScale", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         b.root["nodes"][0]["scale"] = {1, 1, 0};
       }},
      {"UnicodeNames", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         b.root["nodes"][0]["name"] = "Würfel 立方体 \"a/b\"\n";
         b.root["meshes"][0]["name"] = "";
       }},
      {"ExtrasAndUnknownExtensions", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         b.root["extras"] = {1, "two", {{"three", nullptr}}};
         b.root["extensionsUsed"] = {"VENDOR_something"};
         b.root["nodes"][0]["extensions"] = {{"VENDOR_something", {{"a", {1, 2}}}}};
         b.root["meshes"][0]["primitives"][0]["extras"] = "text";
       }},
      {"ByteIndices", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         b.primitive()["indices"] = b.addAccessor<std::uint8_t>({2, 1, 0}, "SCALAR");
       }},
      {"ShortIndices", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         b.primitive()["indices"] = b.addAccessor<std::uint16_t>({2, 1, 0}, "SCALAR");
       }},
      {"IntIndices", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         b.primitive()["indices"] = b.addAccessor<std::uint32_t>({2, 1, 0}, "SCALAR");
       }},
      {"InterleavedAttributes", 1,
       [](GltfBuilder& b) {
         const int view = b.addView<float>({0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1}, 24);
         Json accessor = {{"bufferView", view}, {"componentType", kFloat}, {"count", 3}, {"type", "VEC3"}};
         const int positions = b.add("accessors", accessor);
         accessor["byteOffset"] = 12;
         b.addMesh({{"attributes", {{"POSITION", positions}, {"NORMAL", b.add("accessors", accessor)}}}});
       }},
      {"SparsePositions", 1,
       [](GltfBuilder& b) {
         const int indices = b.addView<std::uint8_t>({1, 2}), values = b.addView<float>({1, 0, 0, 0, 1, 0});
         const int positions =
             b.add("accessors", {{"componentType", kFloat},
                                 {"count", 3},
                                 {"type", "VEC3"},
                                 {"sparse",
                                  {{"count", 2},
                                   {"indices", {{"bufferView", indices}, {"componentType", kUnsignedByte}}},
                                   {"values", {{"bufferView", values}}}}}});
         b.addMesh({{"attributes", {{"POSITION", positions}}}});
       }},
      {"NormalizedTextureCoordinates", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         addAttribute(b, "TEXCOORD_0", b.addAccessor<std::uint16_t>({0, 0, 65535, 0, 0, 65535}, "VEC2", true));
       }},
      {"ColorsWithoutAlpha", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         addAttribute(b, "COLOR_0", b.addAccessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3"));
       }},
      {"TangentsAndNormals", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         addAttribute(b, "NORMAL", b.addAccessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3"));
         addAttribute(b, "TANGENT", b.addAccessor<float>({1, 0, 0, 1, 1, 0, 0, -1, 1, 0, 0, 1}, "VEC4"));
       }},
      {"MorphTargetsWithoutWeights", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         b.primitive()["targets"] = {{{"POSITION", b.addAccessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3")}}};
       }},
      {"SkinWithoutMatrices", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         addAttribute(b, "JOINTS_0", b.addAccessor<std::uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4"));
         addAttribute(b, "WEIGHTS_0", b.addAccessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4"));
         b.root["nodes"][0]["skin"] = b.add("skins", {{"joints", {b.add("nodes", Json::object())}}});
       }},
      {"OrthographicAndInfiniteCameras", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         b.add("cameras",
               {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 2}, {"znear", 0}, {"zfar", 9}}}});
         b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
         b.add("nodes", {{"camera", 0}});
         b.add("nodes", {{"camera", 1}});
       }},
      {"ImageInABufferView", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         const int image = b.add("images", {{"bufferView", b.addView(tinyPng())}, {"mimeType", "image/png"}});
         const int texture = b.add("textures", {{"source", image}, {"sampler", b.add("samplers", Json::object())}});
         b.primitive()["material"] =
             b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
         addAttribute(b, "TEXCOORD_0", b.addAccessor<float>({0, 0, 1, 0, 0, 1}, "VEC2"));
       }},
      {"MaterialOfDefaults", 1,
       [](GltfBuilder& b) {
         b.addTriangle();
         b.primitive()["material"] = b.add("materials", Json::object());
       }},
      {"AnimationOfANode", 1, [](GltfBuilder& b) {
         b.addTriangle();
         const int times = b.addAccessor<float>({0, 1}, "SCALAR");
         b.root["accessors"][static_cast<std::size_t>(times)]["min"] = {0};
         b.root["accessors"][static_cast<std::size_t>(times)]["max"] = {1};
         const int values = b.addAccessor<float>({0, 0, 0, 1, 2, 3}, "VEC3");
         b.add("animations", {{"samplers", {{{"input", times}, {"output", values}}}},
                              {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
       }}};
  return files;
}

class GltfValidFiles : public testing::TestWithParam<ValidFile> {};

TEST_P(GltfValidFiles, Load) {
  GltfBuilder builder;
  GetParam().build(builder);
  const std::string bom = "\xEF\xBB\xBF";
  const std::string text = builder.gltf();
  for (const auto& load : {std::function<scene::Scene()>([&] { return builder.load(); }),
                           std::function<scene::Scene()>([&] { return loadText(text); }),
                           std::function<scene::Scene()>([&] { return loadText(bom + text); })}) {
    scene::Scene scene;
    ASSERT_NO_THROW(scene = load());
    EXPECT_NO_THROW(scene::validate(scene));
    EXPECT_EQ(scene::countTriangles(scene).instanced, GetParam().triangles);
  }
}

INSTANTIATE_TEST_SUITE_P(Every, GltfValidFiles, testing::ValuesIn(validFiles()),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace quintet::test

// SPDX-License-Identifier: Apache-2.0
// Bounds checks and conversion of accessors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/error_matcher.h"
#include "scene/gltf_builder.h"

namespace quintet::test {
namespace {

using scene::Geometry;
using testing::StartsWith;

const Geometry& onlyGeometry(const scene::Scene& scene) {
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes.at(0).geometries.size(), 1u);
  return scene.meshes.at(0).geometries.at(0);
}

TEST(GltfAccessor, ReadsPositions) {
  GltfBuilder builder;
  builder.addTriangle();
  const scene::Scene scene = builder.load();
  const Geometry& geometry = onlyGeometry(scene);
  EXPECT_THAT(geometry.positions, testing::ElementsAre(vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0)));
  EXPECT_THAT(geometry.triangles, testing::ElementsAre(uvec3(0, 1, 2)));
  EXPECT_TRUE(geometry.normals.empty());
  EXPECT_TRUE(geometry.fileTriangles.empty());
}

TEST(GltfAccessor, RejectsAccessorsOutsideTheirView) {
  GltfBuilder builder;
  builder.addTriangle();
  Json& accessor = builder.root["accessors"][0];
  accessor["count"] = 4;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/accessors/0/bufferView", "12 bytes"));
  accessor["count"] = 4294967295u;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/accessors/0/bufferView", "51539607504 bytes"));
  accessor["count"] = 4294967296u;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/accessors/0/count", "4294967296"));
  accessor["count"] = 3;
  accessor["byteOffset"] = 1;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/accessors/0/bufferView", "1 byte past"));
  accessor["byteOffset"] = 9007199254740991;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/accessors/0/bufferView", "9007199254740991 bytes"));
  accessor["byteOffset"] = 0;
  accessor["bufferView"] = 7;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/accessors/0/bufferView", "buffer view 7"));
}

TEST(GltfAccessor, ChecksUnusedAccessors) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.add("accessors", {{"bufferView", 0}, {"componentType", kFloat}, {"count", 100}, {"type", "VEC4"}});
  EXPECT_THAT(errorOf(builder), IsErrorAt("/accessors/1/bufferView", "1564 bytes"));
}

TEST(GltfAccessor, RejectsUnknownTypes) {
  GltfBuilder builder;
  builder.addTriangle();
  Json& accessor = builder.root["accessors"][0];
  accessor["componentType"] = 5124;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/accessors/0/componentType", "5124"));
  accessor["componentType"] = kFloat;
  accessor["type"] = "VEC5";
  EXPECT_THAT(errorOf(builder), IsErrorAt("/accessors/0/type", "VEC5"));
  accessor["type"] = "VEC2";
  EXPECT_THAT(errorOf(builder), IsErrorAt("/meshes/0/primitives/0/attributes/POSITION", "VEC2"));
  accessor.erase("type");
  EXPECT_THAT(errorOf(builder), IsErrorAt("/accessors/0", "type"));
}

TEST(GltfAccessor, ReadsInterleavedAttributes) {
  // Position and texture coordinate, 20 bytes per vertex.
  GltfBuilder builder;
  const int view = builder.addView<float>({0, 0, 0, .5f, .25f, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 20);
  const int positions =
      builder.add("accessors", {{"bufferView", view}, {"componentType", kFloat}, {"count", 3}, {"type", "VEC3"}});
  const int uvs = builder.add(
      "accessors",
      {{"bufferView", view}, {"byteOffset", 12}, {"componentType", kFloat}, {"count", 3}, {"type", "VEC2"}});
  builder.addMesh({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}}});
  const scene::Scene scene = builder.load();
  EXPECT_EQ(onlyGeometry(scene).positions[2], vec3(0, 1, 0));
  EXPECT_THAT(onlyGeometry(scene).uvs[0], testing::ElementsAre(vec2(.5f, .25f), vec2(1, 0), vec2(0, 1)));

  Json& byteStride = builder.root["bufferViews"][0]["byteStride"];
  byteStride = 8;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/accessors/0", "byteStride"));
  byteStride = 24;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/accessors/1/bufferView", "8 bytes"));
  byteStride = 256;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/bufferViews/0/byteStride", "256"));
}

TEST(GltfAccessor, ReadsOddStrides) {
  GltfBuilder builder;
  const int view = builder.addView<std::uint16_t>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 6);
  builder.addMesh(
      {{"attributes",
        {{"POSITION",
          builder.add("accessors",
                      {{"bufferView", view}, {"componentType", kUnsignedShort}, {"count", 3}, {"type", "VEC3"}})}}}});
  EXPECT_EQ(onlyGeometry(builder.load()).positions[2], vec3(0, 1, 0));
}

TEST(GltfAccessor, ReadsMisalignedData) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.binary.insert(builder.binary.begin(), std::byte{0xAB});
  builder.root["bufferViews"][0]["byteOffset"] = 1;
  EXPECT_EQ(onlyGeometry(builder.load()).positions[1], vec3(1, 0, 0));
}

template <class T>
std::vector<vec3> loadPositions(const std::vector<T>& components, bool normalized) {
  GltfBuilder builder;
  builder.addMesh({{"attributes", {{"POSITION", builder.addAccessor(components, "VEC3", normalized)}}}});
  return onlyGeometry(builder.load()).positions;
}

TEST(GltfAccessor, ReadsQuantizedPositions) {
  using testing::ElementsAre;
  EXPECT_THAT(loadPositions<std::uint8_t>({0, 51, 255, 1, 2, 3, 4, 5, 6}, true)[0], vec3(0, 0.2f, 1));
  EXPECT_THAT(loadPositions<std::uint8_t>({0, 51, 255, 1, 2, 3, 4, 5, 6}, false)[0], vec3(0, 51, 255));
  EXPECT_THAT(loadPositions<std::int8_t>({127, -127, -128, 1, 2, 3, 4, 5, 6}, true)[0], vec3(1, -1, -1));
  EXPECT_THAT(loadPositions<std::int8_t>({127, -127, -128, 1, 2, 3, 4, 5, 6}, false)[0], vec3(127, -127, -128));
  EXPECT_THAT(loadPositions<std::uint16_t>({65535, 0, 13107, 1, 2, 3, 4, 5, 6}, true)[0], vec3(1, 0, 0.2f));
  EXPECT_THAT(loadPositions<std::uint16_t>({65535, 0, 13107, 1, 2, 3, 4, 5, 6}, false)[0], vec3(65535, 0, 13107));
  EXPECT_THAT(loadPositions<std::int16_t>({32767, -32768, -32767, 1, 2, 3, 4, 5, 6}, true)[0], vec3(1, -1, -1));
  EXPECT_THAT(loadPositions<std::int16_t>({32767, -32768, -32767, 1, 2, 3, 4, 5, 6}, false)[0],
              vec3(32767, -32768, -32767));
}

TEST(GltfAccessor, RejectsUnsignedIntAttributes) {
  GltfBuilder builder;
  builder.addMesh(
      {{"attributes", {{"POSITION", builder.addAccessor<std::uint32_t>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3")}}}});
  EXPECT_THAT(errorOf(builder), IsErrorAt("/meshes/0/primitives/0/attributes/POSITION",
                                          "accessor 0 has unsigned ints, expected floats, bytes or shorts"));
}

// A message names the types that are expected.
TEST(GltfAccessor, NamesTheExpectedTypes) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.primitive()["indices"] = builder.addAccessor<std::int16_t>({0, 1, 2}, "SCALAR");
  EXPECT_THAT(errorOf(builder),
              IsErrorAt("/meshes/0/primitives/0/indices",
                        "accessor 1 has signed shorts, expected unsigned bytes, unsigned shorts or unsigned ints"));
  builder.primitive().erase("indices");
  builder.primitive()["attributes"]["JOINTS_0"] =
      builder.addAccessor<std::uint32_t>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4");
  builder.primitive()["attributes"]["WEIGHTS_0"] =
      builder.addAccessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
  builder.add("skins", {{"joints", {0}}});
  builder.root["nodes"][0]["skin"] = 0;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/meshes/0/primitives/0/attributes/JOINTS_0",
                                          "accessor 2 has unsigned ints, expected unsigned bytes or unsigned shorts"));
}

template <class T>
scene::Scene loadIndexed(const std::vector<T>& indices) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.primitive()["indices"] = builder.addAccessor(indices, "SCALAR");
  return builder.load();
}

TEST(GltfAccessor, ReadsIndicesOfAllWidths) {
  EXPECT_THAT(onlyGeometry(loadIndexed<std::uint8_t>({2, 1, 0})).triangles, testing::ElementsAre(uvec3(2, 1, 0)));
  EXPECT_THAT(onlyGeometry(loadIndexed<std::uint16_t>({2, 1, 0})).triangles, testing::ElementsAre(uvec3(2, 1, 0)));
  EXPECT_THAT(onlyGeometry(loadIndexed<std::uint32_t>({2, 1, 0, 0, 1, 2})).triangles,
              testing::ElementsAre(uvec3(2, 1, 0), uvec3(0, 1, 2)));
}

TEST(GltfAccessor, RejectsInvalidIndices) {
  GltfBuilder builder;
  builder.addTriangle();
  const auto errorWith = [&](int accessor) {
    builder.primitive()["indices"] = accessor;
    return errorOf(builder);
  };
  const std::string location = "/meshes/0/primitives/0/indices";
  EXPECT_THAT(errorWith(builder.addAccessor<std::uint8_t>({0, 1, 3}, "SCALAR")), IsErrorAt(location, "element 2 is 3"));
  EXPECT_THAT(errorWith(builder.addAccessor<std::uint32_t>({0, 4294967295u, 0}, "SCALAR")),
              IsErrorAt(location, "element 1 is 4294967295"));
  EXPECT_THAT(errorWith(builder.addAccessor<float>({0, 1, 2}, "SCALAR")), IsErrorAt(location, "floats"));
  EXPECT_THAT(errorWith(builder.addAccessor<std::int16_t>({0, 1, 2}, "SCALAR")), IsErrorAt(location, "signed shorts"));
  EXPECT_THAT(errorWith(builder.addAccessor<std::uint8_t>({0, 1, 2, 0, 1, 2}, "VEC2")), IsErrorAt(location, "VEC2"));
  EXPECT_THAT(errorWith(99), IsErrorAt(location, "accessor 99"));
}

// Three vertices; the sparse part moves the last two.
struct SparseBuilder : GltfBuilder {
  SparseBuilder(bool withView) {
    addTriangle();
    const int indices = addView<std::uint16_t>({1, 2});
    const int values = addView<float>({5, 0, 0, 0, 7, 0});
    Json& accessor = root["accessors"][0];
    accessor["sparse"] = {{"count", 2},
                          {"indices", {{"bufferView", indices}, {"componentType", kUnsignedShort}}},
                          {"values", {{"bufferView", values}}}};
    if (!withView) accessor.erase("bufferView");
  }
  Json& sparse() { return root["accessors"][0]["sparse"]; }
};

TEST(GltfSparse, ReplacesElements) {
  for (const bool withView : {true, false}) {
    const scene::Scene scene = SparseBuilder(withView).load();
    EXPECT_THAT(onlyGeometry(scene).positions, testing::ElementsAre(vec3(0, 0, 0), vec3(5, 0, 0), vec3(0, 7, 0)));
  }
}

TEST(GltfSparse, ReadsIndicesWithoutBufferView) {
  GltfBuilder builder;
  builder.addTriangle();
  const int indices = builder.addView<std::uint8_t>({1, 2}), values = builder.addView<std::uint16_t>({2, 1});
  builder.primitive()["indices"] =
      builder.add("accessors", {{"componentType", kUnsignedShort},
                                {"count", 3},
                                {"type", "SCALAR"},
                                {"sparse",
                                 {{"count", 2},
                                  {"indices", {{"bufferView", indices}, {"componentType", kUnsignedByte}}},
                                  {"values", {{"bufferView", values}}}}}});
  EXPECT_THAT(onlyGeometry(builder.load()).triangles, testing::ElementsAre(uvec3(0, 2, 1)));
}

TEST(GltfSparse, RejectsInconsistentData) {
  const auto errorWith = [](auto change) {
    SparseBuilder builder(true);
    change(builder);
    return errorOf(builder);
  };
  EXPECT_THAT(errorWith([](auto& b) { b.sparse()["count"] = 4; }), IsErrorAt("/accessors/0/sparse/count", "4 values"));
  EXPECT_THAT(errorWith([](auto& b) { b.sparse()["count"] = 3; }),
              IsErrorAt("/accessors/0/sparse/indices/bufferView", "2 bytes"));
  EXPECT_THAT(errorWith([](auto& b) { b.sparse()["values"]["byteOffset"] = 4; }),
              IsErrorAt("/accessors/0/sparse/values/bufferView", "4 bytes"));
  EXPECT_THAT(errorWith([](auto& b) { b.sparse()["indices"]["componentType"] = kFloat; }),
              IsErrorAt("/accessors/0/sparse/indices/componentType", "5126"));
  EXPECT_THAT(errorWith([](auto& b) { b.sparse()["indices"]["bufferView"] = 9; }),
              IsErrorAt("/accessors/0/sparse/indices/bufferView", "buffer view 9"));
  EXPECT_THAT(errorWith([](auto& b) { b.sparse().erase("values"); }), IsErrorAt("/accessors/0/sparse", "values"));
  EXPECT_THAT(errorWith([](auto& b) { b.binary[36] = std::byte{3}; }),
              IsErrorAt("/accessors/0/sparse/indices", "element 0 is 3"));
  EXPECT_THAT(errorWith([](auto& b) { b.binary[36] = std::byte{2}; }),
              IsErrorAt("/accessors/0/sparse/indices", "element 1 is 2"));
}

TEST(GltfAccessor, ReadsZerosWithoutBufferView) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.root["accessors"][0].erase("bufferView");
  EXPECT_EQ(onlyGeometry(builder.load()).positions[1], vec3(0));
  builder.root["accessors"][0]["count"] = 20000000;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/accessors/0/count", "20000000 elements"));
}

}  // namespace
}  // namespace quintet::test

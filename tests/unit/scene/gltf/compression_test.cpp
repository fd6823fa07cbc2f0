// SPDX-License-Identifier: Apache-2.0
// KHR_draco_mesh_compression and EXT_meshopt_compression, with streams from the encoders of the libraries.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>
#include <algorithm>
#include <array>
#include <memory>

#include <random>

#include "base/error.h"
#include "scene/error_matcher.h"
#include "scene/gltf_samples.h"

namespace quintet::test {
namespace {

using scene::Geometry;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

TEST(GltfDraco, DecodesAttributesAndTriangles) {
  const scene::Scene scene = DracoBuilder().load();
  const Geometry& g = scene.meshes.at(0).geometries.at(0);
  ASSERT_EQ(g.triangles.size(), 2u);
  EXPECT_EQ(g.uvs[0].size(), g.positions.size());
  float area = 0;
  for (const uvec3& t : g.triangles)
    area += glm::cross(g.positions[t.y] - g.positions[t.x], g.positions[t.z] - g.positions[t.x]).z / 2;
  EXPECT_FLOAT_EQ(area, 1.0f);
  EXPECT_EQ(scene::worldBounds(scene).max, vec3(1, 2, 0));
}

TEST(GltfDraco, RejectsInvalidStreams) {
  const std::string location = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";
  DracoBuilder builder;
  builder.binary[0] = std::byte{'X'};
  EXPECT_THAT(errorOf(builder), IsErrorAt(location, "Draco"));
  builder = DracoBuilder();
  builder.root["bufferViews"][0]["byteLength"] = 30;
  EXPECT_THAT(errorOf(builder), IsErrorAt(location, "Draco"));
  builder = DracoBuilder();
  builder.draco()["attributes"]["POSITION"] = 77;
  EXPECT_THAT(errorOf(builder), IsErrorAt(location + "/attributes/POSITION", "77"));
  builder.draco()["attributes"]["POSITION"] = builder.draco()["attributes"]["TEXCOORD_0"];
  EXPECT_THAT(errorOf(builder), IsErrorAt("/meshes/0/primitives/0/attributes/POSITION", "2 components"));
  builder.draco()["bufferView"] = 5;
  EXPECT_THAT(errorOf(builder), IsErrorAt(location + "/bufferView", "buffer view 5"));
  builder = DracoBuilder();
  builder.primitive()["mode"] = 6;
  EXPECT_THAT(errorOf(builder), IsErrorAt(location, "TRIANGLE_STRIP"));
}

TEST(GltfDraco, RejectsExcessiveTriangleCounts) {
  for (const int method : {0, 1}) {
    GltfBuilder builder = DracoBuilder();
    const std::vector<std::uint8_t> header = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, static_cast<std::uint8_t>(method),
                                              0,   0};
    constexpr std::array<std::uint8_t, 4> kMillions = {0x80, 0xC2, 0xD7, 0x2F};  // 10^8 as a varint
    std::vector<std::uint8_t> stream(100);
    auto end = std::copy(header.begin(), header.end(), stream.begin());
    if (method == 1) end = std::copy(kMillions.begin(), kMillions.end(), end + 1);  // traversal 0, vertices
    std::copy(kMillions.begin(), kMillions.end(), end);                             // triangles
    builder.primitive()["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = builder.addView(stream);
    EXPECT_THAT(errorOf(builder),
                IsErrorAt("/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression", "100000000 triangles"));
  }
}

TEST(GltfDraco, SurvivesEveryCorruptByte) {
  const DracoBuilder original;
  for (std::size_t i = 0; i < original.binary.size(); ++i)
    for (const int value : {0x00, 0x7F, 0xFF}) {
      GltfBuilder broken = original;
      broken.binary[i] = static_cast<std::byte>(value);
      try {
        broken.load();
      } catch (const Error&) {
      }
    }
}

TEST(GltfMeshopt, DecodesVerticesAndTriangles) {
  const scene::Scene scene = MeshoptBuilder().load();
  const Geometry& g = scene.meshes.at(0).geometries.at(0);
  EXPECT_EQ(g.positions[19], vec3(9, 1, 0));
  ASSERT_EQ(g.triangles.size(), 18u);
  for (const uvec3& t : g.triangles)  // the codec can rotate the vertices of a triangle, but keeps the winding
    EXPECT_LT(glm::cross(g.positions[t.y] - g.positions[t.x], g.positions[t.z] - g.positions[t.x]).z, 0.0f);
}

TEST(GltfMeshopt, AppliesFilters) {
  MeshoptBuilder builder;
  // Exponential: 24-bit mantissa, 8-bit exponent. 3 · 2^-1, 1 · 2^0, -2 · 2^1
  const std::vector<std::uint32_t> values(20 * 3, 0xFF000003u);
  std::vector<unsigned char> encoded(meshopt_encodeVertexBufferBound(20, 12));
  encoded.resize(meshopt_encodeVertexBuffer(encoded.data(), encoded.size(), values.data(), 20, 12));
  builder.addCompressed(encoded, 20, 12, "ATTRIBUTES");
  builder.root["buffers"][0]["byteLength"] = builder.binary.size();
  builder.meshopt(2)["filter"] = "EXPONENTIAL";
  builder.root["accessors"][0]["bufferView"] = 2;
  EXPECT_EQ(builder.load().meshes[0].geometries[0].positions[7], vec3(1.5f));
}

TEST(GltfMeshopt, RejectsInconsistentViews) {
  const std::string location = "/bufferViews/0/extensions/EXT_meshopt_compression";
  const auto errorWith = [](auto change) {
    MeshoptBuilder builder;
    change(builder);
    return errorOf(builder);
  };
  EXPECT_THAT(errorWith([](auto& b) { b.meshopt(0)["byteLength"] = 100000; }), IsErrorAt(location, "99"));
  EXPECT_THAT(errorWith([](auto& b) { b.meshopt(0)["byteStride"] = 10; }),
              IsErrorAt(location + "/byteStride", "filter NONE"));
  EXPECT_THAT(errorWith([](auto& b) { b.meshopt(0)["byteStride"] = 16; }), IsErrorAt(location + "/byteStride", "16"));
  EXPECT_THAT(errorWith([](auto& b) { b.meshopt(0)["filter"] = "QUATERNION"; }),
              IsErrorAt(location + "/byteStride", "filter QUATERNION"));
  EXPECT_THAT(errorWith([](auto& b) { b.meshopt(0)["mode"] = "POINTS"; }), IsErrorAt(location + "/mode", "POINTS"));
  EXPECT_THAT(errorWith([](auto& b) { b.meshopt(0)["count"] = 2147483647; }), IsErrorAt(location + "/count", ""));
  EXPECT_THAT(errorWith([](auto& b) { b.binary[0] = std::byte{0}; }), IsErrorAt(location, "compressed data"));
  EXPECT_THAT(errorWith([](auto& b) { b.meshopt(0)["buffer"] = 2; }), IsErrorAt(location + "/buffer", "buffer 2"));
  EXPECT_THAT(errorWith([](auto& b) { b.meshopt(1)["count"] = 53; }),
              IsErrorAt("/bufferViews/1/extensions/EXT_meshopt_compression/count", "multiple of 3"));
  EXPECT_THAT(errorWith([](auto& b) { b.root["bufferViews"][0].erase("extensions"); }),
              IsErrorAt("/buffers/1", "no data"));
}

TEST(GltfMeshopt, SurvivesEveryCorruptByte) {
  const MeshoptBuilder original;
  for (std::size_t i = 0; i < original.binary.size(); ++i)
    for (const int value : {0x00, 0x7F, 0xFF}) {
      GltfBuilder broken = original;
      broken.binary[i] = static_cast<std::byte>(value);
      try {
        broken.load();
      } catch (const Error&) {
      }
    }
}

}  // namespace
}  // namespace quintet::test

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
#include "scene/gltf_builder.h"

namespace quintet::test {
namespace {

using scene::Geometry;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

// A fan of triangles around the origin, with texture coordinates.
std::vector<std::byte> dracoStream(int triangles, int* positionId, int* uvId) {
  draco::TriangleSoupMeshBuilder soup;
  soup.Start(triangles);
  const int positions = soup.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int uvs = soup.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  for (int i = 0; i < triangles; ++i) {
    const float a[3] = {0, 0, 0}, b[3] = {1, static_cast<float>(i), 0}, c[3] = {1, static_cast<float>(i + 1), 0};
    const float u[2] = {0, 0}, v[2] = {1, 0.25f}, w[2] = {1, 0.5f};
    soup.SetAttributeValuesForFace(positions, draco::FaceIndex(static_cast<std::uint32_t>(i)), a, b, c);
    soup.SetAttributeValuesForFace(uvs, draco::FaceIndex(static_cast<std::uint32_t>(i)), u, v, w);
  }
  const std::unique_ptr<draco::Mesh> mesh = soup.Finalize();
  *positionId = static_cast<int>(mesh->GetNamedAttribute(draco::GeometryAttribute::POSITION)->unique_id());
  *uvId = static_cast<int>(mesh->GetNamedAttribute(draco::GeometryAttribute::TEX_COORD)->unique_id());
  draco::Encoder encoder;  // without quantization, so that floats are exact
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  const auto bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
  return {bytes.begin(), bytes.end()};
}

struct DracoBuilder : GltfBuilder {
  DracoBuilder() {
    int positionId = 0, uvId = 0;
    const int view = addView(dracoStream(2, &positionId, &uvId));
    root["extensionsUsed"] = root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    const Json floats = {{"componentType", kFloat}, {"count", 4}};
    Json position = floats, uv = floats;
    position["type"] = "VEC3", uv["type"] = "VEC2";
    const int positions = add("accessors", position), uvs = add("accessors", uv);
    const int indices = add("accessors", {{"componentType", kUnsignedShort}, {"count", 6}, {"type", "SCALAR"}});
    addMesh({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}},
             {"indices", indices},
             {"extensions",
              {{"KHR_draco_mesh_compression",
                {{"bufferView", view}, {"attributes", {{"POSITION", positionId}, {"TEXCOORD_0", uvId}}}}}}}});
  }
  Json& draco() { return primitive()["extensions"]["KHR_draco_mesh_compression"]; }
};

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

// A strip of vertices, compressed as attributes, and its triangles.
struct MeshoptBuilder : GltfBuilder {
  MeshoptBuilder() {
    std::vector<vec3> positions;
    for (int i = 0; i < 20; ++i) positions.emplace_back(i / 2, i % 2, 0);
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i + 2 < 20; ++i) indices.insert(indices.end(), {i, i + 1 + i % 2, i + 2 - i % 2});

    std::vector<unsigned char> encoded(meshopt_encodeVertexBufferBound(20, 12));
    encoded.resize(meshopt_encodeVertexBuffer(encoded.data(), encoded.size(), positions.data(), 20, 12));
    addCompressed(encoded, 20, 12, "ATTRIBUTES");
    root["bufferViews"][0]["byteStride"] = 12;
    std::vector<unsigned char> encodedIndices(meshopt_encodeIndexBufferBound(indices.size(), 20));
    encodedIndices.resize(
        meshopt_encodeIndexBuffer(encodedIndices.data(), encodedIndices.size(), indices.data(), indices.size()));
    addCompressed(encodedIndices, indices.size(), 2, "TRIANGLES");

    const int p = add("accessors", {{"bufferView", 0}, {"componentType", kFloat}, {"count", 20}, {"type", "VEC3"}});
    const int i =
        add("accessors",
            {{"bufferView", 1}, {"componentType", kUnsignedShort}, {"count", indices.size()}, {"type", "SCALAR"}});
    addMesh({{"attributes", {{"POSITION", p}}}, {"indices", i}});
    root["extensionsUsed"] = root["extensionsRequired"] = {"EXT_meshopt_compression"};
    // Buffer 1 is the fallback buffer, without data.
    root["buffers"] = {{{"byteLength", binary.size()}},
                       {{"byteLength", 1000}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
  }
  void addCompressed(const std::vector<unsigned char>& data, std::size_t count, std::size_t stride, const char* mode) {
    const int view = addView(data);
    const Json inside = root["bufferViews"][static_cast<std::size_t>(view)];
    root["bufferViews"][static_cast<std::size_t>(view)] = {{"buffer", 1},
                                                           {"byteLength", count * stride},
                                                           {"extensions",
                                                            {{"EXT_meshopt_compression",
                                                              {{"buffer", 0},
                                                               {"byteOffset", inside["byteOffset"]},
                                                               {"byteLength", inside["byteLength"]},
                                                               {"byteStride", stride},
                                                               {"count", count},
                                                               {"mode", mode}}}}}};
  }
  Json& meshopt(std::size_t view) { return root["bufferViews"][view]["extensions"]["EXT_meshopt_compression"]; }
};

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

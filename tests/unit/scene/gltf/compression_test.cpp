// SPDX-License-Identifier: Apache-2.0
// KHR_draco_mesh_compression and EXT_meshopt_compression, with streams from the encoders of the libraries, and
// KHR_meshopt_compression.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>
#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <optional>
#include <random>
#include <span>

#include "base/error.h"
#include "scene/error_matcher.h"
#include "scene/gltf/meshopt.h"
#include "scene/gltf_samples.h"
#include "scene/meshopt_writer.h"

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

// ---- Version 1 of the vertex codec ----

using Stream = std::vector<unsigned char>;

// The elements of the stream; nothing if it is not valid.
std::optional<Stream> decodedVersion1(const Stream& stream, std::size_t count, std::size_t stride) {
  Stream elements(count * stride);
  const bool valid = scene::decodeMeshoptVersion1(std::as_writable_bytes(std::span(elements)), stride,
                                                  std::as_bytes(std::span(stream)));
  return valid ? std::optional(elements) : std::nullopt;
}

// The example of the specification: sixteen 4-bit differences, two of them in a byte of their own.
TEST(MeshoptVersion1, DecodesTheExampleOfTheSpecification) {
  Stream stream{0xA1, 0xA8, 0x03, 0x17, 0x5F, 0xF0, 0xBC, 0x77, 0xA9, 0x21, 0x00, 0x34, 0xB5};
  stream.resize(stream.size() + 24);
  const std::optional<Stream> elements = decodedVersion1(stream, 16, 4);
  ASSERT_TRUE(elements);
  int sum = 0;
  const int differences[] = {-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0};
  for (std::size_t i = 0; i < 16; ++i) {
    sum += differences[i];
    EXPECT_EQ((*elements)[4 * i], static_cast<unsigned char>(sum)) << i;
    EXPECT_EQ((*elements)[4 * i + 1], 0);
  }
}

TEST(MeshoptVersion1, DecodesAllModes) {
  std::mt19937 random(11);
  for (int i = 0; i < 300; ++i) {
    const std::size_t stride = 4 * (1 + random() % (i % 10 == 0 ? 64 : 8)), count = 1 + random() % 600;
    Stream modes(stride / 4), elements(count * stride);
    for (unsigned char& mode : modes) mode = static_cast<unsigned char>(random() % 3);
    for (unsigned char& mode : modes)
      if (mode == 2) mode = static_cast<unsigned char>(2 + 16 * (random() % 16));
    const std::uint32_t range = std::array{1u, 3u, 20u, 256u}[random() % 4];
    for (std::size_t k = 0; k < elements.size(); ++k) {
      const std::uint32_t last = k < stride ? 0u : elements[k - stride];
      elements[k] = static_cast<unsigned char>(random() % 4 == 0 ? last + random() % range : last);
    }
    const Stream stream = writeMeshoptVersion1(elements, stride, modes, random);
    ASSERT_EQ(decodedVersion1(stream, count, stride), elements) << i;
    for (std::size_t size = 0; size < stream.size(); size += 1 + stream.size() / 40)
      EXPECT_FALSE(
          decodedVersion1({stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(size)}, count, stride));
    // A byte between the blocks and the tail.
    Stream longer = stream;
    const auto tail = static_cast<std::ptrdiff_t>(std::max<std::size_t>(24, stride + modes.size()));
    longer.insert(longer.end() - tail, 0);
    EXPECT_FALSE(decodedVersion1(longer, count, stride)) << i;
    // Other channel modes are not valid.
    for (const int mode : {3, 0x10, 0x11, 0x0F}) {
      Stream other = stream;
      other.back() = static_cast<unsigned char>(mode);
      EXPECT_FALSE(decodedVersion1(other, count, stride)) << mode;
    }
  }
}

TEST(MeshoptVersion1, SurvivesChangedStreams) {
  std::mt19937 random(13);
  Stream elements(12 * 300);
  for (unsigned char& byte : elements) byte = static_cast<unsigned char>(random() % 3);
  const Stream stream = writeMeshoptVersion1(elements, 12, {0, 1, 0x52}, random);
  for (int i = 0; i < 3000; ++i) {
    Stream changed = stream;
    for (auto changes = 1 + random() % 4; changes > 0; --changes)
      changed[random() % changed.size()] = static_cast<unsigned char>(random());
    if (i % 4 == 0) changed.resize(random() % changed.size());
    (void)decodedVersion1(changed, 300, 12);
  }
}

TEST(MeshoptVersion1, ConvertsColors) {
  const auto bytes = [](Stream colors) {
    scene::decodeMeshoptColors(std::as_writable_bytes(std::span(colors)), 4);
    return colors;
  };
  // 8 bits: red is luma + orange - green, and so on. Alpha has 7 bits behind the highest one.
  EXPECT_THAT(bytes({100, 20, 226, 0x80 | 0x55}), ElementsAre(150, 70, 110, 171));
  // 4 bits, which are scaled by 17.
  EXPECT_THAT(bytes({5, 2, 255, 8 | 5}), ElementsAre(136, 68, 68, 187));
  EXPECT_THAT(bytes({5, 2, 255, 0}), ElementsAre(0, 0, 0, 0));  // not valid
  // 171 of 511, to the nearest value: 21930.4975.
  std::array<std::uint16_t, 4> wide{171, 0, 0, 256 | 85};
  scene::decodeMeshoptColors(std::as_writable_bytes(std::span(wide)), 8);
  EXPECT_THAT(wide, ElementsAre(21930, 21930, 21930, 21930));
}

TEST(GltfMeshopt, ReadsTheKhronosExtension) {
  MeshoptBuilder builder("KHR_meshopt_compression");
  scene::Scene scene = builder.load();
  EXPECT_TRUE(scene.report.isExact());
  EXPECT_THAT(scene.report.extensionsUsed, ElementsAre("KHR_meshopt_compression"));
  EXPECT_EQ(scene.meshes.at(0).geometries.at(0).positions[19], vec3(9, 1, 0));
  // Positions in version 1, and colors.
  builder = stripInVersion1();
  scene = builder.load();
  const Geometry& g = scene.meshes.at(0).geometries.at(0);
  EXPECT_EQ(g.positions[19], vec3(9, 1, 0));
  ASSERT_EQ(g.colors.size(), 20u);
  EXPECT_EQ(g.colors[19], vec4(150, 70, 110, 255) / 255.0f);
  // COLOR needs strides of 4 or 8, and the extension of Khronos.
  const std::string location = "/bufferViews/3/extensions/KHR_meshopt_compression";
  builder.meshopt(3)["byteStride"] = 12;
  EXPECT_THAT(errorOf(builder), IsErrorAt(location + "/byteStride", "filter COLOR"));
  MeshoptBuilder old;
  old.meshopt(0)["filter"] = "COLOR";
  EXPECT_THAT(errorOf(old), IsErrorAt("/bufferViews/0/extensions/EXT_meshopt_compression/filter", "COLOR"));
}

// Equal elements need two bits for each byte of a block of up to 256.
TEST(GltfMeshopt, ReadsConstantVerticesInVersion1) {
  MeshoptBuilder builder("KHR_meshopt_compression");
  constexpr std::size_t kCount = 100000;
  Stream stream{0xA1};
  stream.resize(1 + (kCount + 255) / 256 * 3, 0xAA);  // all bytes of all blocks are those of the baseline
  const float baseline[3] = {1, 2, 3};
  Stream tail(24);
  std::memcpy(tail.data() + 24 - 3 - 12, baseline, 12);
  stream.insert(stream.end(), tail.begin(), tail.end());
  const std::optional<Stream> elements = decodedVersion1(stream, kCount, 12);
  ASSERT_TRUE(elements);
  EXPECT_EQ(std::memcmp(elements->data() + 12 * (kCount - 1), baseline, 12), 0);
  builder.addCompressed(stream, kCount, 12, "ATTRIBUTES");
  builder.root["buffers"][0]["byteLength"] = builder.binary.size();
  builder.root["buffers"][1]["byteLength"] = kCount * 12;
  builder.root["accessors"][0]["bufferView"] = 2;
  EXPECT_EQ(builder.load().meshes[0].geometries[0].positions[7], vec3(1, 2, 3));
  builder.meshopt(2)["count"] = 3 * kCount;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/bufferViews/2/extensions/KHR_meshopt_compression/count", "cannot hold"));
}

}  // namespace
}  // namespace quintet::test

// SPDX-License-Identifier: Apache-2.0
// Inactive primitives and primitive maps of BLAS builds, and packed instances.
#include "rt/blas_input.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "base/error.h"
#include "rt/tlas.h"

namespace quintet::rt {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Mesh {
  explicit Mesh(std::size_t count, std::uint32_t seed = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    for (std::uint32_t k = 0; k < 3 * count; ++k) positions.emplace_back(unit(random), unit(random), unit(random));
    for (std::uint32_t k = 0; k < count; ++k) triangles.emplace_back(3 * k, 3 * k + 1, 3 * k + 2);
  }
  GeometryInput geometry() const { return {.positions = positions, .triangles = triangles}; }
  std::vector<vec3> positions;
  std::vector<uvec3> triangles;
};

TEST(GeometryData, KeepsTheInputWithoutSorting) {
  const Mesh mesh(10);
  const BlasData data = prepareBlas({.geometries = {mesh.geometry()}, .options = {}}, false);
  ASSERT_EQ(data.geometries.size(), 1u);
  EXPECT_TRUE(data.geometries[0].map.empty());
  EXPECT_EQ(data.geometries[0].input.triangles.data(), mesh.triangles.data());
  EXPECT_EQ(data.geometries[0].count, 10u);
  EXPECT_EQ(data.inactiveCount, 0u);
  EXPECT_FALSE(data.bounds.empty());
}

TEST(GeometryData, MapsBuiltPrimitivesToTheInput) {
  for (const bool order : {false, true}) {
    Mesh first(500, 1), second(300, 2);
    first.positions[3 * 17].x = kNan;
    first.positions[3 * 499 + 2].z = std::numeric_limits<float>::infinity();
    second.positions[0].y = -std::numeric_limits<float>::infinity();
    const BlasInput input{.geometries = {first.geometry(), second.geometry()}, .options = {}};
    const BlasData data = prepareBlas(input, order);
    EXPECT_EQ(data.inactiveCount, 3u);
    EXPECT_EQ(data.geometries[0].count, 498u);
    EXPECT_EQ(data.geometries[1].count, 299u);
    for (std::size_t g = 0; g < 2; ++g) {
      const GeometryData& geometry = data.geometries[g];
      ASSERT_EQ(geometry.map.size(), geometry.count);
      std::vector<uvec3> built(geometry.count);
      ASSERT_EQ(geometry.primitiveBytes(), built.size() * sizeof(uvec3));
      geometry.gather(std::as_writable_bytes(std::span(built)));
      for (std::size_t k = 0; k < geometry.count; ++k)
        EXPECT_EQ(built[k], input.geometries[g].triangles[geometry.map[k]]);
      std::vector<std::uint32_t> sorted = geometry.map;
      std::ranges::sort(sorted);
      EXPECT_EQ(std::ranges::adjacent_find(sorted), sorted.end());
      EXPECT_FALSE(std::ranges::binary_search(sorted, g == 0 ? 17u : 0u));
    }
  }
}

TEST(GeometryData, KeepsEmptyGeometries) {
  Mesh broken(3);
  for (vec3& p : broken.positions) p.x = kNan;
  const Mesh none(0), good(5);
  const BlasData data =
      prepareBlas({.geometries = {none.geometry(), broken.geometry(), good.geometry()}, .options = {}}, true);
  ASSERT_EQ(data.geometries.size(), 3u);
  EXPECT_EQ(data.geometries[0].count, 0u);
  EXPECT_EQ(data.geometries[1].count, 0u);
  EXPECT_EQ(data.geometries[2].count, 5u);
  EXPECT_EQ(data.inactiveCount, 3u);
}

TEST(GeometryData, RemovesNonFiniteAndInvertedBoxes) {
  std::vector<Bounds3> boxes(6, Bounds3{vec3(0), vec3(1)});
  boxes[1] = Bounds3{};
  boxes[2].min.y = 2.0f;
  boxes[3].max.z = kNan;
  boxes[4] = {vec3(3), vec3(3)};  // a point is active
  const BlasData data =
      prepareBlas({.geometries = {{.kind = GeometryKind::boxes, .boxes = boxes}}, .options = {}}, false);
  EXPECT_EQ(data.inactiveCount, 3u);
  EXPECT_EQ(data.geometries[0].map, (std::vector<std::uint32_t>{0, 4, 5}));
  EXPECT_EQ(data.bounds.max, vec3(3));
}

TEST(GeometryData, ConvertsFlags) {
  const Mesh mesh(1);
  GeometryInput input = mesh.geometry();
  EXPECT_EQ(applyMap(input, {}, 1).flags, VkGeometryFlagsKHR{VK_GEOMETRY_OPAQUE_BIT_KHR});
  input.opaque = false;
  input.singleAnyHit = true;
  EXPECT_EQ(applyMap(input, {}, 1).flags, VkGeometryFlagsKHR{VK_GEOMETRY_NO_DUPLICATE_ANY_HIT_INVOCATION_BIT_KHR});
}

TEST(InstanceData, PacksRowMajorMatrices) {
  InstanceInput instance;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row) instance.worldFromObject[column][row] = static_cast<float>(10 * row + column);
  instance.customIndex = 0xFFFFFF;
  instance.recordOffset = 0x123456;
  instance.mask = 0x81;
  instance.flags = VK_GEOMETRY_INSTANCE_FORCE_OPAQUE_BIT_KHR;
  const VkAccelerationStructureInstanceKHR packed = packInstance(instance);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      EXPECT_EQ(packed.transform.matrix[row][column], static_cast<float>(10 * row + column));
  EXPECT_EQ(packed.instanceCustomIndex, 0xFFFFFFu);
  EXPECT_EQ(packed.instanceShaderBindingTableRecordOffset, 0x123456u);
  EXPECT_EQ(packed.mask, 0x81u);
  EXPECT_EQ(packed.flags, VkGeometryInstanceFlagsKHR{VK_GEOMETRY_INSTANCE_FORCE_OPAQUE_BIT_KHR});
}

TEST(InstanceData, RejectsTooLargeFieldsOfInactiveInstances) {
  InstanceInput instance;  // inactive without a BLAS
  EXPECT_FALSE(isActive(instance));
  EXPECT_TRUE(packInstances({&instance, 1}, InstanceOrder::spatial).empty());
  instance.customIndex = 1u << 24;
  EXPECT_THROW(packInstances({&instance, 1}, InstanceOrder::spatial), UsageError);
}

}  // namespace
}  // namespace quintet::rt

// SPDX-License-Identifier: Apache-2.0
// The measure that decides when a refitted BLAS is built again.
#include "rt/refit_quality.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace quintet::rt {
namespace {

// Small triangles in a cube of side 10.
struct Cloud {
  std::vector<vec3> positions;
  std::vector<uvec3> triangles;

  explicit Cloud(std::uint32_t count) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    for (std::uint32_t i = 0; i < count; ++i) {
      const vec3 corner = 10.0f * vec3(unit(random), unit(random), unit(random));
      positions.insert(positions.end(), {corner, corner + vec3(0.1f, 0, 0), corner + vec3(0, 0.1f, 0.1f)});
      triangles.push_back(uvec3(3 * i, 3 * i + 1, 3 * i + 2));
    }
  }
  BlasInput input() const {
    BlasInput input;
    GeometryInput& geometry = input.geometries.emplace_back();
    geometry.positions = positions;
    geometry.triangles = triangles;
    return input;
  }
  void transform(const mat4& m) {
    for (vec3& p : positions) p = vec3(m * vec4(p, 1.0f));
  }
};

TEST(RefitQuality, ScalingAndMovingTheMeshDoNotChangeIt) {
  Cloud cloud(500);
  const RefitQuality quality(cloud.input());
  EXPECT_DOUBLE_EQ(quality.growth(cloud.input()), 1.0);
  cloud.transform(glm::translate(mat4(1.0f), vec3(100, -5, 3)) * glm::scale(mat4(1.0f), vec3(7.0f)));
  EXPECT_NEAR(quality.growth(cloud.input()), 1.0, 1e-3);
}

TEST(RefitQuality, GrowsWhenTrianglesExchangePlaces) {
  Cloud cloud(500);
  const RefitQuality quality(cloud.input());
  Cloud slightly = cloud;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-0.02f, 0.02f);
  for (vec3& p : slightly.positions) p += vec3(unit(random), unit(random), unit(random));
  EXPECT_LT(quality.growth(slightly.input()), kMaxRefitGrowth);
  Cloud shuffled = cloud;  // the same triangles, but neighbors in the tree are far apart
  std::ranges::shuffle(shuffled.triangles, random);
  EXPECT_GT(quality.growth(shuffled.input()), 5.0);
  EXPECT_NEAR(RefitQuality(shuffled.input()).growth(shuffled.input()), 1.0, 1e-12) << "a new build is good again";
}

TEST(RefitQuality, DegenerateMeshesDoNotCount) {
  Cloud cloud(4);
  const RefitQuality quality(cloud.input());
  for (vec3& p : cloud.positions) p = vec3(1.0f);
  EXPECT_LE(quality.growth(cloud.input()), 1.0);
  const RefitQuality flat(cloud.input());
  EXPECT_EQ(flat.growth(cloud.input()), 1.0);
  EXPECT_EQ(RefitQuality(BlasInput{}).growth(BlasInput{}), 1.0);
}

}  // namespace
}  // namespace quintet::rt

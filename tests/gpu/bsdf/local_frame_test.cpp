// SPDX-License-Identifier: Apache-2.0
// The local frame of any normal is orthonormal and right-handed, with the normal as its third column.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "harness.h"

namespace quintet::test {
namespace {

TEST(BsdfFrame, IsOrthonormalForAllNormals) {
  struct Out {
    vec3 x, y, z;
  };
  std::vector<vec3> normals{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  for (int i = 0; i < 400; ++i) {
    const float z = 1.0f - 2.0f * (static_cast<float>(i) + 0.5f) / 400.0f, r = std::sqrt(1.0f - z * z);
    const float phi = 2.4f * static_cast<float>(i);
    normals.emplace_back(r * std::cos(phi), r * std::sin(phi), z);
  }
  for (const float angle : {1e-2f, 1e-3f, 1e-4f, 1e-6f})  // close to the poles
    for (const float side : {1.0f, -1.0f})
      for (const float turn : {0.0f, 1.0f, 2.5f, 4.0f})
        normals.emplace_back(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn),
                             side * std::cos(angle));
  const std::vector<Out> frames = runCompute<Out>(R"(
    #include <quintet/bsdf/local_frame.glsl>
    #define In vec3
    struct Out_ { vec3 x; vec3 y; vec3 z; };
    #define Out Out_
    Out run(uint index, In n) {
      mat3 m = localFrame(n);
      return Out(m[0], m[1], m[2]);
    }
  )",
                                                  normals);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto& [x, y, z] = frames[i];
    SCOPED_TRACE(testing::Message() << normals[i].x << ", " << normals[i].y << ", " << normals[i].z);
    EXPECT_EQ(z, normals[i]);
    EXPECT_NEAR(glm::length(x), 1.0f, 1e-5f);
    EXPECT_NEAR(glm::length(y), 1.0f, 1e-5f);
    EXPECT_NEAR(glm::dot(x, z), 0.0f, 1e-5f);
    EXPECT_LT(glm::length(glm::cross(x, y) - z), 2e-5f);
  }
}

}  // namespace
}  // namespace quintet::test

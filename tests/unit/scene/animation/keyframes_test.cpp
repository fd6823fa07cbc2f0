// SPDX-License-Identifier: Apache-2.0
// Interpolation between, before and after keyframes.
#include "scene/animation/keyframes.h"

#include "scene/animation/pose.h"

#include <gtest/gtest.h>

namespace quintet::test {
namespace {

void expectNear(const mat4& a, const mat4& b) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) EXPECT_NEAR(a[column][row], b[column][row], 1e-5f) << column << row;
}

mat4 rotated(float degrees) { return glm::rotate(mat4(1), glm::radians(degrees), vec3(0, 1, 0)); }
quat rotation(float degrees) { return glm::angleAxis(glm::radians(degrees), vec3(0, 1, 0)); }

TEST(Keyframes, ReturnsTheTransformOfStaticInstances) {
  scene::Instance instance;
  instance.worldFromObject = glm::translate(mat4(1), vec3(1, 2, 3));
  EXPECT_EQ(scene::worldFromObjectAt(instance, 17), instance.worldFromObject);
}

TEST(Keyframes, InterpolatesEachPart) {
  scene::Instance instance;
  instance.keyframes = {{10, vec3(0), rotation(0), vec3(1)},
                        {20, vec3(10, 0, 0), rotation(90), vec3(3, 1, 1)},
                        {40, vec3(10, 4, 0), rotation(90), vec3(1)}};
  expectNear(scene::worldFromObjectAt(instance, 0), mat4(1));
  expectNear(scene::worldFromObjectAt(instance, 10), mat4(1));
  // Halfway: half the angle; translate · rotate · scale.
  expectNear(scene::worldFromObjectAt(instance, 15),
             glm::translate(mat4(1), vec3(5, 0, 0)) * rotated(45) * glm::scale(mat4(1), vec3(2, 1, 1)));
  // One fifth: the angle is proportional to time, unlike that of interpolated matrices.
  expectNear(scene::worldFromObjectAt(instance, 12),
             glm::translate(mat4(1), vec3(2, 0, 0)) * rotated(18) * glm::scale(mat4(1), vec3(1.4f, 1, 1)));
  expectNear(scene::worldFromObjectAt(instance, 30),
             glm::translate(mat4(1), vec3(10, 2, 0)) * rotated(90) * glm::scale(mat4(1), vec3(2, 1, 1)));
  expectNear(scene::worldFromObjectAt(instance, 1000), glm::translate(mat4(1), vec3(10, 4, 0)) * rotated(90));
}

TEST(Keyframes, RotatesAlongTheShorterArc) {
  scene::Instance instance;
  instance.keyframes = {{0, vec3(0), rotation(170), vec3(1)}, {1, vec3(0), rotation(190), vec3(1)}};
  expectNear(scene::worldFromObjectAt(instance, 0.5f), rotated(180));
  instance.keyframes[1].rotation = -rotation(190);  // the same rotation
  expectNear(scene::worldFromObjectAt(instance, 0.5f), rotated(180));
}

TEST(Keyframes, FindsTheLastKeyframe) {
  scene::Scene s;
  EXPECT_EQ(scene::lastFrame(s), 0.0f);
  s.instances.resize(2);
  s.instances[1].keyframes = {{0, {}, rotation(0), vec3(1)}, {44, {}, rotation(0), vec3(1)}};
  EXPECT_EQ(scene::lastFrame(s), 44.0f);
}

}  // namespace
}  // namespace quintet::test

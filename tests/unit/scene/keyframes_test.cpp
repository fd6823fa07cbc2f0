// Moving instances between, before and after their keyframes.
#include "scene/keyframes.h"

#include <gtest/gtest.h>

namespace quintet::test {
namespace {

void expectNear(const mat4& a, const mat4& b) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) EXPECT_NEAR(a[column][row], b[column][row], 1e-5f) << column << row;
}

mat4 turned(float degrees) { return glm::rotate(mat4(1), glm::radians(degrees), vec3(0, 1, 0)); }
quat turn(float degrees) { return glm::angleAxis(glm::radians(degrees), vec3(0, 1, 0)); }

TEST(Keyframes, AStillInstanceStaysWhereItIs) {
  scene::Instance instance;
  instance.worldFromObject = glm::translate(mat4(1), vec3(1, 2, 3));
  EXPECT_EQ(scene::worldFromObjectAt(instance, 17), instance.worldFromObject);
}

TEST(Keyframes, InterpolatesEachPart) {
  scene::Instance instance;
  instance.keyframes = {{10, vec3(0), turn(0), vec3(1)},
                        {20, vec3(10, 0, 0), turn(90), vec3(3, 1, 1)},
                        {40, vec3(10, 4, 0), turn(90), vec3(1)}};
  expectNear(scene::worldFromObjectAt(instance, 0), mat4(1));
  expectNear(scene::worldFromObjectAt(instance, 10), mat4(1));
  // Half way: half the angle; translate · rotate · scale.
  expectNear(scene::worldFromObjectAt(instance, 15),
             glm::translate(mat4(1), vec3(5, 0, 0)) * turned(45) * glm::scale(mat4(1), vec3(2, 1, 1)));
  // A fifth of the way: the angle grows evenly, unlike that of interpolated matrices.
  expectNear(scene::worldFromObjectAt(instance, 12),
             glm::translate(mat4(1), vec3(2, 0, 0)) * turned(18) * glm::scale(mat4(1), vec3(1.4f, 1, 1)));
  expectNear(scene::worldFromObjectAt(instance, 30),
             glm::translate(mat4(1), vec3(10, 2, 0)) * turned(90) * glm::scale(mat4(1), vec3(2, 1, 1)));
  expectNear(scene::worldFromObjectAt(instance, 1000), glm::translate(mat4(1), vec3(10, 4, 0)) * turned(90));
}

TEST(Keyframes, TurnsTheShorterWay) {
  scene::Instance instance;
  instance.keyframes = {{0, vec3(0), turn(170), vec3(1)}, {1, vec3(0), turn(190), vec3(1)}};
  expectNear(scene::worldFromObjectAt(instance, 0.5f), turned(180));
  instance.keyframes[1].rotation = -turn(190);  // the same rotation
  expectNear(scene::worldFromObjectAt(instance, 0.5f), turned(180));
}

TEST(Keyframes, LastOfAScene) {
  scene::Scene s;
  EXPECT_EQ(scene::lastKeyframe(s), 0.0f);
  s.instances.resize(2);
  s.instances[1].keyframes = {{0, {}, turn(0), vec3(1)}, {44, {}, turn(0), vec3(1)}};
  EXPECT_EQ(scene::lastKeyframe(s), 44.0f);
}

}  // namespace
}  // namespace quintet::test

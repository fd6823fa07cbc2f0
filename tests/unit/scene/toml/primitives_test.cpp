// SPDX-License-Identifier: Apache-2.0
// Scene files: primitive sets, CSG trees, random and grid, instances.
#include <gmock/gmock.h>

#include <random>
#include <set>

#include "scene/csg_oracle.h"
#include "scene/toml/parse.h"

namespace quintet::test {
namespace {

using scene::Scene;
using testing::AllOf;
using testing::HasSubstr;

const scene::PrimitiveSet& onlySet(const Scene& s) { return s.meshes.at(0).primitiveSets.at(0); }

TEST(SceneToml, PlacesSolidsAsSpecified) {
  const Scene s = parse(R"(
[[material]]
name = "m"
[[spheres]]
name = "s"
material = "m"
items = [ { center = [1, 2, 3], radius = 0.5 }, { radius = 2, scale = [1, 1, 0.5] } ]
[[boxes]]
items = [ { min = [0, 1, 2], max = [2, 5, 3] }, { center = [5, 0, 0], size = [2, 4, 6], rotate = [0, 0, 90] }, {} ]
[[cylinders]]
items = [ { from = [1, 0, 0], to = [4, 0, 0], radius = 0.5 }, { axis = "z", height = 4, radius = 3 } ]
[[cones]]
items = [ { from = [0, 0, 0], to = [0, -3, 0], radius = 0.5 } ]
[[tori]]
items = [ { radius = 2, tube = 0.5, axis = [1, 0, 0] } ]
)");
  ASSERT_EQ(s.meshes.size(), 5u);
  ASSERT_EQ(s.instances.size(), 5u);
  EXPECT_EQ(s.instances[0].name, "s");
  EXPECT_EQ(s.meshes[0].primitiveSets[0].name, "s");
  const auto bounds = [&](std::size_t mesh, std::size_t i) {
    return scene::boxesOf(s.meshes[mesh].primitiveSets[0])[i];
  };
  const auto expectBox = [&](std::size_t mesh, std::size_t i, vec3 low, vec3 high) {
    SCOPED_TRACE(mesh);
    expectNear(bounds(mesh, i).min, low, 1e-5f);
    expectNear(bounds(mesh, i).max, high, 1e-5f);
  };
  expectBox(0, 0, {0.5f, 1.5f, 2.5f}, {1.5f, 2.5f, 3.5f});
  expectBox(0, 1, {-2, -2, -1}, {2, 2, 1});
  expectBox(1, 0, {0, 1, 2}, {2, 5, 3});
  expectBox(1, 1, {3, -1, -3}, {7, 1, 3});  // rotated about its own center
  expectBox(1, 2, {-1, -1, -1}, {1, 1, 1});
  expectBox(2, 0, {1, -0.5f, -0.5f}, {4, 0.5f, 0.5f});
  expectBox(2, 1, {-3, -3, -2}, {3, 3, 2});
  expectBox(3, 0, {-0.5f, -3, -0.5f}, {0.5f, 0, 0.5f});
  expectBox(4, 0, {-0.5f, -2.5f, -2.5f}, {0.5f, 2.5f, 2.5f});
  // The base of the cone is at `from`, its apex at `to`.
  expectNear(apply(s.meshes[3].primitiveSets[0].primitives[0].objectFromPrimitive, {0, 1, 0}), {0, -3, 0});
  EXPECT_EQ(s.meshes[4].primitiveSets[0].primitives[0].parameter, 0.25f);
  EXPECT_EQ(s.materials[static_cast<std::size_t>(s.meshes[0].primitiveSets[0].primitives[0].material)].name, "m");
  EXPECT_EQ(s.materials[static_cast<std::size_t>(s.meshes[1].primitiveSets[0].primitives[0].material)].name, "default");
}

TEST(SceneToml, DrawsRandomElementsAsDocumented) {
  const Scene s = parse(R"(
[[material]]
name = "a"
[[material]]
name = "b"
[[spheres]]
random = { count = 50, seed = 9, box = [[-1, 0, 2], [1, 4, 2]], radius = [0.1, 0.3], materials = ["a", "b"] }
)");
  const scene::PrimitiveSet& set = onlySet(s);
  ASSERT_EQ(set.primitives.size(), 50u);
  std::mt19937 generator(9);
  const auto next = [&] { return static_cast<double>(generator()) / 4294967296.0; };
  std::set<int> materials;
  for (const scene::Primitive& p : set.primitives) {
    const double x = next(), y = next();
    next();
    expectNear(apply(p.objectFromPrimitive, vec3(0)), vec3(glm::dvec3(-1 + 2 * x, 4 * y, 2)));
    const double r = 0.1 + 0.2 * next();
    EXPECT_NEAR(p.objectFromPrimitive[0][0], r, 1e-6);
    EXPECT_EQ(p.material, next() < 0.5 ? 0 : 1);
    materials.insert(p.material);
  }
  EXPECT_EQ(materials.size(), 2u);
}

TEST(SceneToml, CreatesRandomBoxes) {
  const Scene s =
      parse("[[custom]]\nrandom = { count = 10000, seed = 1, box = [[-10, -10, -10], [10, 10, 10]], size = 0.2 }\n");
  EXPECT_EQ(onlySet(s).boxes.size(), 10000u);
  EXPECT_EQ(onlySet(s).kind, scene::PrimitiveSetKind::custom);
  for (const Bounds3& box : onlySet(s).boxes) expectNear(box.extent(), vec3(0.2f), 1e-5f);
  const Bounds3 world = scene::worldBounds(s);
  EXPECT_LT(world.min.x, -9.9f);
  EXPECT_GE(world.min.x, -10.1f);
}

TEST(SceneToml, CentersGridsAndCyclesMaterials) {
  const Scene s = parse(R"(
[[material]]
name = "a"
[[material]]
name = "b"
[[boxes]]
grid = { count = [3, 2, 1], spacing = [2, 10, 0], center = [0, 5, 0], size = 1, materials = ["a", "b"] }
[[tori]]
tube = 0.5
grid = { count = [1, 1, 1], spacing = 1, size = 3 }
)");
  const scene::PrimitiveSet& set = onlySet(s);
  ASSERT_EQ(set.primitives.size(), 6u);
  expectNear(apply(set.primitives[0].objectFromPrimitive, vec3(0)), {-2, 0, 0});
  expectNear(apply(set.primitives[1].objectFromPrimitive, vec3(0)), {0, 0, 0});
  expectNear(apply(set.primitives[5].objectFromPrimitive, vec3(0)), {2, 10, 0});
  EXPECT_EQ(set.primitives[1].material, 1);
  EXPECT_EQ(set.primitives[2].material, 0);
  expectNear(scene::boxesOf(set)[0].extent(), vec3(1), 1e-5f);
  expectNear(scene::boxesOf(s.meshes[1].primitiveSets[0])[0].extent(), vec3(3, 1, 3), 1e-5f);  // outer diameter 3
}

TEST(SceneToml, TurnsItemsByUniformRotations) {
  const Scene s = parse("[[boxes]]\nrandom = { count = 200, box = [[0, 0, 0], [0, 0, 0]], size = 2, turn = true }\n");
  vec3 mean(0.0f);
  for (const scene::Primitive& p : onlySet(s).primitives) {
    const mat3 m(p.objectFromPrimitive);
    EXPECT_NEAR(glm::determinant(m), 1.0f, 1e-5f);
    expectNear(vec3(glm::length(m[0]), glm::length(m[1]), glm::dot(m[0], m[1]) + 1), vec3(1), 1e-5f);
    mean += m[1] / 200.0f;
  }
  EXPECT_LT(glm::length(mean), 0.2f);  // all directions are equally likely
}

TEST(SceneToml, BuildsTheDescribedCsgTrees) {
  const Scene s = parse(R"(
[[material]]
name = "outer"
[[material]]
name = "inner"
[[csg]]
name = "half"
tree = { intersection = [ { sphere = {} }, { box = { min = [-2, -2, -2], max = [2, 0, 2] } } ] }
[[csg]]
name = "die"
material = "outer"
translate = [10, 0, 0]
tree = { difference = [
  { box = {} },
  { sphere = { radius = 0.5 }, material = "inner", translate = [1, 0, 0] },
  { csg = "half", scale = 0.5, translate = [0, 1, 0] },
], rotate = [0, 0, 90] }
)");
  ASSERT_EQ(s.meshes.size(), 2u);
  ASSERT_EQ(s.instances.size(), 1u);  // the operand is not placed by default
  EXPECT_EQ(s.instances[0].name, "die");
  const scene::PrimitiveSet& set = s.meshes[1].primitiveSets[0];
  ASSERT_EQ(set.trees.size(), 1u);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1.3, 1.3);
  int insideCount = 0;
  for (int i = 0; i < 3000; ++i) {
    const double x = unit(random), y = unit(random), z = unit(random);
    const glm::dvec3 p(x, y, z);  // before rotation and translation
    const bool box = std::max({std::abs(x), std::abs(y), std::abs(z)}) <= 1.0;
    const bool hole = glm::length(p - glm::dvec3(1, 0, 0)) <= 0.5;
    const bool bowl = glm::length(p - glm::dvec3(0, 1, 0)) <= 0.5 && y <= 1.0;
    const bool expected = box && !hole && !bowl;
    EXPECT_EQ(oracle::inside(set, set.trees[0], glm::dvec3(10 - y, x, z)), expected);
    insideCount += expected;
  }
  EXPECT_GT(insideCount, 500);
  std::multiset<std::string> materials;
  for (const scene::Primitive& p : set.primitives)
    materials.insert(s.materials[static_cast<std::size_t>(p.material)].name);
  EXPECT_EQ(materials, (std::multiset<std::string>{"outer", "inner", "outer", "outer"}));
}

TEST(SceneToml, ReadsSeveralTreesIntoOneSet) {
  const Scene s = parse(R"(
[[csg]]
trees = [ { sphere = {} }, { union = [ { sphere = {} }, { cone = {} }, { torus = {} } ] } ]
)");
  ASSERT_EQ(onlySet(s).trees.size(), 2u);
  EXPECT_EQ(onlySet(s).trees[1].firstNode, 1u);
  EXPECT_EQ(onlySet(s).trees[1].nodeCount, 5u);
}

TEST(SceneToml, OrdersOperandsForASmallStack) {
  std::string tree = "{ sphere = {} }";
  for (int i = 0; i < 60; ++i) tree = "{ union = [ { box = {} }, " + tree + " ] }";
  const Scene s = parse("[[csg]]\ntree = " + tree + "\n");
  EXPECT_EQ(scene::csgStackSize(onlySet(s).nodes), 2u);
  tree = "{ sphere = {} }";
  for (int i = 0; i < 32; ++i) tree = "{ difference = [ { box = {} }, " + tree + " ] }";
  EXPECT_THAT(errorOfToml("[[csg]]\nname = 'deep'\ntree = " + tree + "\n"),
              AllOf(HasSubstr("test.scene.toml: line 3: 'tree' of [[csg]] 'deep'"), HasSubstr("33")));
}

TEST(SceneToml, ReadsInstances) {
  const Scene s = parse(R"(
[[spheres]]
name = "ball"
items = [{}]
[[mesh]]
name = "quad"
shape = "quad"
[[mesh]]
name = "alone"
shape = "cube"
[[instance]]
of = "ball"
name = "first"
translate = [1, 2, 3]
rotate = { axis = [0, 1, 0], degrees = 90 }
scale = 2
mask = 0x0F
flags = ["force_opaque", "cull_disable"]
custom_index = 77
[[instance]]
of = "ball"
rotate = { quaternion = [0, 0, 1, 1] }
[[instance]]
of = "quad"
matrix = [[1, 0, 0, 5], [0, 1, 0, 6], [0, 0, 1, 7]]
[[instance]]
of = "quad"
matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]
[[instance]]
of = "ball"
name = "many"
translate = [0, 100, 0]
custom_index = 5
grid = { count = [2, 1, 1], spacing = 4, scale = 0.5 }
)");
  ASSERT_EQ(s.instances.size(), 7u);
  const scene::Instance& first = s.instances[0];
  EXPECT_EQ(first.name, "first");
  EXPECT_EQ(first.mask, 0x0Fu);
  EXPECT_EQ(first.flags, scene::kInstanceForceOpaque | scene::kInstanceCullDisable);
  EXPECT_EQ(first.customIndex, 77u);
  expectNear(apply(first.worldFromObject, {1, 0, 0}), {1, 2, 1}, 1e-5f);
  expectNear(apply(s.instances[1].worldFromObject, {1, 0, 0}), {0, 1, 0}, 1e-5f);
  EXPECT_EQ(s.instances[1].mask, 0xFFu);
  EXPECT_EQ(s.instances[1].name, "ball");
  EXPECT_EQ(s.instances[2].worldFromObject, s.instances[3].worldFromObject);
  expectNear(apply(s.instances[2].worldFromObject, vec3(0)), {5, 6, 7});
  EXPECT_EQ(s.instances[4].name, "many[0]");
  EXPECT_EQ(s.instances[5].customIndex, 6u);
  expectNear(apply(s.instances[5].worldFromObject, {1, 0, 0}), {2.5f, 100, 0});
  EXPECT_EQ(s.instances[6].name, "alone");  // placed at the origin by default
  EXPECT_EQ(s.instances[6].worldFromObject, mat4(1.0f));
}

TEST(SceneToml, KeepsUnspecifiedPartsOfKeyframes) {
  const Scene s = parse(R"(
[[mesh]]
name = "q"
shape = "quad"
[[instance]]
of = "q"
translate = [1, 0, 0]
scale = 2
keyframes = [ { frame = 0 }, { frame = 10, translate = [3, 0, 0] }, { frame = 20, rotate = [0, 0, 90] } ]
)");
  const std::vector<scene::Keyframe>& keys = s.instances[0].keyframes;
  ASSERT_EQ(keys.size(), 3u);
  EXPECT_EQ(keys[0].translation, vec3(1, 0, 0));
  EXPECT_EQ(keys[2].translation, vec3(3, 0, 0));
  EXPECT_EQ(keys[2].scale, vec3(2));
  expectNear(vec3(s.instances[0].worldFromObject[3]), {1, 0, 0});
}

TEST(SceneToml, CollectsGeometriesInObjects) {
  const Scene s = parse(R"(
[[spheres]]
name = "a"
object = "both"
items = [{}]
[[custom]]
name = "b"
object = "both"
boxes = [{ min = [0, 0, 0], max = [1, 1, 1] }, { center = [3, 3, 3], size = [0, 1, 2] }]
[[csg]]
name = "c"
object = "both"
tree = { sphere = {} }
[[boxes]]
name = "d"
object = "both"
items = [{}]
[[instance]]
of = "both"
)");
  ASSERT_EQ(s.meshes.size(), 1u);
  ASSERT_EQ(s.instances.size(), 1u);
  std::string names;
  for (const scene::PrimitiveSet& set : s.meshes[0].primitiveSets) names += set.name;
  EXPECT_EQ(names, "abcd");  // the order of the file
  EXPECT_THAT(errorOfToml("[[mesh]]\nshape = 'quad'\nobject = 'x'\n[[spheres]]\nobject = 'x'\nitems = [{}]\n"),
              HasSubstr("line 5: object 'x'"));
}

}  // namespace
}  // namespace quintet::test

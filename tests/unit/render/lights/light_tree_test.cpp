// SPDX-License-Identifier: Apache-2.0
// The light tree: each node bounds the lights below it, each light has one leaf, and builds are deterministic.
#include "render/lights/light_tree.h"

#include <algorithm>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "render/lights/light_table.h"

namespace quintet::render {
namespace {

using glm::dvec3;

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  float operator()(float low, float high) {
    return low + (high - low) * static_cast<float>(static_cast<double>(engine_()) * 0x1p-32);
  }
  vec3 point(float size) { return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)}; }
  vec3 direction() {
    for (;;) {
      const vec3 v = point(1.0f);
      if (glm::length(v) > 0.1f && glm::length(v) <= 1.0f) return glm::normalize(v);
    }
  }

 private:
  std::mt19937 engine_;
};

LightTree treeOf(std::vector<LightTreeInput> lights, std::size_t lightCount) {
  LightTree tree;
  tree.build(lights, lightCount);
  return tree;
}

// Clusters of triangles, points and spots with very different sizes and powers.
struct Case {
  std::vector<LightTreeInput> lights;
  std::vector<std::vector<vec3>> points;  // points on each light
  std::vector<vec3> normals;              // 0 means all directions
};

Case makeCase(std::size_t count, std::uint32_t seed) {
  Random random(seed);
  Case c;
  vec3 cluster(0.0f);
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 16 == 0) cluster = random.point(100.0f);
    const vec3 p = cluster + random.point(2.0f);
    const double intensity = std::exp(random(-6.0f, 6.0f));
    LightTreeInput input;
    input.light = static_cast<std::uint32_t>(i);
    if (i % 5 == 3) {
      input.bounds = pointBounds(p, intensity);
      c.points.push_back({p});
      c.normals.emplace_back(0.0f);
    } else if (i % 5 == 4) {
      const vec3 d = random.direction();
      input.bounds = spotBounds(p, d, 0.2, 0.5, intensity);
      c.points.push_back({p});
      c.normals.push_back(d);
    } else {
      const std::array<vec3, 3> corners{p, p + random.point(0.5f), p + random.point(0.5f)};
      input.bounds = triangleBounds(corners, mat4(1.0f), intensity);
      c.points.emplace_back(corners.begin(), corners.end());
      c.normals.push_back(glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0])));
    }
    c.lights.push_back(input);
  }
  return c;
}

// Calls body(light, node) for each light and each node on the path from the root to its leaf.
template <class Body>
void forAncestors(const LightTree& tree, const Body& body) {
  for (std::size_t light = 0; light < tree.leaves.size(); ++light) {
    if (tree.leaves[light] == shared::kNoLight) continue;
    const std::uint32_t leaf = tree.leaves[light];
    std::uint32_t at = 0;
    for (int guard = 0; at != leaf; ++guard) {
      ASSERT_LT(guard, 200);
      body(light, at);
      const std::uint32_t pair = tree.nodes[at].link & shared::kLightNodeIndex;
      const std::uint32_t second = tree.nodes[pair + 1].link;
      const bool first = leaf != pair + 1 && (leaf == pair || (second & shared::kLightNodeLeaf) ||
                                              leaf < (second & shared::kLightNodeIndex));
      at = first ? pair : pair + 1;
    }
    EXPECT_EQ(tree.nodes[at].link & (shared::kLightNodeLeaf | shared::kLightNodeIndex), shared::kLightNodeLeaf | light);
    body(light, at);
  }
}

TEST(LightTree, BoundsLightsByNodes) {
  const Case c = makeCase(3000, 1);
  const LightTree tree = treeOf(c.lights, c.lights.size());
  ASSERT_EQ(tree.nodes.size(), 6000u);
  std::vector<double> sums(tree.nodes.size(), 0.0);
  std::size_t narrow = 0;
  forAncestors(tree, [&](std::size_t light, std::uint32_t at) {
    const shared::LightNode& node = tree.nodes[at];
    sums[at] += c.lights[light].bounds.intensity;
    for (const vec3& p : c.points[light])
      ASSERT_LE(glm::distance(dvec3(p), dvec3(node.center)), node.radius) << light << " in " << at;
    const double thetaO = std::acos(std::max(-1.0f, glm::unpackSnorm2x16(node.cone).x));
    const double thetaE = std::acos(glm::unpackSnorm2x16(node.cone).y);
    ASSERT_GE(thetaE, c.lights[light].bounds.thetaE - 1e-6);
    if (c.normals[light] == vec3(0.0f)) {
      ASSERT_GE(thetaO, 3.14159) << light;
      return;
    }
    const dvec3 normal = c.normals[light], axis = unpackLightAxis(node.axis);
    const bool twoSided = (node.link & shared::kLightNodeBothSides) != 0;
    const double cosine = twoSided ? std::abs(glm::dot(normal, axis)) : glm::dot(normal, axis);
    const double angle = std::atan2(glm::length(glm::cross(normal, axis)), cosine) + c.lights[light].bounds.thetaO;
    ASSERT_TRUE(angle <= thetaO + 1e-6 || thetaO > 3.14159)
        << light << " in " << at << ": " << angle << " " << thetaO << " two-sided " << twoSided;
    narrow += thetaO < 1.0 ? 1 : 0;
  });
  EXPECT_GT(narrow, 3000u);  // many cones are narrow
  for (std::size_t i = 0; i < sums.size(); ++i)
    EXPECT_NEAR(tree.nodes[i].intensity, sums[i], 1e-5 * sums[i]) << i;  // 0 for node 1, which is unused
}

TEST(LightTree, IsDeterministic) {
  const Case c = makeCase(100'000, 2);  // more than one task
  const LightTree a = treeOf(c.lights, c.lights.size()), b = treeOf(c.lights, c.lights.size());
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  EXPECT_EQ(std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(shared::LightNode)), 0);
  EXPECT_EQ(a.leaves, b.leaves);
  std::size_t deepest = 0, sum = 0;
  std::vector<std::size_t> depth(c.lights.size(), 0);
  forAncestors(a, [&](std::size_t light, std::uint32_t) {
    deepest = std::max(deepest, ++depth[light]);
    ++sum;
  });
  EXPECT_LT(deepest, 64u);
  EXPECT_LT(sum / c.lights.size(), 24u);  // a full tree has 17.6
}

// Lights that no split can separate, and chains of ever smaller distances.
TEST(LightTree, HandlesDegenerateCases) {
  std::vector<std::vector<LightTreeInput>> cases(5);
  for (std::uint32_t i = 0; i < 5000; ++i) {
    cases[0].push_back({pointBounds(vec3(1, 2, 3), 1.0), i});
    cases[1].push_back({pointBounds(vec3(static_cast<float>(i), 0, 0), 1.0), i});
    cases[2].push_back({pointBounds(vec3(std::ldexp(1.0f, -static_cast<int>(i % 120)), 0, 0), 1.0), i});
    cases[3].push_back({directionalBounds(vec3(0, -1, 0), 1.0), i, LightReach::directional});
  }
  cases[4] = {{pointBounds(vec3(0.0f), 1.0), 0}};
  for (const std::vector<LightTreeInput>& lights : cases) {
    const LightTree tree = treeOf(lights, lights.size());
    std::size_t found = 0;
    forAncestors(tree, [&](std::size_t light, std::uint32_t at) { found += at == tree.leaves[light] ? 1 : 0; });
    EXPECT_EQ(found, lights.size());
    for (const shared::LightNode& node : tree.nodes) EXPECT_TRUE(std::isfinite(node.radius) && isFinite(node.center));
  }
}

TEST(LightTree, SkipsLightsWithoutPower) {
  const LightTree none = treeOf({{pointBounds(vec3(0.0f), 0.0), 0}}, 1);
  EXPECT_EQ(none.leaves, std::vector<std::uint32_t>{shared::kNoLight});
  EXPECT_EQ(none.nodes.at(0).intensity, 0.0f);
  const LightTree one = treeOf({{pointBounds(vec3(0.0f), 0.0), 0}, {pointBounds(vec3(0.0f), 2.0), 1}}, 3);
  EXPECT_EQ(one.leaves, (std::vector<std::uint32_t>{shared::kNoLight, 0, shared::kNoLight}));
}

// Environment, directional lights and finite lights, each with its share.
TEST(LightTree, SeparatesKindsFirst) {
  Case c = makeCase(100, 3);
  c.lights[10] = {environmentBounds(1.0), 10, LightReach::environment};
  c.lights[20] = {directionalBounds(vec3(0, -1, 0), 1.0), 20, LightReach::directional};
  c.lights[30] = {directionalBounds(vec3(0, 1, 0), 1.0), 30, LightReach::directional};
  const LightTree tree = treeOf(c.lights, 100);
  const auto flags = [&](std::uint32_t node) {
    return tree.nodes[node].link & (shared::kLightNodeInfinite | shared::kLightNodeShare);
  };
  const std::uint32_t pair = tree.nodes[0].link & shared::kLightNodeIndex;
  EXPECT_EQ(flags(pair), shared::kLightNodeInfinite | shared::kLightNodeShare);
  EXPECT_EQ(flags(pair + 1), 0u);
  const std::uint32_t infinite = tree.nodes[pair].link & shared::kLightNodeIndex;
  EXPECT_EQ(tree.leaves[10], infinite);
  EXPECT_EQ(flags(infinite), shared::kLightNodeInfinite | shared::kLightNodeShare);
  EXPECT_EQ(flags(infinite + 1), shared::kLightNodeInfinite);
  const std::uint32_t suns = tree.nodes[infinite + 1].link & shared::kLightNodeIndex;
  EXPECT_EQ(std::min(tree.leaves[20], tree.leaves[30]), suns);
  EXPECT_EQ(std::max(tree.leaves[20], tree.leaves[30]), suns + 1);
}

// Solids are within their balls, and the ball of a sphere is tight.
TEST(LightBounds, ContainSolids) {
  Random random(5);
  for (const scene::PrimitiveType type :
       {scene::PrimitiveType::sphere, scene::PrimitiveType::box, scene::PrimitiveType::torus}) {
    scene::Primitive primitive;
    primitive.type = type;
    primitive.objectFromPrimitive =
        glm::translate(glm::rotate(mat4(1.0f), 1.0f, random.direction()), random.point(3.0f));
    const mat4 worldFromObject = glm::scale(glm::translate(mat4(1.0f), random.point(10.0f)),
                                            type == scene::PrimitiveType::box ? vec3(1, 5, 0.2f) : vec3(2.0f));
    const LightBounds bounds = solidBounds(primitive, worldFromObject, 1.0);
    const glm::dmat4 m = glm::dmat4(worldFromObject) * glm::dmat4(primitive.objectFromPrimitive);
    for (int i = 0; i < 1000; ++i) {
      vec3 p = random.direction();
      if (type == scene::PrimitiveType::box) p /= std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
      if (type == scene::PrimitiveType::torus) p = vec3(p.x, 0, p.z) / std::hypot(p.x, p.z) + 0.25f * p;
      ASSERT_LE(glm::distance(dvec3(m * glm::dvec4(p, 1.0)), dvec3(bounds.center)), bounds.radius);
    }
    if (type == scene::PrimitiveType::sphere) {
      EXPECT_NEAR(bounds.radius, 2.0f, 1e-4f);
    }
  }
}

// A triangle and its mirrored copy are two-sided, so they have one narrow cone.
TEST(LightBounds, UniteOppositeNormals) {
  const std::array<vec3, 3> a{vec3(0, 0, 0), {1, 0, 0}, {0, 1, 0}}, b{vec3(0, 0, 0), {0, 1, 0}, {1, 0, 0}};
  const LightBounds both = unite(triangleBounds(a, mat4(1.0f), 1.0), triangleBounds(b, mat4(1.0f), 3.0));
  EXPECT_NEAR(both.thetaO, 0.0f, 1e-3f);
  EXPECT_EQ(both.intensity, 4.0f);
  EXPECT_TRUE(both.twoSided);
  const std::array<vec3, 3> c{vec3(0, 0, 0), {1, 0, 0}, {0, 0, 1}};
  EXPECT_NEAR(unite(both, triangleBounds(c, mat4(1.0f), 1.0)).thetaO, 0.25f * kPi, 1e-3f);
}

// Equation 1 of the paper where it has a closed form.
TEST(LightBounds, ComputeTheOrientationMeasure) {
  const double pi = glm::pi<double>();
  LightBounds bounds;
  bounds.thetaE = 0.5f * kPi;
  EXPECT_NEAR(orientationMeasure(bounds), pi, 1e-6);
  bounds.thetaO = kPi;
  EXPECT_NEAR(orientationMeasure(bounds), 4.0 * pi, 1e-6);
  bounds.thetaO = 0.0f;
  bounds.twoSided = true;
  EXPECT_NEAR(orientationMeasure(bounds), 2.0 * pi, 1e-6);
}

}  // namespace
}  // namespace quintet::render

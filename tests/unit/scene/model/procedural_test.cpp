// SPDX-License-Identifier: Apache-2.0
// Bounds of solids and trees, order of operands, validation of primitive sets.
#include "scene/model/procedural.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "base/error.h"
#include "scene/csg_oracle.h"
#include "scene/error_matcher.h"
#include "scene/model/content_hash.h"
#include "scene/model/scene.h"
#include "scene/model/validate.h"
#include "scene/random_solids.h"

namespace quintet::test {
namespace {

using scene::CsgNode;
using scene::CsgOperation;
using scene::Primitive;
using scene::PrimitiveSet;
using scene::PrimitiveSetKind;
using scene::PrimitiveType;

std::vector<CsgNode> nodes(const std::string& postfix) {  // letters are leaves by number; + * -
  std::vector<CsgNode> result;
  for (const char c : postfix) {
    if (c == '+')
      result.push_back({CsgOperation::unite});
    else if (c == '*')
      result.push_back({CsgOperation::intersect});
    else if (c == '-')
      result.push_back({CsgOperation::subtract});
    else
      result.push_back({CsgOperation::leaf, static_cast<std::uint32_t>(c - 'a')});
  }
  return result;
}

std::string text(const std::vector<CsgNode>& tree) {
  std::string result;
  for (const CsgNode& node : tree)
    result += node.operation == CsgOperation::leaf ? static_cast<char>('a' + node.primitive)
                                                   : " +*-"[static_cast<std::size_t>(node.operation)];
  return result;
}

// Largest coordinate (smallest for sign = -1) of the transformed solid on one axis, by a search over a fine
// parametrization that is independent of the closed forms under test.
double furthest(const Primitive& primitive, const mat4& m, int axis, double sign) {
  double best = -1e30;
  const auto visit = [&](double x, double y, double z) {
    const glm::dvec4 p = glm::dmat4(m) * glm::dmat4(primitive.objectFromPrimitive) * glm::dvec4(x, y, z, 1);
    best = std::max(best, sign * p[axis]);
  };
  constexpr int kSteps = 720;
  for (int i = 0; i < kSteps; ++i) {
    const double u = 2.0 * glm::pi<double>() * i / kSteps, c = std::cos(u), s = std::sin(u);
    switch (primitive.type) {
      case PrimitiveType::sphere:
        for (int k = 0; k <= kSteps / 2; ++k) {
          const double v = 2.0 * glm::pi<double>() * k / kSteps;
          visit(c * std::sin(v), std::cos(v), s * std::sin(v));
        }
        break;
      case PrimitiveType::box:
        for (int corner = 0; corner < 8; ++corner) visit(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        break;
      case PrimitiveType::cylinder: visit(c, 1, s), visit(c, -1, s); break;
      case PrimitiveType::cone: visit(c, -1, s), visit(0, 1, 0); break;
      case PrimitiveType::torus: {
        const double r = static_cast<double>(primitive.parameter);
        for (int k = 0; k < kSteps; ++k) {
          const double v = 2.0 * glm::pi<double>() * k / kSteps, q = 1.0 + r * std::cos(v);
          visit(q * c, r * std::sin(v), q * s);
        }
        break;
      }
    }
  }
  return sign * best;
}

TEST(Procedural, BoundsOfSolidsAreTight) {
  std::mt19937 random(3);
  for (int type = 0; type <= static_cast<int>(PrimitiveType::torus); ++type) {
    for (int i = 0; i < 4; ++i) {
      const Primitive primitive = randomPrimitive(random, static_cast<PrimitiveType>(type));
      const mat4 world = randomTransform(random);
      const Bounds3 bounds = scene::boundsOf(primitive, world);
      const float size = glm::length(bounds.extent());
      for (int axis = 0; axis < 3; ++axis) {
        const double low = furthest(primitive, world, axis, -1.0), high = furthest(primitive, world, axis, 1.0);
        EXPECT_LE(bounds.min[axis], low) << type;
        EXPECT_GE(bounds.max[axis], high) << type;
        EXPECT_NEAR(bounds.min[axis], low, 1e-4 * size) << type;
        EXPECT_NEAR(bounds.max[axis], high, 1e-4 * size) << type;
      }
    }
  }
}

TEST(Procedural, BoundsOfTreesFollowTheOperations) {
  PrimitiveSet set;
  set.kind = PrimitiveSetKind::csg;
  const auto unitBoxAt = [](float x) {
    Primitive p;
    p.type = PrimitiveType::box;
    p.objectFromPrimitive = glm::translate(mat4(1.0f), vec3(x, 0, 0));
    return p;
  };
  set.primitives = {unitBoxAt(0), unitBoxAt(1), unitBoxAt(5)};
  const auto boxOf = [&](const std::string& postfix) {
    set.nodes = nodes(postfix);
    set.trees = {{0, static_cast<std::uint32_t>(set.nodes.size())}};
    return scene::boundsOf(set, set.trees[0]);
  };
  const auto range = [](const Bounds3& b) { return vec2(b.min.x, b.max.x); };
  EXPECT_EQ(range(boxOf("ab+")), vec2(-1, 2));
  EXPECT_EQ(range(boxOf("ab*")), vec2(0, 1));
  EXPECT_EQ(range(boxOf("ab-")), vec2(-1, 1));
  EXPECT_EQ(range(boxOf("abc+-")), vec2(-1, 1));
  EXPECT_EQ(range(boxOf("ac*b+")), vec2(0, 2));
  EXPECT_TRUE(boxOf("ac*").empty());
  // The empty tree has a box without volume.
  const std::vector<Bounds3> boxes = scene::boxesOf(set);
  ASSERT_EQ(boxes.size(), 1u);
  EXPECT_EQ(boxes[0].min, vec3(-1));
  EXPECT_EQ(boxes[0].max, vec3(-1));
}

TEST(Procedural, BoundsContainTrees) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int i = 0; i < 60; ++i) {
    const PrimitiveSet set = randomTree(random, 2 + i % 7);
    const Bounds3 bounds = scene::boundsOf(set, set.trees[0]);
    for (int k = 0; k < 300; ++k) {
      const vec3 p = 8.0f * vec3(unit(random), unit(random), unit(random)) - 4.0f;
      const bool inBox = glm::all(glm::lessThanEqual(bounds.min, p)) && glm::all(glm::lessThanEqual(p, bounds.max));
      if (!inBox) {
        EXPECT_FALSE(oracle::inside(set, set.trees[0], p));
      }
    }
  }
}

TEST(Procedural, OrdersOperandsByStackSize) {
  EXPECT_EQ(scene::csgStackSize(nodes("abcd+++")), 4u);
  EXPECT_EQ(text(scene::orderForSmallStack(nodes("abcd+++"))), "cd+b+a+");
  EXPECT_EQ(text(scene::orderForSmallStack(nodes("abc*+"))), "bc*a+");
  EXPECT_EQ(text(scene::orderForSmallStack(nodes("abc--"))), "abc--");  // no other order describes the same solid
  EXPECT_EQ(text(scene::orderForSmallStack(nodes("ab+cd+*"))), "ab+cd+*");
  EXPECT_EQ(text(scene::orderForSmallStack(nodes("a"))), "a");
  // A balanced tree of 2^k leaves needs a stack of k + 1; a right-leaning comb needs 2.
  std::vector<CsgNode> comb(1000, CsgNode{});
  comb.resize(1999, CsgNode{CsgOperation::unite});
  EXPECT_EQ(scene::csgStackSize(comb), 1000u);
  EXPECT_EQ(scene::csgStackSize(scene::orderForSmallStack(comb)), 2u);
}

TEST(Procedural, ReorderedTreesDescribeTheSameSolid) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int i = 0; i < 40; ++i) {
    PrimitiveSet set = randomTree(random, 9);
    PrimitiveSet ordered = set;
    ordered.nodes = scene::orderForSmallStack(set.nodes);
    EXPECT_EQ(scene::csgProblem(ordered.nodes, ordered.primitives.size()), "");
    EXPECT_LE(scene::csgStackSize(ordered.nodes), scene::csgStackSize(set.nodes));
    for (int k = 0; k < 200; ++k) {
      const glm::dvec3 p(4 * unit(random) - 2, 4 * unit(random) - 2, 4 * unit(random) - 2);
      EXPECT_EQ(oracle::inside(set, set.trees[0], p), oracle::inside(ordered, ordered.trees[0], p));
    }
  }
}

TEST(Procedural, DescribesInvalidTrees) {
  EXPECT_EQ(scene::csgProblem(nodes("ab+"), 2), "");
  EXPECT_THAT(scene::csgProblem(nodes("ab+"), 1), IsErrorAt("node 1", "primitive 1"));
  EXPECT_THAT(scene::csgProblem(nodes("a+"), 1), IsErrorAt("node 1", "two operands"));
  EXPECT_THAT(scene::csgProblem(nodes("ab"), 2), IsErrorAt("", "2 results"));
  EXPECT_THAT(scene::csgProblem({}, 2), IsErrorAt("", "0 results"));
  std::vector<CsgNode> chain(33, CsgNode{});
  chain.resize(65, CsgNode{CsgOperation::subtract});
  EXPECT_THAT(scene::csgProblem(chain, 1), IsErrorAt("", "33"));
  chain.erase(chain.begin());
  chain.pop_back();
  EXPECT_EQ(scene::csgProblem(chain, 1), "");
}

scene::Scene proceduralScene() {
  scene::Scene s;
  std::mt19937 random(1);
  PrimitiveSet solids;
  solids.primitives = {randomPrimitive(random, PrimitiveType::sphere), randomPrimitive(random, PrimitiveType::torus)};
  PrimitiveSet custom;
  custom.kind = PrimitiveSetKind::custom;
  custom.boxes = {{vec3(0), vec3(1)}};
  s.meshes.emplace_back().primitiveSets = {solids, randomTree(random, 3), custom};
  s.instances.emplace_back().mesh = 0;
  return s;
}

TEST(Procedural, ValidationReportsTheFirstError) {
  EXPECT_NO_THROW(scene::validate(proceduralScene()));
  const auto faultOf = [](const std::function<void(std::vector<PrimitiveSet>&)>& change) -> std::string {
    scene::Scene s = proceduralScene();
    change(s.meshes[0].primitiveSets);
    try {
      scene::validate(s);
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  };
  const std::string at = "scene: meshes[0].primitiveSets";
  EXPECT_THAT(faultOf([](auto& s) { s[0].primitives[1].parameter = 1; }),
              IsErrorAt(at + "[0].primitives[1].parameter", "torus"));
  EXPECT_THAT(faultOf([](auto& s) { s[0].primitives[0].objectFromPrimitive[2] = vec4(0); }),
              IsErrorAt(at + "[0].primitives[0].objectFromPrimitive", "singular"));
  EXPECT_THAT(faultOf([](auto& s) { s[0].primitives[0].objectFromPrimitive[0].w = 1; }),
              IsErrorAt(at + "[0].primitives[0].objectFromPrimitive", "not affine"));
  EXPECT_THAT(faultOf([](auto& s) { s[0].primitives[0].objectFromPrimitive[3].x = NAN; }),
              IsErrorAt(at + "[0].primitives[0].objectFromPrimitive", "not finite"));
  EXPECT_THAT(faultOf([](auto& s) { s[0].primitives[0].material = 0; }),
              IsErrorAt(at + "[0].primitives[0].material", "0 of 0"));
  EXPECT_THAT(faultOf([](auto& s) { s[1].nodes.pop_back(); }), IsErrorAt(at + "[1].trees[0]", "nodes 0 to 5"));
  EXPECT_THAT(faultOf([](auto& s) {
                s[1].trees[0].nodeCount = 0xFFFFFFFF;
                s[1].trees[0].firstNode = 1;
              }),
              IsErrorAt(at + "[1].trees[0]", "nodes 1 to 4294967296"));
  EXPECT_THAT(faultOf([](auto& s) { s[1].trees[0].nodeCount = 4; }), IsErrorAt(at + "[1].trees[0]", "2 results"));
  EXPECT_THAT(faultOf([](auto& s) { s[2].boxes[0].max.y = -1; }), IsErrorAt(at + "[2].boxes[0]", "minimum"));
  EXPECT_THAT(faultOf([](auto& s) { s[2].boxes[0].max.y = INFINITY; }), IsErrorAt(at + "[2].boxes[0]", "not finite"));
  EXPECT_THAT(faultOf([](auto& s) { s[2].material = 3; }), IsErrorAt(at + "[2].material", "3 of 0"));
  EXPECT_THAT(faultOf([](auto& s) { s[2].primitives.resize(1); }), IsErrorAt(at + "[2]", "boxes"));
  EXPECT_THAT(faultOf([](auto& s) { s[0].nodes.resize(1); }), IsErrorAt(at + "[0]", "trees"));
}

TEST(Procedural, AffectsHashAndCounts) {
  const Hash hash = scene::contentHash(proceduralScene());
  const auto differs = [&](const std::function<void(std::vector<PrimitiveSet>&)>& change) {
    scene::Scene s = proceduralScene();
    change(s.meshes[0].primitiveSets);
    return scene::contentHash(s) != hash;
  };
  EXPECT_FALSE(differs([](auto&) {}));
  EXPECT_TRUE(differs([](auto& s) { s[0].name = "other"; }));
  EXPECT_TRUE(differs([](auto& s) { s[0].primitives[1].parameter += 1e-6f; }));
  EXPECT_TRUE(differs([](auto& s) { s[0].primitives[0].objectFromPrimitive[3].x += 1; }));
  EXPECT_TRUE(differs([](auto& s) { s[1].nodes.back().operation = CsgOperation::leaf; }));
  EXPECT_TRUE(differs([](auto& s) { s[1].trees[0].nodeCount = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s[2].boxes[0].max.x = 2; }));
  EXPECT_TRUE(differs([](auto& s) { s[2].material = 7; }));
  EXPECT_TRUE(differs([](auto& s) { s[2].kind = PrimitiveSetKind::solids; }));
  const scene::ProceduralCount count = scene::countProcedural(proceduralScene());
  EXPECT_EQ(count.sets, 3u);
  EXPECT_EQ(count.solids, 2u);
  EXPECT_EQ(count.csgTrees, 1u);
  EXPECT_EQ(count.csgLeaves, 3u);
  EXPECT_EQ(count.customBoxes, 1u);
}

TEST(Procedural, WorldBoundsAreTight) {
  scene::Scene s;
  PrimitiveSet set;
  set.primitives.resize(1);
  s.meshes.emplace_back().primitiveSets = {set};
  s.instances.emplace_back().mesh = 0;
  s.instances[0].worldFromObject = glm::rotate(glm::translate(mat4(1), vec3(3, 0, 0)), 0.7f, vec3(0, 0, 1));
  const Bounds3 bounds = scene::worldBounds(s);  // tighter than the rotated box of the sphere
  EXPECT_NEAR(bounds.min.x, 2, 1e-6f);
  EXPECT_NEAR(bounds.max.y, 1, 1e-6f);
}

}  // namespace
}  // namespace quintet::test

// SPDX-License-Identifier: Apache-2.0
// Tests of the oracle: points between crossings agree with a point test, crossings of simple rays agree with closed
// forms, normals point out of the solid.
#include "scene/csg_oracle.h"

#include <gtest/gtest.h>

#include <random>

#include "scene/random_solids.h"

namespace quintet::test {
namespace {

using oracle::Crossing;
using oracle::Crossings;
using oracle::dvec3;
using oracle::Ray;
using scene::CsgOperation;
using scene::Primitive;
using scene::PrimitiveType;

Ray randomRay(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto vector = [&] {
    const double x = unit(random), y = unit(random), z = unit(random);
    return dvec3(x, y, z);
  };
  const dvec3 target = 1.5 * vector(), origin = 6.0 * vector();
  return {origin, (target - origin) * (0.5 + std::abs(unit(random)))};
}

// Checks the alternation and order of crossings, the points between them, and the direction of the normals.
template <class Inside>
void expectConsistent(const Crossings& list, const Ray& ray, const Inside& inside) {
  ASSERT_EQ(list.size() % 2, 0u);
  double last = -1e3;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Crossing& c = list[i];
    EXPECT_EQ(c.entering, i % 2 == 0);
    EXPECT_NEAR(glm::length(c.normal), 1.0, 1e-9);
    EXPECT_EQ(glm::dot(c.normal, ray.direction) < 0.0, c.entering);
    ASSERT_GE(c.t, last);
    if (c.t - last > 1e-6) {
      EXPECT_EQ(inside(ray.at(std::max(last, c.t - 10.0) * 0.5 + c.t * 0.5)), !c.entering);
    }
    const dvec3 p = ray.at(c.t);
    if (i + 1 == list.size() || list[i + 1].t - c.t > 1e-3) {
      if (c.t - last > 1e-3) {
        EXPECT_TRUE(inside(p - 1e-7 * c.normal)) << i;
        EXPECT_FALSE(inside(p + 1e-7 * c.normal)) << i;
      }
    }
    last = c.t;
  }
  if (!list.empty()) {
    EXPECT_FALSE(inside(ray.at(list.back().t + 1e-6)));
  }
  // Intervals without crossings.
  for (int k = 0; k < 50; ++k) {
    const double t = -1.0 + 0.1 * k;
    bool expected = false;
    double nearest = 1.0;
    for (const Crossing& c : list) {
      nearest = std::min(nearest, std::abs(c.t - t));
      if (c.t < t) expected = c.entering;
    }
    if (nearest > 1e-9) {
      EXPECT_EQ(inside(ray.at(t)), expected) << t;
    }
  }
}

TEST(CsgOracle, SolidsMatchPointTests) {
  std::mt19937 random(7);
  std::size_t hits = 0;
  for (int i = 0; i < 4000; ++i) {
    const Primitive primitive = randomPrimitive(random, static_cast<PrimitiveType>(i % 5));
    const Ray ray = randomRay(random);
    const Crossings list = oracle::crossings(primitive, ray, 3);
    for (const Crossing& c : list) EXPECT_EQ(c.primitive, 3u);
    SCOPED_TRACE(i);
    expectConsistent(list, ray, [&](const dvec3& p) { return oracle::inside(primitive, p); });
    hits += !list.empty();
    if (HasFailure()) return;
  }
  EXPECT_GT(hits, 1000u);
}

TEST(CsgOracle, TreesMatchPointTests) {
  std::mt19937 random(8);
  std::size_t crossings = 0;
  for (int i = 0; i < 6000; ++i) {
    const scene::PrimitiveSet set = randomTree(random, 2 + i % 8);
    const Ray ray = randomRay(random);
    const Crossings list = oracle::crossings(set, set.trees[0], ray);
    SCOPED_TRACE(i);
    expectConsistent(list, ray, [&](const dvec3& p) { return oracle::inside(set, set.trees[0], p); });
    crossings += list.size();
    if (HasFailure()) return;
  }
  EXPECT_GT(crossings, 2500u);
}

std::vector<double> ts(const Crossings& list) {
  std::vector<double> result;
  for (const Crossing& c : list) result.push_back(c.t);
  return result;
}

void expectNear(const std::vector<double>& actual, const std::vector<double>& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i) EXPECT_NEAR(actual[i], expected[i], 1e-12);
}

TEST(CsgOracle, MatchesClosedForms) {
  const Ray along{{-5, 0, 0}, {2, 0, 0}};  // t = (x + 5) / 2
  const auto of = [&](PrimitiveType type, const Ray& ray) {
    Primitive p;
    p.type = type;
    return ts(oracle::crossings(p, ray));
  };
  expectNear(of(PrimitiveType::sphere, along), {2, 3});
  expectNear(of(PrimitiveType::box, along), {2, 3});
  expectNear(of(PrimitiveType::cylinder, along), {2, 3});
  expectNear(of(PrimitiveType::cone, along), {2.25, 2.75});  // radius 1/2 at y = 0
  expectNear(of(PrimitiveType::torus, along), {1.875, 2.125, 2.875, 3.125});
  const Ray down{{0.25, 7, 0}, {0, -1, 0}};
  expectNear(of(PrimitiveType::sphere, down), {7 - std::sqrt(1 - 0.0625), 7 + std::sqrt(1 - 0.0625)});
  expectNear(of(PrimitiveType::cylinder, down), {6, 8});
  expectNear(of(PrimitiveType::cone, down), {6.5, 8});  // radius 1/4 at y = 1/2
  expectNear(of(PrimitiveType::torus, down), {});
  expectNear(of(PrimitiveType::torus, {{1.15, 7, 0}, {0, -1, 0}}), {7 - 0.2, 7 + 0.2});
}

TEST(CsgOracle, DifferencesFlipTheNormalInside) {
  scene::PrimitiveSet set;
  set.kind = scene::PrimitiveSetKind::csg;
  set.primitives.resize(2);
  set.primitives[0].type = PrimitiveType::box;
  set.primitives[1].objectFromPrimitive = glm::scale(mat4(1), vec3(0.5f));
  set.nodes = {{CsgOperation::leaf, 0}, {CsgOperation::leaf, 1}, {CsgOperation::subtract, 0}};
  set.trees = {{0, 3}};
  const Crossings list = oracle::crossings(set, set.trees[0], {{-5, 0, 0}, {1, 0, 0}});
  expectNear(ts(list), {4, 4.5, 5.5, 6});
  EXPECT_EQ(list[1].primitive, 1u);
  EXPECT_TRUE(list[1].flipped);
  EXPECT_FALSE(list[1].entering);
  EXPECT_NEAR(list[1].normal.x, 1.0, 1e-12);
  EXPECT_NEAR(list[2].normal.x, -1.0, 1e-12);
  EXPECT_NEAR(list[0].normal.x, -1.0, 1e-12);
  EXPECT_NEAR(oracle::firstHit(list, 4.1, 100)->t, 4.5, 1e-12);
  EXPECT_FALSE(oracle::firstHit(list, 4.1, 4.4));
}

}  // namespace
}  // namespace quintet::test

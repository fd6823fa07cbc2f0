// SPDX-License-Identifier: Apache-2.0
// CSG trees, compared with the oracle on the host, and with explicit expected values where surfaces coincide.
#include <algorithm>
#include <cstdio>
#include <functional>

#include "expectation.h"

namespace quintet::test {
namespace {

using scene::CsgNode;
using scene::CsgOperation;
using scene::Primitive;
using scene::PrimitiveSet;
using scene::PrimitiveSetKind;
using scene::PrimitiveType;

// Appends a random tree in postfix order; a leaf if `depth` is 0.
void addRandomTree(PrimitiveSet& set, Random& random, int depth, bool full) {
  if (depth == 0 || (!full && random.below(4) == 0)) {
    Primitive primitive;
    primitive.type = static_cast<PrimitiveType>(random.below(5));
    primitive.objectFromPrimitive = random.affine(2.0f, 0.8f) * glm::scale(mat4(1.0f), vec3(0.8f));
    primitive.parameter = random.uniform(0.1f, 0.8f);
    set.nodes.push_back({CsgOperation::leaf, static_cast<std::uint32_t>(set.primitives.size())});
    set.primitives.push_back(primitive);
    return;
  }
  addRandomTree(set, random, depth - 1, full);
  addRandomTree(set, random, depth - 1, full);
  set.nodes.push_back({static_cast<CsgOperation>(1 + random.below(3)), 0});
}

PrimitiveSet randomTrees(Random& random, int depth, int count, bool full) {
  PrimitiveSet set;
  set.kind = PrimitiveSetKind::csg;
  for (int i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(set.nodes.size());
    addRandomTree(set, random, depth, full);
    set.trees.push_back({first, static_cast<std::uint32_t>(set.nodes.size()) - first});
  }
  return set;
}

std::vector<ProbeRay> raysAroundTree(Random& random, std::size_t count, const mat4& worldFromObject) {
  std::vector<ProbeRay> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const vec3 from =
        i % 3 == 0 ? random.inBox(1.0f) : random.onSphere() * random.uniform(2.0f, i % 3 == 1 ? 20.0f : 5.0f);
    const vec3 along = (random.inBox(1.0f) - from) * std::exp(random.uniform(-3.0f, 3.0f));
    ProbeRay ray;
    ray.origin = worldFromObject * vec4(from, 1.0f);
    ray.direction = worldFromObject * vec4(along, 0.0f);
    const float unit = 1.0f / glm::length(along);
    if (i % 4 == 0) ray.tmin = random.uniform(0.0f, 1.2f) * glm::length(from) * unit;
    if (i % 7 == 0) ray.tmax = ray.tmin + random.uniform(0.0f, 2.0f) * unit;
    rays.push_back(ray);
  }
  return rays;
}

// The nearest hit with any of the trees of a set.
oracle::Crossings crossingsOfAll(const PrimitiveSet& set, const oracle::Ray& ray) {
  oracle::Crossings all;
  for (const scene::CsgTree& tree : set.trees) {
    const oracle::Crossings one = oracle::crossings(set, tree, ray);
    all.insert(all.end(), one.begin(), one.end());
  }
  std::ranges::stable_sort(all, {}, &oracle::Crossing::t);
  return all;
}

struct Round {
  int depth;
  int trees;
  bool full;  // all branches have the same depth
  std::size_t rays;
};

TEST(Csg, AgreesWithTheOracle) {
  Random random(7);
  std::size_t count = 0, hits = 0, doubtful = 0, flipped = 0;
  for (const Round& round : {Round{1, 1, true, 2000},
                             {1, 5, true, 1500},
                             {2, 1, true, 2000},
                             {2, 3, false, 2000},
                             {3, 1, true, 2000},
                             {3, 20, false, 2000},
                             {4, 1, true, 1500},
                             {5, 2, false, 1500},
                             {6, 1, false, 1000},
                             {8, 1, true, 500}}) {
    SCOPED_TRACE(testing::Message() << "depth " << round.depth << ", " << round.trees << " trees");
    const PrimitiveSet set = randomTrees(random, round.depth, round.trees, round.full);
    const mat4 worldFromObject = round.depth % 2 ? random.affine(2.5f, 4.0f) : mat4(1.0f);
    const std::vector<ProbeRay> rays = raysAroundTree(random, round.rays, worldFromObject);
    const std::vector<ProbeHit> found = probe(sceneOf(set, worldFromObject), rays);
    for (std::size_t i = 0; i < rays.size(); ++i, ++count) {
      const Expected expected = expectHit([&](const oracle::Ray& ray) { return crossingsOfAll(set, ray); }, found[i],
                                          rays[i], worldFromObject);
      doubtful += expected.doubtful;
      if (expected.doubtful) continue;
      hits += expected.hit.has_value();
      flipped += expected.hit && expected.hit->flipped;
      SCOPED_TRACE(testing::Message() << "ray " << i);
      EXPECT_EQ(expected.difference, "");
      if (HasFailure()) return;
    }
  }
  std::printf("%zu rays: %zu hits, %zu of subtrahends, %zu doubtful\n", count, hits, flipped, doubtful);
  EXPECT_GT(hits, count / 5);
  EXPECT_GT(flipped, count / 50);
  EXPECT_LT(doubtful, count / 100);
}

// ---- coincident faces ----

Primitive boxFrom(const vec3& low, const vec3& high) {
  Primitive primitive;
  primitive.type = PrimitiveType::box;
  primitive.objectFromPrimitive =
      glm::translate(mat4(1.0f), 0.5f * (low + high)) * glm::scale(mat4(1.0f), 0.5f * (high - low));
  return primitive;
}

const CsgNode kUnite{CsgOperation::unite, 0}, kIntersect{CsgOperation::intersect, 0},
    kSubtract{CsgOperation::subtract, 0};
CsgNode leaf(std::uint32_t i) { return {CsgOperation::leaf, i}; }

PrimitiveSet treeOf(const std::vector<Primitive>& primitives, const std::vector<CsgNode>& nodes) {
  PrimitiveSet set;
  set.kind = PrimitiveSetKind::csg;
  set.primitives = primitives;
  set.nodes = nodes;
  set.trees = {{0, static_cast<std::uint32_t>(nodes.size())}};
  return set;
}

// The expected hit of a ray along -z from `start`.
struct Coincidence {
  const char* name;
  PrimitiveSet set;
  float start;
  float z;  // of the hit; > 99: no hit
  std::uint32_t leaf;
  bool front;
};

std::vector<Coincidence> coincidences() {
  const Primitive whole = boxFrom(vec3(-1), vec3(1)), upper = boxFrom({-2, -2, 0}, {2, 2, 1}),
                  top = boxFrom({-1, -1, 0}, {1, 1, 1}), bottom = boxFrom(vec3(-1), {1, 1, 0}),
                  above = boxFrom({-2, -2, 1}, {2, 2, 2}), low = boxFrom(vec3(-1), {1, 1, -0.5f});
  return {
      {"a subtrahend removes a common face", treeOf({whole, upper}, {leaf(0), leaf(1), kSubtract}), 3, 0, 1, true},
      {"the same from inside", treeOf({whole, upper}, {leaf(0), leaf(1), kSubtract}), -0.5f, -1, 0, false},
      {"a union of touching solids has no inner face", treeOf({top, bottom}, {leaf(0), leaf(1), kUnite}), 0.5f, -1, 1,
       false},
      {"a common face of an intersection", treeOf({whole, upper}, {leaf(0), leaf(1), kIntersect}), 3, 1, 0, true},
      {"an intersection of touching solids is empty", treeOf({top, bottom}, {leaf(0), leaf(1), kIntersect}), 3, 100, 0,
       true},
      {"a subtrahend outside keeps the common face", treeOf({whole, above}, {leaf(0), leaf(1), kSubtract}), 0.5f, -1, 0,
       false},
      {"the same from outside", treeOf({whole, above}, {leaf(0), leaf(1), kSubtract}), 3, 1, 0, true},
      {"a solid minus itself is empty", treeOf({whole, whole}, {leaf(0), leaf(1), kSubtract}), 3, 100, 0, true},
      {"a solid united with itself is unchanged", treeOf({whole, whole}, {leaf(0), leaf(1), kUnite}), 3, 1, 0, true},
      {"the deciding operand owns the surface",
       treeOf({top, whole, bottom}, {leaf(0), leaf(1), kSubtract, leaf(2), kUnite}), 3, 0, 2, true},
      {"three coincident faces", treeOf({top, top, whole}, {leaf(0), leaf(1), kSubtract, leaf(2), kUnite}), 3, 1, 2,
       true},
      {"a part that is subtracted twice",
       treeOf({whole, upper, top}, {leaf(0), leaf(1), kSubtract, leaf(2), kSubtract}), 3, 0, 1, true},
      {"a hole down to a face",
       treeOf({whole, boxFrom({-0.9f, -0.9f, -2}, {0.9f, 0.9f, 2}), low},
              {leaf(0), leaf(1), kSubtract, leaf(2), kUnite}),
       3, -0.5f, 2, true}};
}

// Appends a tree, transformed by m. A box rotated by a quarter turn about z is the same solid with different numbers.
void append(PrimitiveSet& to, const PrimitiveSet& set, const mat4& m, Random& random) {
  const auto firstPrimitive = static_cast<std::uint32_t>(to.primitives.size()),
             firstNode = static_cast<std::uint32_t>(to.nodes.size());
  for (Primitive primitive : set.primitives) {
    const mat4 turn =
        glm::rotate(mat4(1.0f), static_cast<float>(random.below(4)) * glm::half_pi<float>(), vec3(0, 0, 1));
    primitive.objectFromPrimitive = m * primitive.objectFromPrimitive * turn;
    to.primitives.push_back(primitive);
  }
  for (const CsgNode& node : set.nodes)
    to.nodes.push_back({node.operation, node.operation == CsgOperation::leaf ? node.primitive + firstPrimitive : 0});
  to.trees.push_back({firstNode, static_cast<std::uint32_t>(set.nodes.size())});
}

// Tests the same arrangements under many transforms, so that the crossings have different rounding errors.
TEST(Csg, HandlesCoincidentFaces) {
  constexpr int kRays = 192;
  Random random(11);
  const std::vector<Coincidence> cases = coincidences();
  for (int k = 0; k < 8; ++k) {
    const mat4 m = k == 0 ? mat4(1.0f) : random.affine(1.5f, k < 6 ? 3.0f : 300.0f);
    PrimitiveSet all;
    all.kind = PrimitiveSetKind::csg;
    std::vector<ProbeRay> rays;
    for (std::size_t c = 0; c < cases.size(); ++c) {
      const mat4 place = m * glm::translate(mat4(1.0f), vec3(6 * c, 0, 0));
      append(all, cases[c].set, place, random);
      for (int i = 0; i < kRays; ++i) {
        const vec3 from(0.8f * random.inBox(1.0f) * vec3(1, 1, 0) + vec3(0, 0, cases[c].start));
        const vec3 along(random.uniform(-0.02f, 0.02f), random.uniform(-0.02f, 0.02f), -1.0f);
        rays.push_back({.origin = place * vec4(from, 1.0f), .direction = place * vec4(along, 0.0f)});
      }
    }
    const std::vector<ProbeHit> hits = probe(sceneOf(all), rays);
    std::uint32_t firstLeaf = 0;
    for (std::size_t c = 0; c < cases.size(); ++c) {
      int wrong = 0;
      const ProbeHit* const found = &hits[c * kRays];
      for (int i = 0; i < kRays; ++i) {
        const bool right = std::abs(found[i].t - (cases[c].start - cases[c].z)) < 1e-3f &&
                           found[i].leaf == firstLeaf + cases[c].leaf && found[i].front == cases[c].front;
        wrong += cases[c].z > 99.0f ? found[i].t >= 0.0f : !right;
      }
      EXPECT_EQ(wrong, 0) << cases[c].name << ", transform " << k << ": t " << found->t << " leaf "
                          << found->leaf - firstLeaf << " front " << found->front;
      firstLeaf += static_cast<std::uint32_t>(cases[c].set.primitives.size());
    }
  }
}

// A ray that starts on the surface of a tree, on either side and at any angle, has the hit that the oracle computes for
// exactly this origin. In particular, it does not hit the surface it starts from.
TEST(Csg, IsNotHitByRaysLeavingIt) {
  Random random(17);
  std::size_t count = 0;
  for (int k = 0; k < 4; ++k) {
    const PrimitiveSet set = randomTrees(random, 3, 3, true);
    const mat4 worldFromObject = k == 0 ? mat4(1.0f) : random.affine(2.5f, k == 3 ? 1000.0f : 4.0f);
    const scene::Scene scene = sceneOf(set, worldFromObject);
    const std::vector<ProbeHit> first = probe(scene, raysAroundTree(random, 2000, worldFromObject));
    std::vector<ProbeRay> rays;
    std::vector<const ProbeHit*> from;
    for (std::size_t i = 0; i < first.size(); ++i) {
      if (first[i].t < 0.0f) continue;
      constexpr std::array kCosines{1.0f, 0.3f, 1e-2f, 1e-4f, 1e-6f};
      const float cosine = kCosines[i % 5];
      for (const float sign : {1.0f, -1.0f}) {
        const vec3 normal = sign * first[i].normal, along = glm::normalize(glm::cross(normal, random.onSphere()));
        const vec3 direction = cosine * normal + std::sqrt(1.0f - cosine * cosine) * along;
        rays.push_back({.origin = leave(first[i], direction), .direction = direction});
        from.push_back(&first[i]);
      }
    }
    const std::vector<ProbeHit> hits = probe(scene, rays);
    std::size_t itself = 0, different = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const auto expected = oracle::firstHit(crossingsOfAll(set, toObject(rays[i], worldFromObject)), 0.0, 1e30);
      const double place = expected ? expected->t : -1.0;
      const bool same =
          hits[i].t >= 0.0f && expected && std::abs(hits[i].t - place) < 1e-3 * place + 30.0 * from[i]->error;
      if (same || (hits[i].t < 0.0f && !expected)) continue;
      ++different;  // near an edge
      itself += hits[i].t >= 0.0f && hits[i].leaf == from[i]->leaf && hits[i].face == from[i]->face &&
                hits[i].t < 100.0f * from[i]->error;
    }
    EXPECT_EQ(itself, 0u) << "of " << hits.size();
    EXPECT_LE(different, hits.size() / 200) << "of " << hits.size();
    count += hits.size();
  }
  EXPECT_GT(count, 3000u);
}

// ---- large trees ----

// A plate with many holes, as a chain with one difference per hole and as a balanced tree.
PrimitiveSet plate(int holesAcross, bool balanced) {
  PrimitiveSet set;
  set.kind = PrimitiveSetKind::csg;
  set.primitives.push_back(boxFrom({-1, -0.1f, -1}, {1, 0.1f, 1}));
  set.nodes.push_back(leaf(0));
  std::vector<std::uint32_t> holes;
  const float pitch = 2.0f / static_cast<float>(holesAcross);
  const auto at = [&](int k) { return (static_cast<float>(k) + 0.5f) * pitch - 1.0f; };
  for (int x = 0; x < holesAcross; ++x) {
    for (int z = 0; z < holesAcross; ++z) {
      Primitive hole;
      hole.type = PrimitiveType::cylinder;
      hole.objectFromPrimitive = glm::translate(mat4(1.0f), vec3(at(x), 0, at(z))) *
                                 glm::scale(mat4(1.0f), vec3(0.3f * pitch, 1, 0.3f * pitch));
      holes.push_back(static_cast<std::uint32_t>(set.primitives.size()));
      set.primitives.push_back(hole);
      if (balanced) continue;
      set.nodes.push_back(leaf(holes.back()));
      set.nodes.push_back(kSubtract);
    }
  }
  const std::function<void(std::size_t, std::size_t)> unite = [&](std::size_t first, std::size_t last) {
    if (first == last) return set.nodes.push_back(leaf(holes[first]));
    const std::size_t middle = (first + last) / 2;
    unite(first, middle);
    unite(middle + 1, last);
    set.nodes.push_back(kUnite);
  };
  if (balanced) unite(0, holes.size() - 1), set.nodes.push_back(kSubtract);
  set.trees = {{0, static_cast<std::uint32_t>(set.nodes.size())}};
  return set;
}

// A right-leaning chain, which fills the stack to its limit.
PrimitiveSet fullStack() {
  PrimitiveSet set;
  set.kind = PrimitiveSetKind::csg;
  for (std::uint32_t i = 0; i < scene::kMaxCsgStack; ++i) {
    Primitive ball;
    ball.objectFromPrimitive = glm::scale(mat4(1.0f), vec3(1.0f - static_cast<float>(i) / 40.0f));
    set.primitives.push_back(ball);
    set.nodes.push_back(leaf(i));
  }
  // 1 minus (2 minus (3 minus …)): shells.
  for (std::uint32_t i = 1; i < scene::kMaxCsgStack; ++i) set.nodes.push_back(kSubtract);
  set.trees = {{0, static_cast<std::uint32_t>(set.nodes.size())}};
  return set;
}

TEST(Csg, LargeTreesAgreeWithTheOracle) {
  Random random(13);
  for (const PrimitiveSet& set : {plate(12, false), plate(12, true), fullStack()}) {
    SCOPED_TRACE(set.nodes.size());
    const std::vector<ProbeRay> rays = raysAroundTree(random, 600, mat4(1.0f));
    const std::vector<ProbeHit> hits = probe(sceneOf(set), rays);
    std::size_t doubtful = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Expected expected =
          expectHit([&](const oracle::Ray& ray) { return crossingsOfAll(set, ray); }, hits[i], rays[i], mat4(1.0f));
      doubtful += expected.doubtful;
      SCOPED_TRACE(testing::Message() << "ray " << i);
      if (!expected.doubtful) {
        EXPECT_EQ(expected.difference, "");
      }
      if (HasFailure()) return;
    }
    EXPECT_LT(doubtful, rays.size() / 50);
  }
}

}  // namespace
}  // namespace quintet::test

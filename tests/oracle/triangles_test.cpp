// SPDX-License-Identifier: Apache-2.0
// Triangles: barycentrics, watertight fans, shared edges, triangles without area.
#include <random>

#include "checks.h"
#include "probe.h"

namespace quintet::oracle::triangles_test {
namespace {

// p = (1 - u - v) v0 + u v1 + v v2, in rotated, sheared and mirrored instances.
TEST(TriangleHits, ReturnsBarycentricsOfTheSecondAndThirdVertex) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0, 1);
  const auto point = [&] { return vec3(unit(random), unit(random), unit(random)) * 2.0f - 1.0f; };
  Scene scene;
  constexpr std::size_t kInstances = 40, kRays = 25;
  std::vector<ProbeRay> rays;
  std::vector<vec2> expected;
  for (std::size_t k = 0; k < kInstances; ++k) {
    vec3 v[3], normal(0);
    while (glm::length(normal) < 0.5f) {  // no slivers, whose barycentrics amplify rounding errors
      for (vec3& corner : v) corner = point();
      normal = glm::cross(v[1] - v[0], v[2] - v[0]);
    }
    scene.addBlas({Triangles{{v[0], v[1], v[2]}, {{0, 1, 2}}}});
    mat4 world(vec4(point() + vec3(2, 0, 0), 0), vec4(point() + vec3(0, k % 2 ? 2 : -2, 0), 0),
               vec4(point() + vec3(0, 0, 2), 0), vec4(0, 0, 0, 1));
    world[3] = vec4(20.0f * static_cast<float>(k % 7), 20.0f * static_cast<float>(k / 7), 0, 1);
    scene.add(k, {.worldFromObject = world});
    for (std::size_t r = 0; r < kRays; ++r) {
      float u = unit(random), w = unit(random);
      if (u + w > 1) u = 1 - u, w = 1 - w;
      u = 0.01f + 0.97f * u, w = 0.01f + 0.97f * w;
      if (u + w > 0.99f) continue;
      const vec3 p = (1 - u - w) * v[0] + u * v[1] + w * v[2];
      const vec3 away = glm::normalize(normal) * (r % 2 ? 1.0f : -1.0f) + 0.3f * point();
      rays.push_back({.origin = vec3(world * vec4(p + away, 1)), .direction = vec3(world * vec4(-away, 0))});
      expected.push_back({u, w});
    }
  }
  const auto hits = traceProbe(scene, rays);
  Checks checks;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    checks.equal(hits[k].end, kHit, "ray {}", k);
    checks.near(vec3(hits[k].attributes, hits[k].t), vec3(expected[k], 1), 2e-3f, "ray {}: u, v, t", k);
  }
  checks.done();
}

// Returns `count` triangles around the origin with radius 1 and a wavy rim.
Triangles fan(std::uint32_t count, bool opaque) {
  Triangles triangles{.positions = {vec3(0, 0, 0.25f)}, .indices = {}, .opaque = opaque};
  for (std::uint32_t k = 0; k < count; ++k) {
    const double angle = 2.0 * glm::pi<double>() * k / count;
    triangles.positions.push_back({std::cos(angle), std::sin(angle), 0.1 * std::sin(3.0 * angle)});
    triangles.indices.push_back(uvec3(0, k + 1, (k + 1) % count + 1));
  }
  return triangles;
}

enum class Aim { inside, edges };

// Returns straight and oblique rays from above at points that every triangulation of the vertices covers.
std::vector<ProbeRay> raysAt(const Triangles& fan, Aim aim, std::size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0, 1);
  const auto rim = static_cast<std::uint32_t>(fan.indices.size());
  std::vector<ProbeRay> rays;
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t triangle = static_cast<std::uint32_t>(random()) % rim;
    const uvec3 corners = fan.indices[triangle];
    const vec3 middle = fan.positions[0], a = fan.positions[corners.y], b = fan.positions[corners.z];
    const float along = 0.02f + 0.95f * unit(random);
    vec3 target = glm::mix(middle, a, along);
    if (aim == Aim::inside) target = glm::mix(target, glm::mix(middle, b, along), unit(random));
    const vec3 from = target + vec3(k % 2 ? vec2(0) : vec2(unit(random), unit(random)) - 0.5f, 2.0f);
    rays.push_back({.origin = from, .direction = target - from});
  }
  return rays;
}

constexpr std::uint32_t kFanSizes[] = {4, 5, 16, 64, 100, 256, 1024, 4096, 16384, 65536};

void checkFans(Aim aim) {
  Checks checks;
  for (const std::uint32_t count : kFanSizes) {
    Scene scene;
    const Triangles triangles = fan(count, true);
    scene.add(scene.addBlas({triangles}));
    const std::vector<ProbeRay> rays = raysAt(triangles, aim, 2048);
    const auto hits = traceProbe(scene, rays);
    for (std::size_t k = 0; k < rays.size(); ++k) {
      checks.equal(hits[k].end, kHit, "{} triangles, ray {}", count, k);
      checks.near(hits[k].t, 1, 0.01f, "{} triangles, ray {}: t", count, k);
    }
  }
  checks.done();
}

TEST(TriangleHits, FindsNoHolesInFans) { checkFans(Aim::inside); }
TEST(TriangleHits, FindsNoHolesOnEdgesOfFans) { checkFans(Aim::edges); }

// Rays from outside at the vertices of a closed sphere of 40 × 20 cells.
TEST(TriangleHits, FindsNoHolesAtVertices) {
  Triangles ball;
  constexpr std::uint32_t kAround = 40, kDown = 20;
  for (std::uint32_t y = 0; y <= kDown; ++y)
    for (std::uint32_t x = 0; x < kAround; ++x) {
      const double theta = glm::pi<double>() * y / kDown, phi = 2 * glm::pi<double>() * x / kAround;
      ball.positions.push_back(
          vec3(0.3 + std::sin(theta) * std::cos(phi), std::cos(theta) - 0.7, std::sin(theta) * std::sin(phi)));
    }
  for (std::uint32_t y = 0; y < kDown; ++y)
    for (std::uint32_t x = 0; x < kAround; ++x) {
      const std::uint32_t a = y * kAround + x, b = y * kAround + (x + 1) % kAround;
      ball.indices.push_back(uvec3(a, b, a + kAround));
      ball.indices.push_back(uvec3(b, b + kAround, a + kAround));
    }
  Scene scene;
  scene.add(scene.addBlas({ball}));
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<ProbeRay> rays;
  while (rays.size() < 65536) {
    const vec3 from(3 * unit(random), 3 * unit(random), 3 * unit(random)), middle(0.3f, -0.7f, 0);
    if (glm::distance(from, middle) < 1.1f) continue;
    // No poles, where many triangles share a vertex.
    const vec3 target = ball.positions[kAround + static_cast<std::uint32_t>(random()) % (kAround * (kDown - 1))];
    // Not at the silhouette, where a miss is correct.
    if (glm::dot(glm::normalize(from - target), target - middle) < 0.2f) continue;
    rays.push_back({.origin = from, .direction = target - from});
  }
  const auto hits = traceProbe(scene, rays);
  Checks checks;
  for (std::size_t k = 0; k < rays.size(); ++k)
    checks.quirkThat(hits[k].end == kHit && hits[k].t < 1.001f, "ray {}: end {}, t {}", k, hits[k].end, hits[k].t);
  checks.done(kVertexLeaks);
}

// Counts all candidates of a ray: the any-hit shader ignores them.
constexpr char kCountCommon[] = R"(
struct Input { vec3 origin; float tMin; vec3 direction; float tMax; uint flags; uint mask; uint offset; uint stride; uint miss; };
struct Output { uint calls; uint first; uint others; };
)";
constexpr char kCountRayGeneration[] = R"(
layout(location = 0) rayPayloadEXT Output result;
void main() {
  Input ray = launch.inputs.at[launchIndex()];
  result = Output(0u, 0u, 0u);
  traceRayEXT(tlas, 0u, 0xFFu, 0u, 0u, 0u, ray.origin, ray.tMin, ray.direction, ray.tMax, 0);
  launch.outputs.at[launchIndex()] = result;
}
)";
constexpr char kCountAnyHit[] = R"(
layout(location = 0) rayPayloadInEXT Output result;
void main() {
  if (result.calls == 0u) result.first = gl_PrimitiveID;
  else if (result.first != gl_PrimitiveID) result.others++;
  result.calls++;
  ignoreIntersectionEXT;
}
)";
struct Counts {
  std::uint32_t calls, first, others;
};

std::vector<Counts> countCandidates(const Triangles& triangles, const std::vector<ProbeRay>& rays) {
  const Program program({.common = kCountCommon,
                         .rayGeneration = kCountRayGeneration,
                         .miss = {"void main() {}"},
                         .hit = {{.anyHit = kCountAnyHit}}});
  Scene scene;
  scene.add(scene.addBlas({triangles}));
  return run<Counts>(program, scene, rays);
}

// With NO_DUPLICATE_ANY_HIT_INVOCATION the any-hit shader runs exactly once per layer.
TEST(TriangleHits, ReportsEveryLayerAsACandidate) {
  Triangles layers{.opaque = false, .singleAnyHit = true};
  for (std::uint32_t k = 0; k < 20; ++k) {
    const Triangles layer = triangleAt(0, 0, -static_cast<float>(k));
    layers.positions.insert(layers.positions.end(), layer.positions.begin(), layer.positions.end());
    layers.indices.push_back(uvec3(3 * k, 3 * k + 1, 3 * k + 2));
  }
  std::vector<ProbeRay> rays;
  for (int k = 0; k < 20; ++k)
    rays.push_back({.origin = {0.01f * static_cast<float>(k), 0, 0.5f}, .tMax = 0.75f + static_cast<float>(k)});
  const auto counts = countCandidates(layers, rays);
  Checks checks;
  for (std::uint32_t k = 0; k < 20; ++k) checks.equal(counts[k].calls, k + 1, "any-hit calls up to layer {}", k);
  checks.done();
}

TEST(TriangleHits, HitsASharedEdgeOnce) {
  Checks checks;
  for (const std::uint32_t count : {4u, 16u, 100u}) {
    Triangles triangles = fan(count, false);
    triangles.singleAnyHit = true;
    for (const Counts& c : countCandidates(triangles, raysAt(triangles, Aim::edges, 512))) {
      checks.that(c.calls >= 1 && c.calls <= 2, "{} triangles: {} candidates", count, c.calls);
      checks.quirkThat(c.calls == 1, "{} triangles: {} candidates", count, c.calls);
    }
  }
  checks.done(kEdgesHitTwice);
}

// Points and lines between valid triangles are never hit and do not affect the valid ones.
TEST(TriangleHits, MissesTrianglesWithoutArea) {
  Triangles mixed;
  constexpr std::uint32_t kCount = 48;
  std::vector<ProbeRay> rays;
  for (std::uint32_t k = 0; k < kCount; ++k) {
    const float x = 3.0f * static_cast<float>(k);
    Triangles one = triangleAt(x, 0, 0);
    if (k % 4 == 1) one.positions = {{x, 0, 0}, {x, 0, 0}, {x, 0, 0}};
    if (k % 4 == 2) one.positions = {{x - 1, 0, 0}, {x, 0, 0}, {x + 1, 0, 0}};
    if (k % 4 == 3) one.positions = {{x, -1, 0}, {x, 1, 0}, {x, -1, 0}};
    mixed.positions.insert(mixed.positions.end(), one.positions.begin(), one.positions.end());
    mixed.indices.push_back(uvec3(3 * k, 3 * k + 1, 3 * k + 2));
    rays.push_back({.origin = {x, 0, 2}});
    rays.push_back({.origin = {x + 0.1f, 0.1f, 2}});
  }
  Scene scene;
  scene.add(scene.addBlas({mixed}));
  const auto hits = traceProbe(scene, rays);
  Checks checks;
  for (std::uint32_t k = 0; k < hits.size(); ++k) {
    checks.equal(hits[k].end, k / 2 % 4 == 0 ? kHit : kMissed, "triangle {}", k / 2);
    if (k / 2 % 4 == 0) checks.equal(hits[k].primitive, k / 2, "triangle {}", k / 2);
  }
  checks.done();
}

}  // namespace
}  // namespace quintet::oracle::triangles_test

// SPDX-License-Identifier: Apache-2.0
// Arguments of traceRayEXT: origin, direction and its length, tmin, tmax and cull mask; and empty scenes.
#include <algorithm>

#include "checks.h"
#include "probe.h"

namespace quintet::oracle::rays_test {
namespace {

mat4 scaled(float s) { return glm::scale(mat4(1.0f), vec3(s)); }

// A triangle in the plane z = 0 (instance 0) and a cube at x = 10 (instance 1), both scaled by s.
Scene makeScene(float s) {
  Scene scene;
  scene.add(scene.addBlas({triangleAt(0, 0, 0)}), {.worldFromObject = scaled(s)});
  scene.add(scene.addBlas({Boxes{{boxAt({0, 0, 0})}}}),
            {.worldFromObject = glm::translate(mat4(1.0f), vec3(10, 0, 0)) * scaled(s), .recordOffset = 1});
  return scene;
}

TEST(Rays, ScalesTWithTheDirection) {
  Checks checks;
  for (const float size : {1.0f, 0.25f, 4.0f}) {
    std::vector<ProbeRay> rays;
    const float scales[] = {1e-3f, 0.01f, 0.1f, 0.5f, 1, 2, 3, 4, 10, 100, 1000, 1e6f};
    for (const float s : scales)
      for (const float x : {0.0f, 10.0f}) rays.push_back({.origin = {x, 0, 4}, .direction = {0, 0, -s}});
    const auto hits = traceProbe(makeScene(size), rays);
    for (std::size_t k = 0; k < rays.size(); ++k) {
      const float distance = k % 2 == 0 ? 4.0f : 4.0f - 0.5f * size, t = distance / scales[k / 2];
      checks.equal(hits[k].end, kHit, "direction of length {}, size {}", scales[k / 2], size);
      checks.near(hits[k].t, t, std::max(1e-6f * t, std::min(1e-3f, 1e-3f * t)), "direction of length {}, size {}: t",
                  scales[k / 2], size);
    }
  }
  checks.done();
}

TEST(Rays, StartsInsideBoxesAtTmin) {
  std::vector<ProbeRay> rays;
  for (const float tMin : {0.0f, 0.125f})
    for (const vec3 origin : {vec3(10, 0, 0), vec3(10.4f, 0.3f, -0.4f), vec3(9.6f, -0.25f, 0.45f), vec3(10, 0.49f, 0)})
      for (const vec3 direction : {vec3(0, 0, 1), vec3(0, 0, -0.5f), vec3(0.3f, -0.2f, 0.1f), vec3(-1, 1, 0.1f)})
        if (std::abs(origin.x - 10 + tMin * direction.x) < 0.5f && std::abs(origin.y + tMin * direction.y) < 0.5f &&
            std::abs(origin.z + tMin * direction.z) < 0.5f)
          rays.push_back({.origin = origin, .tMin = tMin, .direction = direction});
  const auto hits = traceProbe(makeScene(1), rays);
  Checks checks;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    checks.equal(hits[k].end, kHit, "ray {}", k);
    checks.equal(hits[k].t, rays[k].tMin, "ray {}: t", k);
    checks.equal(hits[k].kind, 7u, "ray {}: hit kind", k);
    checks.equal(hits[k].attributes, vec2(0.25f, 0.75f), "ray {}: attributes", k);
  }
  checks.done();
}

// Rays intersect the triangle at t = 4 and the box from 3.5 to 4.5. Triangles exactly at a limit are not tested.
TEST(Rays, LimitsHitsToTminAndTmax) {
  struct Case {
    float tMin, tMax;
    bool triangle, box;
  };
  const Case cases[] = {{0, 1e30f, true, true},   {0, 3.4f, false, false}, {0, 3.6f, false, true},
                        {0, 3.99f, false, true},  {0, 4.01f, true, true},  {3.99f, 10, true, true},
                        {4.01f, 10, false, true}, {4.4f, 10, false, true}, {4.6f, 10, false, false},
                        {4, 4.001f, true, true},  {2, 2, false, false},    {4.2f, 4.2f, false, true},
                        {3.9f, 4.1f, true, true}, {0, 0, false, false},    {10, 1e30f, false, false}};
  std::vector<ProbeRay> rays;
  for (const Case& c : cases)
    for (const float x : {0.0f, 10.0f})
      rays.push_back({.origin = {x, 0, 4}, .tMin = c.tMin, .direction = {0, 0, -1}, .tMax = c.tMax});
  const auto hits = traceProbe(makeScene(1), rays);
  Checks checks;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const Case& c = cases[k / 2];
    if (k % 2 == 0 && c.tMin == 4) continue;
    const bool hit = k % 2 == 0 ? c.triangle : c.box;
    checks.equal(hits[k].end, hit ? kHit : kMissed, "{} with t from {} to {}", k % 2 ? "box" : "triangle", c.tMin,
                 c.tMax);
    if (hit) checks.near(hits[k].t, k % 2 ? std::max(3.5f, c.tMin) : 4.0f, 1e-5f, "t from {} to {}", c.tMin, c.tMax);
  }
  checks.done();
}

TEST(Rays, MissesGeometryBehindTheOrigin) {
  std::vector<ProbeRay> rays;
  for (const float x : {0.0f, 10.0f}) rays.push_back({.origin = {x, 0, -1}, .direction = {0, 0, -1}});
  const auto hits = traceProbe(makeScene(1), rays);
  Checks checks;
  for (const ProbeHit& hit : hits) checks.equal(hit.end, kMissed, "behind the origin");
  checks.done();
}

TEST(Rays, UsesEightBitsOfTheCullMask) {
  std::vector<std::uint32_t> masks = {0, 0xFF, 0x55, 0xAA, 0x0F, 0x81};
  for (std::uint32_t bit = 0; bit < 8; ++bit) masks.push_back(1u << bit);
  std::vector<std::uint32_t> rayMasks = masks;
  for (const std::uint32_t more : {0x100u, 0x1FFu, 0xFFFFFF00u, 0xFFFFFFFFu, 0x80000001u, 0x10080u})
    rayMasks.push_back(more);
  Scene scene;
  const std::size_t triangle = scene.addBlas({triangleAt(0, 0, 0)}), box = scene.addBlas({Boxes{{boxAt({0, 0, 0})}}});
  for (std::size_t k = 0; k < 2 * masks.size(); ++k)
    scene.add(k % 2 ? box : triangle,
              {.worldFromObject = glm::translate(mat4(1.0f), vec3(3.0f * static_cast<float>(k), 0, 0)),
               .mask = masks[k / 2],
               .recordOffset = static_cast<std::uint32_t>(k % 2)});
  std::vector<ProbeRay> rays;
  for (std::size_t k = 0; k < 2 * masks.size(); ++k)
    for (const std::uint32_t mask : rayMasks)
      rays.push_back({.origin = {3.0f * static_cast<float>(k), 0, 2}, .mask = mask});
  const auto hits = traceProbe(scene, rays);
  Checks checks;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const std::uint32_t instance = masks[k / rayMasks.size() / 2], ray = rays[k].mask;
    checks.equal(hits[k].end, (instance & ray & 0xFF) ? kHit : kMissed, "instance mask {:#x}, ray mask {:#x}", instance,
                 ray);
  }
  checks.done();
}

TEST(Rays, MissesEmptyScenes) {
  std::vector<ProbeRay> rays;
  for (int k = 0; k < 64; ++k)
    rays.push_back({.origin = {0.1f * static_cast<float>(k), 0, 0},
                    .direction = glm::normalize(vec3(k % 3 - 1, k % 5 - 2, 0.5f))});
  Scene nothing, emptyBlas, unseen;
  emptyBlas.add(emptyBlas.addBlas(std::vector<Triangles>{}));
  emptyBlas.add(emptyBlas.addBlas({Triangles{}}));
  emptyBlas.add(emptyBlas.addBlas({Boxes{}}));
  unseen.add(unseen.addBlas({Boxes{{boxAt({0, 0, 0}, 50)}}}), {.mask = 0, .recordOffset = 1});
  Checks checks;
  for (const Scene* scene : {&nothing, &emptyBlas, &unseen})
    for (const ProbeHit& hit : traceProbe(*scene, rays)) checks.equal(hit.end, kMissed, "an empty scene");
  checks.done();
}

// Boxes without volume may be hit or not, but must not affect other boxes.
TEST(Rays, HitsBoxesNextToFlatOnes) {
  Scene scene;
  Boxes boxes;
  for (std::uint32_t k = 0; k < 24; ++k) {
    boxes.boxes.push_back(boxAt({3.0f * static_cast<float>(k), 0, 0}));
    if (k % 3 == 1) boxes.boxes.back().min.z = boxes.boxes.back().max.z = 0;
    if (k % 3 == 2) boxes.boxes.back().max = boxes.boxes.back().min;
  }
  scene.add(scene.addBlas({boxes}), {.recordOffset = 1});
  std::vector<ProbeRay> rays;
  for (std::uint32_t k = 0; k < 24; ++k) rays.push_back({.origin = {3.0f * static_cast<float>(k), 0.1f, 2}});
  const auto hits = traceProbe(scene, rays);
  Checks checks;
  for (std::uint32_t k = 0; k < 24; k += 3) {
    checks.equal(hits[k].end, kHit, "box {}", k);
    checks.equal(hits[k].primitive, k, "box {}: primitive id", k);
  }
  checks.done();
}

// The closest hit is the nearest of many layers, independent of their order in the build.
TEST(Rays, FindsTheNearestHit) {
  Scene scene;
  Triangles layers;
  Boxes boxes;
  constexpr std::uint32_t kLayers = 37;
  for (std::uint32_t k = 0; k < kLayers; ++k) {
    const Triangles layer = triangleAt(0, 0, -static_cast<float>(k * 11 % kLayers));
    layers.positions.insert(layers.positions.end(), layer.positions.begin(), layer.positions.end());
    layers.indices.push_back(uvec3(3 * k, 3 * k + 1, 3 * k + 2));
  }
  scene.add(scene.addBlas({layers}));
  std::vector<ProbeRay> rays;
  for (std::uint32_t k = 0; k < kLayers; ++k)
    for (const float side : {1.0f, -1.0f})
      rays.push_back({.origin = {0, 0, side * 0.5f - static_cast<float>(k)}, .direction = {0, 0, -side}});
  const auto hits = traceProbe(scene, rays);
  Checks checks;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    checks.equal(hits[k].end, kHit, "ray {}", k);
    checks.near(hits[k].t, 0.5f, 1e-5f, "ray {}: t", k);
    checks.equal(hits[k].primitive * 11 % kLayers, static_cast<std::uint32_t>(k / 2), "ray {}: layer", k);
  }
  checks.done();
}

}  // namespace
}  // namespace quintet::oracle::rays_test

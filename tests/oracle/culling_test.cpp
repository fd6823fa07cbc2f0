// SPDX-License-Identifier: Apache-2.0
// Candidates of a ray for every combination of facing, ray flags, instance flags and geometry flags. The expected
// values follow Vulkan 1.3, "Ray Culling" and "Ray Opacity".
#include "checks.h"
#include "probe.h"

namespace quintet::oracle::culling_test {
namespace {

constexpr std::uint32_t kFlip = VK_GEOMETRY_INSTANCE_TRIANGLE_FLIP_FACING_BIT_KHR;
constexpr std::uint32_t kNoFacingCull = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR;
constexpr std::uint32_t kForceOpaque = VK_GEOMETRY_INSTANCE_FORCE_OPAQUE_BIT_KHR;
constexpr std::uint32_t kForceNoOpaque = VK_GEOMETRY_INSTANCE_FORCE_NO_OPAQUE_BIT_KHR;

struct Target {  // an instance and its geometry
  std::uint32_t flags = 0;
  bool opaque = true;  // flag of the geometry
  bool mirrored = false;
};

struct Expected {
  bool hit = false, anyHit = false, closestHit = false;
  std::uint32_t kind = 0;
};

bool isOpaque(const Target& target, std::uint32_t rayFlags) {
  bool opaque = target.opaque;
  if (target.flags & kForceOpaque) opaque = true;
  if (target.flags & kForceNoOpaque) opaque = false;
  if (rayFlags & kOpaque) opaque = true;
  if (rayFlags & kNoOpaque) opaque = false;
  return opaque;
}

// `fromFront` means that the vertices are counterclockwise in object space, as seen by the ray, in a right-handed
// frame. A mirrored instance makes no difference.
Expected expectedOn(const Target& target, bool triangle, bool fromFront, std::uint32_t rayFlags) {
  const bool opaque = isOpaque(target, rayFlags);
  if ((rayFlags & kCullOpaque) && opaque) return {};
  if ((rayFlags & kCullNoOpaque) && !opaque) return {};
  if (rayFlags & (triangle ? kSkipTriangles : kSkipBoxes)) return {};
  const bool front = fromFront != bool(target.flags & kFlip);
  if (triangle && !(target.flags & kNoFacingCull)) {
    if ((rayFlags & kCullFront) && front) return {};
    if ((rayFlags & kCullBack) && !front) return {};
  }
  return {true, !opaque, !(rayFlags & kSkipClosestHit), triangle ? (front ? kFrontFace : kBackFace) : 7u};
}

std::vector<Target> allTargets(bool triangles) {
  std::vector<Target> targets;
  for (const std::uint32_t facing : {0u, kFlip, kNoFacingCull, kFlip | kNoFacingCull})
    for (const std::uint32_t force : {0u, kForceOpaque, kForceNoOpaque})
      for (const bool opaque : {false, true})
        for (const bool mirrored : {false, true})
          if (triangles || facing == 0 || facing == (kFlip | kNoFacingCull))
            targets.push_back({facing | force, opaque, mirrored});
  return targets;
}

// Returns all valid combinations: at most one of the four opacity flags, one of the two face flags, and one of the two
// skip flags, but no face flag if triangles are skipped.
std::vector<std::uint32_t> allRayFlags(bool skips) {
  std::vector<std::uint32_t> all;
  using Flags = std::vector<std::uint32_t>;
  const Flags whichOnes = skips ? Flags{kSkipTriangles, kSkipBoxes} : Flags{0, kCullBack, kCullFront};
  const Flags ends = {0, kTerminateOnFirstHit, kSkipClosestHit, kTerminateOnFirstHit | kSkipClosestHit};
  for (const std::uint32_t opacity : Flags{0, kOpaque, kNoOpaque, kCullOpaque, kCullNoOpaque})
    for (const std::uint32_t which : whichOnes)
      for (const std::uint32_t end : ends) all.push_back(opacity | which | end);
  return all;
}

// One instance per target, at distances of 4.
Scene sceneOf(const std::vector<Target>& targets, bool triangles) {
  Scene scene;
  const std::size_t blas[] = {
      triangles ? scene.addBlas({triangleAt(0, 0, 0, 1, false)}) : scene.addBlas({Boxes{{boxAt({0, 0, 0})}, false}}),
      triangles ? scene.addBlas({triangleAt(0, 0, 0, 1, true)}) : scene.addBlas({Boxes{{boxAt({0, 0, 0})}, true}})};
  for (std::size_t k = 0; k < targets.size(); ++k) {
    mat4 world = glm::translate(mat4(1.0f), vec3(4.0f * static_cast<float>(k), 0, 0));
    if (targets[k].mirrored) world = world * glm::scale(mat4(1.0f), vec3(-1, 1, 1));
    scene.add(blas[targets[k].opaque],
              {.worldFromObject = world, .recordOffset = triangles ? 0u : 1u, .flags = targets[k].flags});
  }
  return scene;
}

void checkTable(bool triangles, bool skips) {
  const std::vector<Target> targets = allTargets(triangles);
  const Scene scene = sceneOf(targets, triangles);
  std::vector<ProbeRay> rays;
  std::vector<Expected> expected;
  for (std::size_t k = 0; k < targets.size(); ++k)
    for (const bool fromFront : {true, false})
      for (const std::uint32_t flags : allRayFlags(skips)) {
        const float side = fromFront ? 1.0f : -1.0f;
        rays.push_back(
            {.origin = {4.0f * static_cast<float>(k), 0, 3 * side}, .direction = {0, 0, -side}, .flags = flags});
        expected.push_back(expectedOn(targets[k], triangles, fromFront, flags));
      }
  const std::vector<ProbeHit> hits = traceProbe(scene, rays);
  Checks checks;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const Expected& e = expected[k];
    const Target& target = targets[k / (rays.size() / targets.size())];
    const std::string what = fmt::format("ray flags {:#x} towards {:+}, instance flags {:#x}, {}opaque{}",
                                         rays[k].flags, rays[k].direction.z, target.flags, target.opaque ? "" : "not ",
                                         target.mirrored ? ", mirrored" : "");
    checks.equal(hits[k].end, e.closestHit ? kHit : e.hit ? kNothing : kMissed, "{}: end", what);
    checks.equal(hits[k].anyHits > 0, e.anyHit, "{}: any-hit called", what);
    if (e.closestHit) checks.equal(hits[k].kind, e.kind, "{}: hit kind", what);
  }
  checks.done();
}

TEST(Culling, AppliesEveryCombinationOfFlagsToTriangles) { checkTable(true, false); }
TEST(Culling, AppliesEveryCombinationOfFlagsToBoxes) { checkTable(false, false); }
// These use the feature rayTraversalPrimitiveCulling, which Quintet enables if it is supported.
TEST(Culling, SkipsTriangles) { checkTable(true, true); }
TEST(Culling, SkipsBoxes) { checkTable(false, true); }

}  // namespace
}  // namespace quintet::oracle::culling_test

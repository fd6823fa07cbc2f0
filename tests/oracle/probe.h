// SPDX-License-Identifier: Apache-2.0
// A program that many tests share: it maps rays with all arguments of traceRayEXT to hits.
#ifndef QUINTET_TESTS_ORACLE_PROBE_H
#define QUINTET_TESTS_ORACLE_PROBE_H

#include <cstdint>
#include <vector>

#include "program.h"

namespace quintet::oracle {

// Ray flags of traceRayEXT (SPIR-V "Ray Flags").
enum RayFlag : std::uint32_t {
  kOpaque = 0x1,
  kNoOpaque = 0x2,
  kTerminateOnFirstHit = 0x4,
  kSkipClosestHit = 0x8,
  kCullBack = 0x10,
  kCullFront = 0x20,
  kCullOpaque = 0x40,
  kCullNoOpaque = 0x80,
  kSkipTriangles = 0x100,
  kSkipBoxes = 0x200,
};
// gl_HitKind…EXT
inline constexpr std::uint32_t kFrontFace = 0xFE, kBackFace = 0xFF;

struct ProbeRay {
  vec3 origin{0};
  float tMin = 0.0f;
  vec3 direction{0, 0, -1};
  float tMax = 1e30f;
  std::uint32_t flags = 0;
  std::uint32_t mask = 0xFF;
  std::uint32_t offset = 0;
  std::uint32_t stride = 0;
  std::uint32_t miss = 0;
};

// The last stage that wrote the result.
enum ProbeEnd : std::uint32_t { kNothing = 0, kHit = 1, kMissed = 2 };

struct ProbeHit {
  std::uint32_t end = kNothing;
  std::uint32_t anyHits = 0;  // number of any-hit calls
  float t = 0;
  std::uint32_t kind = 0;
  std::uint32_t primitive = 0;
  std::uint32_t instance = 0;  // gl_InstanceID
  std::uint32_t custom = 0;
  std::uint32_t geometry = 0;
  std::uint32_t tag = 0;  // of the hit or miss record
  vec2 attributes{0};
};

// Hit group 0 is for triangles, 1 for boxes. The intersection shader reports the t where the ray enters the box, or
// tMin if it starts inside, with hit kind 7. Box i of geometry g must be the unit cube at (3 i, 3 g, 0). Any-hit
// shaders count their calls. The data of a record is its tag, a uint.
const Program& probe();
enum ProbeGroup : std::uint32_t { kProbeTriangles = 0, kProbeBoxes = 1 };

std::vector<ProbeHit> traceProbe(const Scene& scene, const std::vector<ProbeRay>& rays, const Table& table);
// Use one hit record per group and one miss record with the tag 0.
std::vector<ProbeHit> traceProbe(const Scene& scene, const std::vector<ProbeRay>& rays);
std::vector<ProbeHit> traceProbe(VkAccelerationStructureKHR tlas, const std::vector<ProbeRay>& rays);

}  // namespace quintet::oracle
#endif

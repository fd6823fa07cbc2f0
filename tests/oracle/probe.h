// The program that many cases share: rays with all arguments of traceRayEXT in, what happened out.
#ifndef QUINTET_TESTS_ORACLE_PROBE_H
#define QUINTET_TESTS_ORACLE_PROBE_H

#include "program.h"

namespace quintet::oracle {

// Bits of traceRayEXT's flags (SPIR-V "Ray Flags").
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

// The stage that wrote the result last.
enum ProbeEnd : std::uint32_t { kNothing = 0, kHit = 1, kMissed = 2 };

struct ProbeHit {
  std::uint32_t end = kNothing;
  std::uint32_t anyHits = 0;  // calls of any-hit shaders
  float t = 0;
  std::uint32_t kind = 0;
  std::uint32_t primitive = 0;
  std::uint32_t instance = 0;  // gl_InstanceID
  std::uint32_t custom = 0;
  std::uint32_t geometry = 0;
  std::uint32_t tag = 0;  // of the hit or miss record
  vec2 attributes{0};
};

// Hit groups: 0 triangles, 1 boxes (the intersection shader reports where the ray enters the box, or tMin
// when it starts inside; hit kind 7). Box i of geometry g has to be the unit cube around (3 i, 3 g, 0). Both count their any-hit calls. Records carry a uint, the tag.
const Program& probe();
enum ProbeGroup : std::uint32_t { kProbeTriangles = 0, kProbeBoxes = 1 };

std::vector<ProbeHit> traceProbe(const Scene& scene, const std::vector<ProbeRay>& rays, const Table& table);
// One hit record for each group and one miss record, with tags 0.
std::vector<ProbeHit> traceProbe(const Scene& scene, const std::vector<ProbeRay>& rays);
std::vector<ProbeHit> traceProbe(VkAccelerationStructureKHR tlas, const std::vector<ProbeRay>& rays);

}  // namespace quintet::oracle
#endif

// SPDX-License-Identifier: Apache-2.0
#include "probe.h"

namespace quintet::oracle {
namespace {

constexpr char kCommon[] = R"(
struct Input { vec3 origin; float tMin; vec3 direction; float tMax; uint flags; uint mask; uint offset; uint stride; uint miss; };
struct Output {
  uint end; uint anyHits; float t; uint kind; uint primitive; uint instance; uint custom; uint geometry;
  uint tag; vec2 attributes;
};
)";

constexpr char kRayGeneration[] = R"(
layout(location = 0) rayPayloadEXT Output result;
void main() {
  Input ray = launch.inputs.at[launchIndex()];
  result = Output(0, 0, 0.0, 0, 0, 0, 0, 0, 0, vec2(0.0));
  traceRayEXT(tlas, ray.flags, ray.mask, ray.offset, ray.stride, ray.miss, ray.origin, ray.tMin, ray.direction, ray.tMax, 0);
  launch.outputs.at[launchIndex()] = result;
}
)";

constexpr char kMiss[] = R"(
layout(location = 0) rayPayloadInEXT Output result;
layout(shaderRecordEXT, scalar) buffer RecordData { uint tag; } record;
void main() { result.end = 2u; result.tag = record.tag; }
)";

constexpr char kClosestHit[] = R"(
layout(location = 0) rayPayloadInEXT Output result;
layout(shaderRecordEXT, scalar) buffer RecordData { uint tag; } record;
hitAttributeEXT vec2 attributes;
void main() {
  result = Output(1u, result.anyHits, gl_HitTEXT, gl_HitKindEXT, gl_PrimitiveID, gl_InstanceID, gl_InstanceCustomIndexEXT,
                  gl_GeometryIndexEXT, record.tag, attributes);
}
)";

constexpr char kAnyHit[] = R"(
layout(location = 0) rayPayloadInEXT Output result;
void main() { result.anyHits++; }
)";

// Box i of geometry g is the unit cube at (3 i, 3 g, 0). Slab test (Kay and Kajiya, 1986).
constexpr char kIntersection[] = R"(
hitAttributeEXT vec2 attributes;
void main() {
  vec3 center = vec3(3 * gl_PrimitiveID, 3 * gl_GeometryIndexEXT, 0);
  vec3 a = (center - 0.5 - gl_ObjectRayOriginEXT) / gl_ObjectRayDirectionEXT;
  vec3 b = (center + 0.5 - gl_ObjectRayOriginEXT) / gl_ObjectRayDirectionEXT;
  vec3 near = min(a, b), far = max(a, b);
  float enter = max(max(near.x, near.y), max(near.z, gl_RayTminEXT));
  float leave = min(min(far.x, far.y), far.z);
  if (enter > leave) return;
  attributes = vec2(0.25, 0.75);
  reportIntersectionEXT(enter, 7u);
}
)";

}  // namespace

const Program& probe() {
  static std::unique_ptr<Program> program;
  if (!program) {
    program = std::make_unique<Program>(
        ProgramText{.common = kCommon,
                    .rayGeneration = kRayGeneration,
                    .miss = {kMiss},
                    .hit = {{.closestHit = kClosestHit, .anyHit = kAnyHit},
                            {.closestHit = kClosestHit, .anyHit = kAnyHit, .intersection = kIntersection}}});
    atEnd([] { program.reset(); });
  }
  return *program;
}

std::vector<ProbeHit> traceProbe(const Scene& scene, const std::vector<ProbeRay>& rays, const Table& table) {
  return run<ProbeHit>(probe(), scene, rays, {.table = &table});
}

std::vector<ProbeHit> traceProbe(VkAccelerationStructureKHR tlas, const std::vector<ProbeRay>& rays) {
  const Table table{.miss = {recordOf(0, 0u)}, .hit = {recordOf(kProbeTriangles, 0u), recordOf(kProbeBoxes, 0u)}};
  return run<ProbeHit>(probe(), tlas, rays, {.table = &table});
}

std::vector<ProbeHit> traceProbe(const Scene& scene, const std::vector<ProbeRay>& rays) {
  return traceProbe(scene.handle(), rays);
}

}  // namespace quintet::oracle

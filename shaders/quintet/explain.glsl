// SPDX-License-Identifier: Apache-2.0
// Logs what each stage of a program does for one sample (quintet explain-pixel). program::instrumentStage inserts this file
// before a stage and a new main() after it, and defines QUINTET_EXPLAIN_STAGE and QUINTET_EXPLAIN_KIND (0 ray generation,
// 1 closest hit, 2 any-hit, 3 miss, 4 intersection, 5 callable). Macros replace the calls and statements of ray tracing.
//
// Every hit is logged, so no trace has the flag SkipClosestHitShader. Instead, the closest-hit shader returns before the
// code of the program, and gl_IncomingRayFlagsEXT has the flag. A launch has one invocation, that of the logged pixel.
#ifndef QUINTET_EXPLAIN_GLSL
#define QUINTET_EXPLAIN_GLSL

#include "frame.glsl"
#include "log.glsl"
#include "shared/explain.h"

#if defined(QUINTET_RECURSION_DEPTH) && (QUINTET_EXPLAIN_KIND == 0 || QUINTET_EXPLAIN_KIND == 1 || QUINTET_EXPLAIN_KIND == 3)
#define EXPLAIN_RECURSION
#if QUINTET_EXPLAIN_KIND == 0
#define QUINTET_RECURSION_START 1
#endif
#include "recursion.glsl"
#undef traceRayEXT
#endif

// Declares explain_(Type), which appends a record.
#define EXPLAIN_RECORD(Type, kind, words)                                                                  \
  layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Type##At_ { Type value; }; \
  void explain_(Type record) {                                                                             \
    const uint at = logBegin_(kind, words);                                                                \
    if (at != kLogNone_) Type##At_(logAddress_(at)).value = record;                                        \
  }

uint64_t logAddress_(uint at) { return frame.log + uint64_t(32u + 4u * at); }

EXPLAIN_RECORD(ExplainRay, kLogRay, 15u)
EXPLAIN_RECORD(ExplainRayEnd, kLogRayEnd, 1u)
EXPLAIN_RECORD(ExplainCall, kLogCall, 3u)
EXPLAIN_RECORD(ExplainStage, kLogStage, 1u)
EXPLAIN_RECORD(ExplainHit, kLogHit, 19u)
EXPLAIN_RECORD(ExplainBox, kLogBox, 6u)
EXPLAIN_RECORD(ExplainStageEnd, kLogStageEnd, 1u)
EXPLAIN_RECORD(ExplainReport, kLogReport, 3u)
EXPLAIN_RECORD(ExplainStore, kLogStore, 10u)
EXPLAIN_RECORD(ExplainCamera, kLogCamera, 4u)
EXPLAIN_RECORD(ExplainSurface, kLogSurface, 13u)
EXPLAIN_RECORD(ExplainShading, kLogShading, 24u)
EXPLAIN_RECORD(ExplainLobe, kLogLobe, 2u)
EXPLAIN_RECORD(ExplainLightChoice, kLogLightChoice, 6u)
EXPLAIN_RECORD(ExplainLightSample, kLogLightSample, 17u)
EXPLAIN_RECORD(ExplainLightRoulette, kLogLightRoulette, 2u)
EXPLAIN_RECORD(ExplainVisibility, kLogVisibility, 3u)
EXPLAIN_RECORD(ExplainBsdfSample, kLogBsdfSample, 11u)
EXPLAIN_RECORD(ExplainRoulette, kLogRoulette, 5u)
EXPLAIN_RECORD(ExplainEmission, kLogEmission, 10u)
EXPLAIN_RECORD(ExplainContribution, kLogContribution, 8u)
EXPLAIN_RECORD(ExplainPathEnd, kLogPathEnd, 1u)

// program::compile defines more words for a stage with larger data.
#ifndef QUINTET_EXPLAIN_DATA_WORDS
#define QUINTET_EXPLAIN_DATA_WORDS kExplainDataWords
#endif

// Makes room for the payload or callable data of a call. spirv/log_call_data.h replaces the store.
#define EXPLAIN_DATA(marker)                                         \
  do {                                                               \
    const uint at = logBegin_(kLogData, 1u + QUINTET_EXPLAIN_DATA_WORDS); \
    if (at != kLogNone_) LogReference_(frame.log).words[at] = marker; \
  } while (false)
void explainDataBefore_() { EXPLAIN_DATA(kExplainDataBefore); }
void explainDataAfter_() { EXPLAIN_DATA(kExplainDataAfter); }

uint explainState_() { return LogReference_(frame.log).header.state; }

// ---------------------------------------------------------------- Calls

#if QUINTET_EXPLAIN_KIND != 2 && QUINTET_EXPLAIN_KIND != 4
void explainCall_(uint index, uint line) { explain_(ExplainCall(QUINTET_EXPLAIN_STAGE, line, index)); }
void explainCallEnd_() { logBegin_(kLogCallEnd, 0u); }

#define executeCallableEXT(index_, location_)     \
  do {                                            \
    const uint eIndex_ = (index_);                \
    explainCall_(eIndex_, uint(__LINE__));        \
    explainDataBefore_();                         \
    executeCallableEXT(eIndex_, location_);       \
    explainDataAfter_();                          \
    explainCallEnd_();                            \
  } while (false)

// Returns false if the trace must not run.
bool explainTrace_(ExplainRay ray, out uint above) {
  explain_(ray);
  above = 0u;
#ifdef EXPLAIN_RECURSION
  if (!recursionEnter_(above)) return false;
#endif
  LogReference_(frame.log).header.state = (ray.flags & gl_RayFlagsSkipClosestHitShaderEXT) != 0u ? kExplainSkipsClosestHit : 0u;
  return true;
}
void explainTraceEnd_(bool traced, uint above) {
#ifdef EXPLAIN_RECURSION
  if (traced) recursionLeave_(above);
#endif
  explain_(ExplainRayEnd(traced ? 1u : 0u));
}

// Evaluates each argument once.
#define traceRayEXT(as_, flags_, mask_, offset_, stride_, miss_, origin_, tmin_, direction_, tmax_, location_)              \
  do {                                                                                                                     \
    const uint eFlags_ = (flags_), eMask_ = (mask_), eOffset_ = (offset_), eStride_ = (stride_), eMiss_ = (miss_);         \
    const vec3 eOrigin_ = (origin_), eDirection_ = (direction_);                                                           \
    const float eTmin_ = (tmin_), eTmax_ = (tmax_);                                                                        \
    uint eAbove_;                                                                                                          \
    const bool eTraced_ = explainTrace_(explainRay_(eFlags_, eMask_, eOffset_, eStride_, eMiss_, eOrigin_, eTmin_,         \
                                                    eDirection_, eTmax_, uint(__LINE__)), eAbove_);                        \
    explainDataBefore_();                                                                                                  \
    if (eTraced_) {                                                                                                        \
      traceRayEXT(as_, eFlags_ & ~gl_RayFlagsSkipClosestHitShaderEXT, eMask_, eOffset_, eStride_, eMiss_, eOrigin_, eTmin_, \
                  eDirection_, eTmax_, location_);                                                                         \
    }                                                                                                                      \
    explainDataAfter_();                                                                                                   \
    explainTraceEnd_(eTraced_, eAbove_);                                                                                   \
  } while (false)

ExplainRay explainRay_(uint flags, uint mask, uint offset, uint stride, uint miss, vec3 origin, float tmin, vec3 direction,
                       float tmax, uint line) {
  return ExplainRay(QUINTET_EXPLAIN_STAGE, line, flags, mask, offset, stride, miss, origin, tmin, direction, tmax);
}
#endif

// ---------------------------------------------------------------- Stores

void explainStore_(uint slot, uvec2 pixel, vec4 value, uint mode, uint line) {
  explain_(ExplainStore(QUINTET_EXPLAIN_STAGE, line, slot, mode, pixel, value));
}

// ---------------------------------------------------------------- Begin and end of a stage

#if QUINTET_EXPLAIN_KIND == 1 || QUINTET_EXPLAIN_KIND == 2 || QUINTET_EXPLAIN_KIND == 4
GeometryData explainGeometry_() {
  const uint first = InstanceArray(frame.instances).at[gl_InstanceCustomIndexEXT].firstGeometry;
  return GeometryArray(frame.geometries).at[first + uint(gl_GeometryIndexEXT)];
}

// Index of the triangle or box in the scene's order.
uint explainPrimitive_(GeometryData geometry) {
  return geometry.primitiveMap != 0ul ? PrimitiveIndexArray(geometry.primitiveMap).at[gl_PrimitiveID]
                                      : uint(gl_PrimitiveID);
}
#endif

#if QUINTET_EXPLAIN_KIND == 1 || QUINTET_EXPLAIN_KIND == 2
// Adds barycentrics, normals and texture coordinates. The barycentrics are computed from the ray, because on some drivers
// the attributes can be those of a rejected candidate (docs/design/quirks.md), and because the program declares them.
void explainTriangle_(GeometryData geometry, inout ExplainHit hit) {
  const uvec3 v = Uvec3Array(geometry.triangles).at[hit.primitive];
  Vec3Array positions = Vec3Array(geometry.positions);
  const vec3 p0 = positions.at[v.x];
  const vec3 edge1 = positions.at[v.y] - p0;
  const vec3 edge2 = positions.at[v.z] - p0;
  const vec3 p = cross(gl_ObjectRayDirectionEXT, edge2);
  const float determinant = dot(edge1, p);
  const vec3 s = gl_ObjectRayOriginEXT - p0;
  const vec3 q = cross(s, edge1);
  const vec2 products = vec2(dot(s, p), dot(gl_ObjectRayDirectionEXT, q));
  vec2 b = clamp(products * (determinant != 0.0 ? 1.0 / determinant : 0.0), 0.0, 1.0);
  b /= max(1.0, b.x + b.y);
  const vec3 weights = vec3(1.0 - b.x - b.y, b);
  hit.barycentric = b;
  const mat3x3 linear = mat3x3(gl_ObjectToWorldEXT);
  const bool mirrored = (InstanceArray(frame.instances).at[hit.instance].flags & kInstanceMirrored) != 0u;
  hit.geometricNormal = normalize(cross(linear * edge1, linear * edge2)) * (mirrored ? -1.0 : 1.0);
  hit.shadingNormal = hit.geometricNormal;
  if (geometry.normals != 0ul) {
    Vec3Array normals = Vec3Array(geometry.normals);
    const vec3 n = weights.x * normals.at[v.x] + weights.y * normals.at[v.y] + weights.z * normals.at[v.z];
    hit.shadingNormal = normalize(n * mat3x3(gl_WorldToObjectEXT));
  }
  if (geometry.uvs[0] != 0ul) {
    Vec2Array uvs = Vec2Array(geometry.uvs[0]);
    hit.uv = weights.x * uvs.at[v.x] + weights.y * uvs.at[v.y] + weights.z * uvs.at[v.z];
  }
}

void explainHit_(bool runsProgram) {
  const GeometryData geometry = explainGeometry_();
  ExplainHit hit;
  hit.stage = QUINTET_EXPLAIN_STAGE;
  hit.instance = uint(gl_InstanceCustomIndexEXT);
  hit.geometry = uint(gl_GeometryIndexEXT);
  hit.primitive = explainPrimitive_(geometry);
  hit.material = geometry.material;
  hit.geometryKind = geometry.kind;
  hit.hitKind = gl_HitKindEXT;
  hit.t = gl_HitTEXT;
  hit.barycentric = hit.uv = vec2(0.0);
  hit.geometricNormal = hit.shadingNormal = vec3(0.0);
  hit.runsProgram = runsProgram ? 1u : 0u;
  if (geometry.kind == kGeometryTriangles) explainTriangle_(geometry, hit);
  if (geometry.kind == kGeometrySolids) hit.material = PrimitiveArray(geometry.primitives).at[hit.primitive].material;
  explain_(hit);
}
#endif

#if QUINTET_EXPLAIN_KIND >= 2 && QUINTET_EXPLAIN_KIND <= 4
uint explainFlags_ = 0u;  // of the ray, as the program traces it
#endif

// Returns whether the code of the program runs.
bool explainBegin_() {
#if QUINTET_EXPLAIN_KIND >= 2 && QUINTET_EXPLAIN_KIND <= 4
  explainFlags_ = gl_IncomingRayFlagsEXT;
  if (explainState_() == kExplainSkipsClosestHit) explainFlags_ |= gl_RayFlagsSkipClosestHitShaderEXT;
#define gl_IncomingRayFlagsEXT explainFlags_
#endif
#if QUINTET_EXPLAIN_KIND == 1
#ifdef QUINTET_EXPLAIN_HIT_ONLY
  const bool runs = false;
#else
  const bool runs = explainState_() != kExplainSkipsClosestHit;
#endif
  explainHit_(runs);
  if (!runs) explain_(ExplainStageEnd(kExplainReturned));
  return runs;
#elif QUINTET_EXPLAIN_KIND == 2
  explainHit_(true);
#elif QUINTET_EXPLAIN_KIND == 3 || QUINTET_EXPLAIN_KIND == 5
  explain_(ExplainStage(QUINTET_EXPLAIN_STAGE));
#elif QUINTET_EXPLAIN_KIND == 4
  explain_(ExplainBox(QUINTET_EXPLAIN_STAGE, uint(gl_InstanceCustomIndexEXT), uint(gl_GeometryIndexEXT),
                      explainPrimitive_(explainGeometry_()), gl_RayTminEXT, gl_RayTmaxEXT));
#endif
  return true;
}

void explainEnd_(uint result) {
#if QUINTET_EXPLAIN_KIND != 0
  explain_(ExplainStageEnd(result));
#endif
}

#if QUINTET_EXPLAIN_KIND == 2
#define ignoreIntersectionEXT       \
  do {                              \
    explainEnd_(kExplainIgnored);   \
    ignoreIntersectionEXT;          \
  } while (false)
#define terminateRayEXT             \
  do {                              \
    explainEnd_(kExplainTerminated); \
    terminateRayEXT;                \
  } while (false)
#elif QUINTET_EXPLAIN_KIND == 4
bool explainReport_(float t, uint hitKind) {
  const bool accepted = reportIntersectionEXT(t, hitKind);
  explain_(ExplainReport(t, hitKind, accepted ? 1u : 0u));
  return accepted;
}
#define reportIntersectionEXT(t_, hitKind_) explainReport_(t_, hitKind_)
#endif

#define main explainedMain_

#endif

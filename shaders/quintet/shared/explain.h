// SPDX-License-Identifier: Apache-2.0
// Records of the shader log (log.h) that explain a sample: what each stage of an instrumented program did
// (quintet/explain.glsl), and what the path tracer sampled (quintet/explain_hooks.glsl). job/pixel_explanation.h makes
// a tree of them.
#ifndef QUINTET_SHARED_EXPLAIN_H
#define QUINTET_SHARED_EXPLAIN_H

#include "log.h"

QT_SHARED_BEGIN

// LogRecord::kind. Records between a begin and its end happened inside.
QT_CONSTANT kLogRay = 16u;          // ExplainRay: begin of a trace
QT_CONSTANT kLogRayEnd = 17u;       // ExplainRayEnd
QT_CONSTANT kLogCall = 18u;         // ExplainCall: begin of executeCallableEXT
QT_CONSTANT kLogCallEnd = 19u;      // no data
QT_CONSTANT kLogData = 20u;         // number of the call site, then the words of the payload or callable data
QT_CONSTANT kLogStage = 21u;        // ExplainStage: begin of a miss or callable shader
QT_CONSTANT kLogHit = 22u;          // ExplainHit: begin of a closest-hit or any-hit shader
QT_CONSTANT kLogBox = 23u;          // ExplainBox: begin of an intersection shader
QT_CONSTANT kLogStageEnd = 24u;     // ExplainStageEnd
QT_CONSTANT kLogReport = 25u;       // ExplainReport
QT_CONSTANT kLogStore = 26u;        // ExplainStore
QT_CONSTANT kLogCamera = 27u;       // ExplainCamera
QT_CONSTANT kLogSurface = 28u;      // ExplainSurface
QT_CONSTANT kLogShading = 29u;      // ExplainShading
QT_CONSTANT kLogLobe = 30u;         // ExplainLobe
QT_CONSTANT kLogLightChoice = 31u;  // ExplainLightChoice
QT_CONSTANT kLogLightSample = 32u;  // ExplainLightSample
QT_CONSTANT kLogVisibility = 33u;   // ExplainVisibility
QT_CONSTANT kLogBsdfSample = 34u;   // ExplainBsdfSample
QT_CONSTANT kLogRoulette = 35u;     // ExplainRoulette
QT_CONSTANT kLogEmission = 36u;     // ExplainEmission
QT_CONSTANT kLogContribution = 37u;  // ExplainContribution
QT_CONSTANT kLogPathEnd = 38u;       // ExplainPathEnd
QT_CONSTANT kLogLightRoulette = 39u;  // ExplainLightRoulette

// A store of this word, or of the next one, to the log marks where the data before or after a call belong. It is replaced
// by stores of the number of the call site and of the data (spirv/log_call_data.h).
QT_CONSTANT kExplainDataBefore = 0x51A7DA7Au;
QT_CONSTANT kExplainDataAfter = 0x51A7DA7Bu;

// Words of a kLogData record after the number of the call site; longer data are truncated.
QT_CONSTANT kExplainDataWords = 64u;

// Frame::log, LogHeader::state: the trace has the flag SkipClosestHitShader.
QT_CONSTANT kExplainSkipsClosestHit = 1u;

// `stage`: index in CompiledProgram::stages. `line`: of the call, in the stage's file or an included one.
struct ExplainRay {
  uint stage;
  uint line;
  uint flags;         // gl_RayFlags…
  uint mask;
  uint recordOffset;  // of the hit records
  uint recordStride;
  uint missIndex;
  vec3 origin;
  float tmin;
  vec3 direction;
  float tmax;
};
QT_SHARED_SIZE(ExplainRay, 60);

struct ExplainRayEnd {
  uint traced;  // 0: not executed, because it is deeper than the recursion depth of the pipeline
};
QT_SHARED_SIZE(ExplainRayEnd, 4);

struct ExplainCall {
  uint stage;
  uint line;
  uint index;  // of the callable shader
};
QT_SHARED_SIZE(ExplainCall, 12);

struct ExplainStage {
  uint stage;
};
QT_SHARED_SIZE(ExplainStage, 4);

// Of a committed hit, or of a candidate in an any-hit shader. Indices are those of the scene.
struct ExplainHit {
  uint stage;
  uint instance;
  uint geometry;
  uint primitive;
  uint material;      // unknown for CSG trees, whose solids have materials of their own
  uint geometryKind;  // kGeometry…
  uint hitKind;
  float t;
  // Of triangles; 0 for boxes.
  vec2 barycentric;      // weights of vertices 1 and 2
  vec2 uv;               // first texture coordinates
  vec3 geometricNormal;  // world, unit, of the front side
  vec3 shadingNormal;    // world, unit, interpolated
  uint runsProgram;      // 0: the program has no closest-hit shader here, or the ray skips it
};
QT_SHARED_SIZE(ExplainHit, 76);

struct ExplainBox {
  uint stage;
  uint instance;
  uint geometry;
  uint primitive;
  float tmin;
  float tmax;
};
QT_SHARED_SIZE(ExplainBox, 24);

// ExplainStageEnd::result
QT_CONSTANT kExplainReturned = 0u;
QT_CONSTANT kExplainIgnored = 1u;     // ignoreIntersectionEXT
QT_CONSTANT kExplainTerminated = 2u;  // terminateRayEXT

struct ExplainStageEnd {
  uint result;
};
QT_SHARED_SIZE(ExplainStageEnd, 4);

struct ExplainReport {
  float t;
  uint hitKind;
  uint accepted;
};
QT_SHARED_SIZE(ExplainReport, 12);

// ExplainStore::mode
QT_CONSTANT kExplainStored = 0u;    // the value replaces that of the output
QT_CONSTANT kExplainAdded = 1u;     // the value is added to that of the output
QT_CONSTANT kExplainCoverage = 2u;  // value.x holds the bits of an id

struct ExplainStore {
  uint stage;
  uint line;
  uint slot;
  uint mode;
  uvec2 pixel;
  vec4 value;
};
QT_SHARED_SIZE(ExplainStore, 40);

struct ExplainCamera {
  vec2 film;  // position in the image, pixels from the top left corner
  vec2 lens;  // random numbers of the point on the lens, [0,1)
};
QT_SHARED_SIZE(ExplainCamera, 16);

// A Surface (quintet/surface.glsl).
struct ExplainSurface {
  vec3 position;  // world
  vec3 geometricNormal;
  vec3 shadingNormal;  // before normal mapping
  vec2 uv;
  uint material;
  uint frontFace;
};
QT_SHARED_SIZE(ExplainSurface, 52);

// A Shading (quintet/material.glsl).
struct ExplainShading {
  vec3 normal;  // world, after normal mapping
  vec3 emission;
  vec3 baseColor;
  float metallic;
  float alpha;  // roughness squared
  float transmission;
  float ior;
  float clearcoat;
  vec3 sheenColor;
  float sheenAlpha;  // sheenRoughness squared
  float diffuseTransmission;
  float anisotropy;  // strength
  float iridescence;
  float iridescenceThickness;  // nanometers
  float dispersion;
  uint unlit;
};
QT_SHARED_SIZE(ExplainShading, 96);

struct ExplainLobe {
  uint lobe;          // kLobe… (quintet/bsdf/lobes.glsl)
  float probability;  // with which it was chosen
};
QT_SHARED_SIZE(ExplainLobe, 8);

struct ExplainLightChoice {
  uint light;      // index in Frame::lights; kNoLight: none
  uint type;       // kLight…
  uint instance;   // triangles and solids
  uint geometry;
  uint primitive;
  float probability;  // with which it was chosen
};
QT_SHARED_SIZE(ExplainLightChoice, 24);

// The chosen light, if it can contribute.
struct ExplainLightSample {
  uint delta;      // BSDF sampling cannot find this light
  vec3 direction;  // world, unit, to the light
  float distance;  // meters
  vec3 radiance;   // arriving
  float pdf;       // per solid angle, choice of the light included
  vec3 bsdf;       // f |cos|
  float bsdfPdf;   // of BSDF sampling for this direction
  float misWeight;
  vec3 throughput;  // of the path up to the surface
};
QT_SHARED_SIZE(ExplainLightSample, 68);

// Russian roulette of the light sample, if its survival is not certain.
struct ExplainLightRoulette {
  float survival;  // probability with which the shadow ray is traced
  float u;         // it is traced if u < survival
};
QT_SHARED_SIZE(ExplainLightRoulette, 8);

struct ExplainVisibility {
  vec3 transmittance;  // of the shadow ray; 0: blocked
};
QT_SHARED_SIZE(ExplainVisibility, 12);

struct ExplainBsdfSample {
  uint useful;       // 0: the sample contributes nothing, and the path ends
  uint delta;
  uint transmitted;
  uint straight;     // through a pane
  vec3 direction;    // world, unit
  float pdf;         // per solid angle, of all lobes together; 0 for a delta
  vec3 weight;       // f |cos| / pdf
};
QT_SHARED_SIZE(ExplainBsdfSample, 44);

struct ExplainRoulette {
  float survival;  // probability
  float u;         // the path survives if u < survival
  vec3 throughput;  // after the division by the probability
};
QT_SHARED_SIZE(ExplainRoulette, 20);

// ExplainEmission::source and ExplainContribution::source
QT_CONSTANT kExplainFromBackground = 0u;
QT_CONSTANT kExplainFromSurface = 1u;    // the path hit the emitter
QT_CONSTANT kExplainFromLightSample = 2u;

struct ExplainEmission {
  uint source;
  vec3 radiance;
  vec3 throughput;
  float bsdfPdf;   // with which the path's direction was sampled; 0 for camera rays and deltas
  float lightPdf;  // of light sampling for this point; 0 if it cannot find the light
  float misWeight;
};
QT_SHARED_SIZE(ExplainEmission, 40);

struct ExplainContribution {
  uint source;
  uint scatterings;  // scattering events of the light path
  vec3 value;        // that is added to the sample's value
  vec3 unclamped;
};
QT_SHARED_SIZE(ExplainContribution, 32);

// ExplainPathEnd::reason
QT_CONSTANT kExplainUnlit = 0u;         // the surface does not scatter
QT_CONSTANT kExplainBounces = 1u;       // the largest number of scattering events
QT_CONSTANT kExplainInconsistent = 2u;  // the direction is on different sides of the shading and the geometric normal

struct ExplainPathEnd {
  uint reason;
};
QT_SHARED_SIZE(ExplainPathEnd, 4);

QT_SHARED_END

#endif

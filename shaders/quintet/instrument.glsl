// SPDX-License-Identifier: Apache-2.0
// Runtime checks (quintet check --instrument). program::instrumentStage inserts this file before a stage and a new
// main() after it, and defines QUINTET_INSTRUMENT_STAGE and QUINTET_INSTRUMENT_KIND (0 ray generation, 1 closest hit, 2
// any-hit, 3 miss, 4 intersection, 5 callable). A macro replaces traceRayEXT and checks the arguments first.
//
// Every hit is checked, so no trace has the flag SkipClosestHitShader. Instead, the closest-hit shader returns before the
// code of the program, and gl_IncomingRayFlagsEXT has the flag.
#ifndef QUINTET_INSTRUMENT_GLSL
#define QUINTET_INSTRUMENT_GLSL

#include "frame.glsl"
#include "shared/instrument.h"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer InstrumentReference {
  Instrument value;
  InstrumentReport reports[kInstrumentReports];
  InstrumentPixel pixels[];
};

#define instrument_ InstrumentReference(frame.instrument)
uint instrumentPixel_() {
  const uvec2 film = gl_LaunchIDEXT.xy + launch.offset - frame.filmOffset;
  return film.y * frame.filmWidth + film.x;
}

vec2 instrumentInterval_ = vec2(0.0);  // of the trace

// `stage` and `line`: of the call.
void instrumentReport_(uint kind, uint stage, uint line, uint depth, float distance, uint index, vec3 origin, vec3 direction) {
  const uint slot = atomicAdd(instrument_.value.reportCount, 1u);
  if (slot >= kInstrumentReports) return;
  InstrumentReport report;
  report.kind = kind;
  report.stage = stage;
  report.line = line;
  report.depth = depth;
  report.pixel = gl_LaunchIDEXT.xy + launch.offset;
  report.distance = distance;
  report.index = index;
  report.origin = origin;
  report.direction = direction;
  report.interval = instrumentInterval_;
  instrument_.reports[slot] = report;
}

// Checks the target before an output is stored. Returns false if it must not be stored.
bool instrumentOutput_(uint slot, uvec2 pixel, uint line) {
  const uvec2 film = pixel - frame.filmOffset;
  if (slot < instrument_.value.outputCount && film.x < frame.filmWidth && film.y < frame.filmHeight)
    return frame.outputs[slot] != 0ul;
  instrumentReport_(kReportOutput, QUINTET_INSTRUMENT_STAGE, line, 0u, 0.0, slot, vec3(vec2(ivec2(film)), 0.0), vec3(0.0));
  return false;
}

#if QUINTET_INSTRUMENT_KIND == 1
// Reports a hit on the primitive of the previous closest hit within the rounding error of the coordinates (64 roundings).
void instrumentSelfHit_() {
  const InstrumentPixel pixel = instrument_.pixels[instrumentPixel_()];
  const float error = 64.0 * 5.9604645e-8 * max(maxComponent(abs(gl_WorldRayOriginEXT)), 1e-30);
  const float distance = gl_HitTEXT * length(gl_WorldRayDirectionEXT);
  if (pixel.instance == uint(gl_InstanceCustomIndexEXT) + 1u && pixel.geometry == uint(gl_GeometryIndexEXT) &&
      pixel.primitive == uint(gl_PrimitiveID) && distance < error)
    instrumentReport_(kReportSelfHit, pixel.stage, pixel.line, pixel.depth, distance, 0u, gl_WorldRayOriginEXT,
                      gl_WorldRayDirectionEXT);
}

// This hit becomes the previous one.
void instrumentKeepHit_() {
  const uint pixel = instrumentPixel_();
  instrument_.pixels[pixel].instance = uint(gl_InstanceCustomIndexEXT) + 1u;
  instrument_.pixels[pixel].geometry = uint(gl_GeometryIndexEXT);
  instrument_.pixels[pixel].primitive = uint(gl_PrimitiveID);
}
#endif

#if QUINTET_INSTRUMENT_KIND != 2 && QUINTET_INSTRUMENT_KIND != 4
// Checks the index before a call. Returns false if the call must not run.
bool instrumentCall_(uint index, uint line) {
  if (index < instrument_.value.callableCount) return true;
  instrumentReport_(kReportCall, QUINTET_INSTRUMENT_STAGE, line, instrument_.pixels[instrumentPixel_()].depth, 0.0, index, vec3(0.0), vec3(0.0));
  return false;
}
#define executeCallableEXT(index_, location_)                                                    \
  do {                                                                                           \
    const uint iIndex_ = (index_);                                                               \
    if (instrumentCall_(iIndex_, uint(__LINE__))) executeCallableEXT(iIndex_, location_);        \
  } while (false)

bool instrumentBad_(vec3 v) { return any(isnan(v)) || any(isinf(v)); }

// Checks the arguments before a trace. Returns false if the trace must not run.
bool instrumentTrace_(uint flags, uint mask, uint offset, uint stride, uint miss, vec3 origin, float tmin, vec3 direction, float tmax, uint line) {
  const uint pixel = instrumentPixel_();
  instrument_.pixels[pixel].flags = flags;
  instrument_.pixels[pixel].stage = QUINTET_INSTRUMENT_STAGE;
  instrument_.pixels[pixel].line = line;
  const uint depth = ++instrument_.pixels[pixel].depth;
  atomicAdd(instrument_.value.traceCount, 1u);
  atomicMax(instrument_.value.deepest, depth);
  instrumentInterval_ = vec2(tmin, tmax);
  const uint pair = (offset & 15u) + 16u * (stride & 15u);
  if (instrumentBad_(origin) || instrumentBad_(direction) || direction == vec3(0.0) || isnan(tmin) || isnan(tmax) || tmin < 0.0 || tmax < tmin) {
    instrumentReport_(kReportRay, QUINTET_INSTRUMENT_STAGE, line, depth, 0.0, 0u, origin, direction);
    return false;
  }
  if (depth > instrument_.value.depthLimit) {
    instrumentReport_(kReportDepth, QUINTET_INSTRUMENT_STAGE, line, depth, 0.0, 0u, origin, direction);
    return false;
  }
  if ((miss & 0xFFFFu) >= instrument_.value.missCount) {
    instrumentReport_(kReportMiss, QUINTET_INSTRUMENT_STAGE, line, depth, 0.0, miss, origin, direction);
    return false;
  }
  if (((instrument_.value.badRecords[pair / 4u] >> (8u * (pair % 4u))) & mask & 0xFFu) != 0u) {
    atomicOr(instrument_.value.recordPairs[pair / 32u], 1u << (pair % 32u));
    instrumentReport_(kReportRecord, QUINTET_INSTRUMENT_STAGE, line, depth, 0.0, pair, origin, direction);
    return false;
  }
  atomicAdd(instrument_.value.rays[offset & 15u], 1u);
  return true;
}
void instrumentAfter_() {
  instrument_.pixels[instrumentPixel_()].depth--;
#if QUINTET_INSTRUMENT_KIND == 1
  instrumentKeepHit_();  // further rays start here, not where the ray has ended
#endif
}

// Evaluates each argument once.
#define traceRayEXT(as_, flags_, mask_, offset_, stride_, miss_, origin_, tmin_, direction_, tmax_, location_)              \
  do {                                                                                                                     \
    const uint iFlags_ = (flags_), iMask_ = (mask_), iOffset_ = (offset_), iStride_ = (stride_), iMiss_ = (miss_);         \
    const vec3 iOrigin_ = (origin_), iDirection_ = (direction_);                                                           \
    const float iTmin_ = (tmin_), iTmax_ = (tmax_);                                                                        \
    if (instrumentTrace_(iFlags_, iMask_, iOffset_, iStride_, iMiss_, iOrigin_, iTmin_, iDirection_, iTmax_, uint(__LINE__))) {    \
      traceRayEXT(as_, iFlags_ & ~gl_RayFlagsSkipClosestHitShaderEXT, iMask_, iOffset_, iStride_, iMiss_, iOrigin_, iTmin_, \
                  iDirection_, iTmax_, location_);                                                                         \
    }                                                                                                                      \
    instrumentAfter_();                                                                                                    \
  } while (false)
#endif

#if QUINTET_INSTRUMENT_KIND >= 2 && QUINTET_INSTRUMENT_KIND <= 4
uint instrumentFlags_ = 0u;  // of the ray, as the program traces it
#endif

// Returns whether the code of the program runs.
bool instrumentBegin_() {
  const uint pixel = instrumentPixel_();
#if QUINTET_INSTRUMENT_KIND == 0
  instrument_.pixels[pixel].depth = 0u;
#elif QUINTET_INSTRUMENT_KIND == 1
  instrumentSelfHit_();
  if ((instrument_.pixels[pixel].flags & gl_RayFlagsSkipClosestHitShaderEXT) != 0u) return false;
  instrumentKeepHit_();
#elif QUINTET_INSTRUMENT_KIND == 2
  atomicAdd(instrument_.value.anyHitCount, 1u);
  atomicMax(instrument_.value.mostAnyHits, ++instrument_.pixels[pixel].anyHits);
#endif
#if QUINTET_INSTRUMENT_KIND >= 2 && QUINTET_INSTRUMENT_KIND <= 4
  instrumentFlags_ = gl_IncomingRayFlagsEXT | (instrument_.pixels[pixel].flags & gl_RayFlagsSkipClosestHitShaderEXT);
#define gl_IncomingRayFlagsEXT instrumentFlags_
#endif
  return true;
}

#define main instrumentedMain_

#endif

// SPDX-License-Identifier: Apache-2.0
// Counts for heat maps. program::addProbes inserts this file before each stage that can trace or that it counts, and calls
// heatBegin_ and heatEnd_ around its main(). It defines QUINTET_HEAT_KIND (0 ray generation, 1 any-hit, 2 intersection, 3
// closest hit or miss), and QUINTET_HEAT_STORES if the program accumulates. spirv::addTraceCalls adds the calls of
// heatTraceBegin_ and heatTraceEnd_ around each trace.
#ifndef QUINTET_HEAT_GLSL
#define QUINTET_HEAT_GLSL

#include "launch_pixel.glsl"
#include "shared/heat.h"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer HeatReference_ { HeatPixel at[]; };

uint heatIndex_() {
  const uvec2 film = launchPixel() - frame.filmOffset;
  return film.y * frame.filmWidth + film.x;
}
// Tiles can extend beyond the film.
bool heatActive_() {
  const uvec2 film = launchPixel() - frame.filmOffset;
  return film.x < frame.filmWidth && film.y < frame.filmHeight;
}
#define heat_ HeatReference_(frame.heat).at[heatIndex_()]

// `flags` and `mask`: of the trace. With mask 0 it is no ray, because it sees no instance: invocations that need no ray trace
// together with the others. Const parameters are values, not pointers, in SPIR-V.
void heatTraceBegin_(const uint flags, const uint mask) {
  if (!heatActive_()) return;
  const uint depth = ++heat_.depth;
  if ((mask & 0xFFu) == 0u) return;
  heat_.rays++;
  if ((flags & gl_RayFlagsSkipClosestHitShaderEXT) == 0u) heat_.bounces++;
  heat_.deepest = max(heat_.deepest, depth);
}
void heatTraceEnd_() {
  if (heatActive_()) heat_.depth--;
}
// The new main() calls this function, so that the compiler keeps the others. spirv::addTraceCalls removes the call.
void heatKeep_() {
  heatTraceBegin_(0u, 0u);
  heatTraceEnd_();
}

#if QUINTET_HEAT_KIND == 0
#include <quintet/generated/program.glsl>

#ifdef QUINTET_OUTPUT_heat_time
#extension GL_ARB_shader_clock : require
uvec2 heatStart_ = uvec2(0u);
#endif

void heatOutput_(uint slot, float value) {
  if (frame.outputs[slot] == 0ul) return;
#ifdef QUINTET_HEAT_STORES
  OutputArray(frame.outputs[slot]).at[outputIndex(launchPixel())] = vec4(vec3(value), 1.0);
#else
  OutputArray(frame.outputs[slot]).at[outputIndex(launchPixel())] += vec4(vec3(value), 1.0);
#endif
}

void heatBegin_() {
  if (heatActive_()) heat_ = HeatPixel(0u, 0u, 0u, 0u, 0u, 0u);
#ifdef QUINTET_OUTPUT_heat_time
  heatStart_ = clock2x32ARB();
#endif
}

void heatEnd_() {
#ifdef QUINTET_OUTPUT_heat_time
  const uint64_t ticks = packUint2x32(clock2x32ARB()) - packUint2x32(heatStart_);
#endif
  if (!heatActive_() || !launchActive(launchPixel())) return;
#ifdef QUINTET_OUTPUT_heat_time
  heatOutput_(kOutput_heat_time, float(ticks));
#endif
#ifdef QUINTET_OUTPUT_heat_rays
  heatOutput_(kOutput_heat_rays, float(heat_.rays));
#endif
#ifdef QUINTET_OUTPUT_heat_bounces
  heatOutput_(kOutput_heat_bounces, float(heat_.bounces));
#endif
#ifdef QUINTET_OUTPUT_heat_depth
  heatOutput_(kOutput_heat_depth, float(heat_.deepest));
#endif
#ifdef QUINTET_OUTPUT_heat_any_hit
  heatOutput_(kOutput_heat_any_hit, float(heat_.anyHits));
#endif
#ifdef QUINTET_OUTPUT_heat_intersection
  heatOutput_(kOutput_heat_intersection, float(heat_.intersections));
#endif
}
#else
void heatBegin_() {
#if QUINTET_HEAT_KIND == 1
  if (heatActive_()) heat_.anyHits++;
#elif QUINTET_HEAT_KIND == 2
  if (heatActive_()) heat_.intersections++;
#endif
}
void heatEnd_() {}
#endif

#undef heat_

#endif

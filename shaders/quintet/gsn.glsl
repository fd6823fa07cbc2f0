// SPDX-License-Identifier: Apache-2.0
// The predeclared names of the lecture form (docs/lecture-form.md): gsnSetPixel, gsnGetPositions, frameID, baryCoord, …
// src/program/gsn/stage.cpp defines QUINTET_GSN_… for a stage and inserts before it: this file, getters of the inputs,
// and gsn/names_end.glsl. Up to names_end, the names of the library are renamed, so that a program can use them for its
// own declarations. They are not renamed in a program that includes <quintet/…> itself (QUINTET_GSN_OPEN).
#ifndef QUINTET_GSN_GLSL
#define QUINTET_GSN_GLSL

#ifndef QUINTET_GSN_OPEN
#include "names_begin.glsl"
#endif
#include "frame.glsl"
#ifdef QUINTET_INSTRUMENT
#include "instrument.glsl"
#endif
#ifdef QUINTET_RECURSION
#include "recursion.glsl"
#endif
#ifdef QUINTET_PRINT
#include "print.glsl"
#endif
#ifdef QUINTET_VALUES
#include "values.glsl"
#endif
#ifdef QUINTET_HEAT
#include "heat.glsl"
#endif
#ifdef QUINTET_EXPLAIN
#include "explain.glsl"
#endif
#ifdef QUINTET_GSN_OPEN
#include "output.glsl"
#include "payload.glsl"
#ifdef QUINTET_GSN_HIT
#include "hit.glsl"
#endif
#endif

#ifdef QUINTET_GSN_TRACES
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
#endif

int frameID;    // index of the frame, from 0
int frameSize;  // number of frames of this run; 0 if unlimited

// Launch index and size as the program sees them: row 0 is the bottom of the image. Row 0 of the film is the top.
uvec3 gsnLaunchID_;
uvec3 gsnLaunchSize_;
uvec3 gsnLaunchID() { return gsnLaunchID_; }
uvec3 gsnLaunchSize() { return gsnLaunchSize_; }

#ifdef QUINTET_GSN_HIT
#include "gsn/hit_builtins.glsl"
#endif
#include "gsn/mesh.glsl"
#include "gsn/image.glsl"

#ifdef QUINTET_GSN_RAY_GENERATION
uint gsnPixelIndex_() {
  const uvec2 film = gl_LaunchIDEXT.xy + launch.offset - frame.filmOffset;
  return film.y * frame.filmWidth + film.x;
}
void gsnSetPixel(vec4 value) { OutputArray(frame.outputs[0]).at[gsnPixelIndex_()] = value; }
vec4 gsnGetPreviousPixel() {
  return frame.previousOutputs[0] != 0ul ? OutputArray(frame.previousOutputs[0]).at[gsnPixelIndex_()] : vec4(0.0);
}
#ifdef QUINTET_EXPLAIN
void gsnSetPixelAt_(vec4 value, uint line) {
  explainStore_(0u, launchPixel(), value, kExplainStored, line);
  gsnSetPixel(value);
}
#define gsnSetPixel(value_) gsnSetPixelAt_(value_, uint(__LINE__))
#endif
#endif

void gsnLoadBuiltIns_() {
  frameID = int(launch.firstSample);
  frameSize = int(frame.frameCount);
  const uvec2 pixel = gl_LaunchIDEXT.xy + launch.offset;
  gsnLaunchID_ = uvec3(pixel.x, frame.height - 1u - pixel.y, 0u);
  gsnLaunchSize_ = uvec3(frame.width, frame.height, 1u);
#ifdef QUINTET_GSN_HIT
  gsnLoadHit_();
#endif
}

#endif

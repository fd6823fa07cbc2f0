// The names of the lecture form (docs/lecture-form.md): gsnSetPixel, gsnGetPositions, frameID, baryCoord, … The
// splitter (src/program/lecture.cpp) puts before a stage: this file, getters of the inputs, gsn/names_end.glsl.
// It defines QUINTET_GSN_… for the stage. The library's own names are renamed until names_end, so that a program
// may use them for its own things; a program that includes <quintet/…> itself sees them (QUINTET_GSN_OPEN).
#ifndef QUINTET_GSN_GLSL
#define QUINTET_GSN_GLSL

#ifndef QUINTET_GSN_OPEN
#include "gsn/names_begin.glsl"
#endif
#include "frame.glsl"
#ifdef QUINTET_INSTRUMENT
#include "instrument.glsl"
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
int frameSize;  // frames of this run; 0: it has no end

// Row 0 is the bottom of the picture for the program; films begin at the top.
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

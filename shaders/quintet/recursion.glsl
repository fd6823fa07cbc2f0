// SPDX-License-Identifier: Apache-2.0
// Counts the depth of nested traces and skips those for which the pipeline has no stack. program::instrumentStage inserts
// this file before each stage that can trace, if the traces of the program form a cycle, and defines
// QUINTET_RECURSION_START in the ray generation shader. A macro replaces traceRayEXT.
#ifndef QUINTET_RECURSION_GLSL
#define QUINTET_RECURSION_GLSL

#include "frame.glsl"
#include "shared/instrument.h"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer RecursionReference {
  RecursionGuard guard;
  uint depth[];  // active traces, by invocation
};

uint recursionSlot_() {
  const uint row = gl_LaunchIDEXT.y + launch.offset.y - (launch.tiles == 0ul ? frame.filmOffset.y : 0u);
  return row * gl_LaunchSizeEXT.x + gl_LaunchIDEXT.x;
}

// Returns false if the trace must not run. `above` becomes the number of traces around it.
bool recursionEnter_(out uint above) {
  RecursionReference recursion = RecursionReference(frame.instrument);
#ifdef QUINTET_RECURSION_START
  above = 0u;
#else
  above = recursion.depth[recursionSlot_()];
  if (above >= recursion.guard.depthLimit) {
    atomicAdd(recursion.guard.cutCount, 1u);
    return false;
  }
#endif
  recursion.depth[recursionSlot_()] = above + 1u;
  return true;
}

void recursionLeave_(uint above) {
#ifndef QUINTET_RECURSION_START
  RecursionReference(frame.instrument).depth[recursionSlot_()] = above;
#endif
}

#define traceRayEXT(as_, flags_, mask_, offset_, stride_, miss_, origin_, tmin_, direction_, tmax_, location_)        \
  do {                                                                                                               \
    uint recursionAbove_;                                                                                            \
    if (recursionEnter_(recursionAbove_)) {                                                                          \
      traceRayEXT(as_, flags_, mask_, offset_, stride_, miss_, origin_, tmin_, direction_, tmax_, location_);        \
      recursionLeave_(recursionAbove_);                                                                              \
    }                                                                                                                \
  } while (false)

#endif

// SPDX-License-Identifier: Apache-2.0
// What the instrumented variant of a program counts for its heat maps (quintet/heat.glsl): an array at Frame::heat, one
// element per pixel of the film. The ray generation shader resets the element and adds it to the outputs, or stores it there
// if the program accumulates.
#ifndef QUINTET_SHARED_HEAT_H
#define QUINTET_SHARED_HEAT_H

#include "types.h"

QT_SHARED_BEGIN

struct HeatPixel {
  uint rays;           // traces
  uint bounces;        // traces that can run a closest-hit shader
  uint depth;          // nesting depth of active traces
  uint deepest;        // maximum of it
  uint anyHits;        // any-hit shader calls
  uint intersections;  // intersection shader calls
};
QT_SHARED_SIZE(HeatPixel, 24);

QT_SHARED_END

#endif

// SPDX-License-Identifier: Apache-2.0
// Data that an instrumented program (quintet check --instrument) writes at Frame::instrument: one Instrument, then
// kInstrumentReports InstrumentReports, then one InstrumentPixel per pixel of the film. Other programs whose traces form
// a cycle have a RecursionGuard there, and behind it one uint per invocation of a launch.
#ifndef QUINTET_SHARED_INSTRUMENT_H
#define QUINTET_SHARED_INSTRUMENT_H

#include "types.h"

QT_SHARED_BEGIN

// InstrumentReport::kind: the number of the diagnostic.
QT_CONSTANT kReportRay = 1u;      // Q001: origin, direction, tmin or tmax not finite, or direction 0
QT_CONSTANT kReportDepth = 3u;    // Q003: a trace deeper than the pipeline's recursion depth (not executed)
QT_CONSTANT kReportMiss = 4u;     // Q004: a miss index beyond the table (the trace is not executed)
QT_CONSTANT kReportRecord = 36u;  // Q004 (modulo 16): a hit record beyond the table (the trace is not executed)
QT_CONSTANT kReportSelfHit = 5u;  // Q005: a hit on the primitive just left, closer than the rounding error
QT_CONSTANT kReportOutput = 7u;   // Q007: an output or a pixel outside of the film (not stored)
QT_CONSTANT kReportCall = 20u;    // Q004 (modulo 16): a callable index beyond the table (the call is not executed)

QT_CONSTANT kInstrumentReports = 64u;  // maximum stored; further reports are only counted

struct InstrumentReport {
  uint kind;
  uint stage;   // index of the compiled stage
  uint line;    // of the trace, in the stage's file or an included file; 0: not at a trace
  uint depth;   // nesting depth of traces; 1: called by the ray generation shader
  uvec2 pixel;
  float distance;  // Q005
  uint index;   // Q004: of the miss or callable shader, or offset + 16 · stride of the hit records; Q007: of the output
  vec3 origin;  // Q007: the pixel, relative to the film; negative values are too large as unsigned numbers
  vec3 direction;
  vec2 interval;  // tmin, tmax of a trace
};
QT_SHARED_SIZE(InstrumentReport, 64);

struct Instrument {
  uint reportCount;    // all, stored or not
  uint traceCount;
  uint anyHitCount;
  uint mostAnyHits;    // maximum over the pixels
  uint deepest;        // maximum nesting depth of traces
  uint pixelCount;
  uint missCount;      // in: number of miss shaders in the table
  uint callableCount;  // in: number of callable shaders in the table
  uint outputCount;    // in: number of outputs of the program
  uint depthLimit;     // in: recursion depth of the pipeline
  uint rays[16];        // executed traces by offset (modulo 16): by ray type
  uint recordPairs[8];  // bit offset + 16 · stride: of a report Q004 (both taken modulo 16, as Vulkan does)
  // in: for each of these pairs 8 bits, 4 pairs in a word: the masks of the instances for which the pair selects a hit
  // record beyond the table
  uint badRecords[64];
};
QT_SHARED_SIZE(Instrument, 392);

// The depth of the nested traces of each invocation follows.
struct RecursionGuard {
  uint cutCount;  // traces that were not executed
};
QT_SHARED_SIZE(RecursionGuard, 4);

struct InstrumentPixel {
  uint depth;      // nesting depth of active traces
  uint anyHits;
  uint instance;   // of the previous closest hit, + 1; 0: none
  uint geometry;
  uint primitive;
  uint flags;      // of the latest trace
  uint stage;      // that called it
  uint line;
};
QT_SHARED_SIZE(InstrumentPixel, 32);

QT_SHARED_END

#endif

// What an instrumented program (quintet check --instrument) writes at Frame::instrument: one Instrument, then
// kInstrumentReports InstrumentReport, then one InstrumentPixel per pixel of the film.
#ifndef QUINTET_SHARED_INSTRUMENT_H
#define QUINTET_SHARED_INSTRUMENT_H

#include "types.h"

QT_SHARED_BEGIN

// InstrumentReport::kind: what was wrong, by the digits of its diagnostic.
QT_CONSTANT kReportRay = 1u;      // Q001: origin, direction, tmin or tmax not finite, or no direction
QT_CONSTANT kReportDepth = 3u;    // Q003: a trace deeper than the pipeline was made for (not executed)
QT_CONSTANT kReportMiss = 4u;     // Q004: a miss index beyond the table (the trace is not executed)
QT_CONSTANT kReportSelfHit = 5u;  // Q005: a hit on the primitive just left, closer than the rounding error

QT_CONSTANT kInstrumentReports = 64u;  // kept; the others are only counted

struct InstrumentReport {
  uint kind;
  uint stage;   // index of the compiled stage
  uint line;    // of the trace in that stage's file or in what it includes; 0: not at a trace
  uint depth;   // of nested traces there; 1: by the ray generation shader
  uvec2 pixel;
  float distance;  // Q005
  uint index;   // Q004: of the miss shader
  vec3 origin;
  vec3 direction;
};
QT_SHARED_SIZE(InstrumentReport, 56);

struct Instrument {
  uint reportCount;    // all, kept or not
  uint traceCount;
  uint anyHitCount;
  uint mostAnyHits;    // of one pixel
  uint deepest;        // nested traces
  uint pixelCount;
  uint missCount;      // in: miss shaders of the table
  uint depthLimit;     // in: of the pipeline
  uint recordPairs[8];  // bit offset + 16 · stride: used by a trace (both taken modulo 16, as Vulkan does)
};
QT_SHARED_SIZE(Instrument, 64);

struct InstrumentPixel {
  uint depth;      // of the traces that are running
  uint anyHits;
  uint instance;   // of the closest hit before, + 1; 0: none
  uint geometry;
  uint primitive;
};
QT_SHARED_SIZE(InstrumentPixel, 20);

QT_SHARED_END

#endif

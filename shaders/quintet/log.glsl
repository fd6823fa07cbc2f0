// SPDX-License-Identifier: Apache-2.0
// Appends records to the shader log (shared/log.h), in every ray tracing stage. Instrumented variants of a program
// include this file; other programs have no log. While there is one, each launch takes one sample.
//
//   uint at = logBegin_(kLogRay, 2u);   // kind, number of words
//   logWord_(at, first);
//   logWord_(at, second);
#ifndef QUINTET_LOG_GLSL
#define QUINTET_LOG_GLSL

#include "launch_pixel.glsl"
#include "shared/log.h"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer LogReference_ {
  LogHeader header;
  uint words[];
};

#define log_ LogReference_(frame.log)

const uint kLogNone_ = 0xFFFFFFFFu;

// True if the log takes records of this pixel.
bool logEnabled_() {
  if (frame.log == 0ul) return false;
  const uvec2 pixel = launchPixel();
  return all(greaterThanEqual(pixel, log_.header.firstPixel)) && all(lessThan(pixel, log_.header.endPixel));
}

// Begins a record with `wordCount` words of data; all of them must be stored. Returns the position of the first word, or
// kLogNone_ if the log does not take the record. The functions below then store nothing.
uint logBegin_(uint kind, uint wordCount) {
  if (!logEnabled_()) return kLogNone_;
  const uint size = kLogRecordWords + wordCount;
  // The first test prevents an overflow of `used`.
  uint at = log_.header.used < log_.header.capacity ? atomicAdd(log_.header.used, size) : log_.header.capacity;
  if (at + size > log_.header.capacity) {
    if (at < log_.header.capacity) log_.words[at] = kLogEnd;
    atomicAdd(log_.header.dropped, 1u);
    return kLogNone_;
  }
  const uvec2 pixel = launchPixel();
  log_.words[at++] = kind;
  log_.words[at++] = wordCount;
  log_.words[at++] = pixel.x;
  log_.words[at++] = pixel.y;
  log_.words[at++] = launch.firstSample;
  return at;
}

// Stores a word at the position `at` and advances it.
void logWord_(inout uint at, uint word) {
  if (at != kLogNone_) log_.words[at++] = word;
}

#undef log_

#endif

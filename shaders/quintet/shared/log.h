// SPDX-License-Identifier: Apache-2.0
// The shader log: records of words that shaders append to one buffer (quintet/log.glsl). The buffer at Frame::log is one
// LogHeader and then `capacity` words. A record is a LogRecord and then its data words.
#ifndef QUINTET_SHARED_LOG_H
#define QUINTET_SHARED_LOG_H

#include "types.h"

QT_SHARED_BEGIN

// LogRecord::kind
QT_CONSTANT kLogEnd = 0u;    // no further record: the next one did not fit
QT_CONSTANT kLogPrint = 1u;  // debugPrintfEXT: number of the call, then the words of its arguments
QT_CONSTANT kLogValue = 2u;  // number of an operation whose result is not finite; 1: NaN, 0: infinite (values.glsl)

struct LogHeader {
  uint capacity;     // in: words after this header
  uint used;         // words of the records so far; larger than the capacity if a record did not fit
  uint dropped;      // records that did not fit
  uint state;        // for the shaders that write records, if the log takes those of one invocation only
  uvec2 firstPixel;  // in: only invocations for the pixels [firstPixel, endPixel) of the image write records
  uvec2 endPixel;
};
QT_SHARED_SIZE(LogHeader, 32);

struct LogRecord {
  uint kind;         // kLog…
  uint wordCount;    // data words after this struct
  uvec2 pixel;       // of the image
  uint sampleIndex;  // of the pixel, or index of the frame if the program accumulates
};
QT_SHARED_SIZE(LogRecord, 20);

QT_CONSTANT kLogRecordWords = 5u;  // of a LogRecord

QT_SHARED_END

#endif

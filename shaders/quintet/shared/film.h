// SPDX-License-Identifier: Apache-2.0
// Memory layout of the film, and push constants of its passes (see src/render/film/film.h).
#ifndef QUINTET_SHARED_FILM_H
#define QUINTET_SHARED_FILM_H

#include "frame.h"
#include "pass.h"

QT_SHARED_BEGIN

// A sum that does not depend on the order of its terms: a signed integer of 128 bits in units of 2^-64, two's complement,
// lowest word first. The most negative value means that a term was not finite; adding to it does not change it.
struct FixedSum {
  uint word[4];
};
QT_SHARED_SIZE(FixedSum, 16);
QT_CONSTANT kNotFiniteWord = 0x80000000u;  // word[3] of that value

// A batch of pixels, or of tiles with kTileSize² values for each tile; see quintet/passes/batch_pixel.glsl.
struct FilmBatch {
  Address tiles;         // FilmTile[count / kTileSize²], no tile twice; 0: value i belongs to pixel i
  uint count;            // values
  uint width;            // of the film in pixels, for tiles
  uint height;
  float inverseSamples;  // 1 / samples of the batch
};
QT_SHARED_SIZE(FilmBatch, 24);

// Push constants of the pass that adds the sums of a batch to the totals.
struct FilmAdd {
  Address total;    // FixedSum[4 · pixels]: += value
  Address squares;  // FixedSum[4 · pixels]: += value² · inverseSamples; 0: not kept
  Address values;   // vec4[batch.count]
  FilmBatch batch;
};
QT_SHARED_SIZE(FilmAdd, 48);

// Push constants of the pass that divides the totals by the number of samples.
struct FilmMean {
  Address total;         // FixedSum[4 · count]
  Address mean;          // vec4[count]
  uint count;            // pixels
  float inverseSamples;  // 1 / samples of a pixel
};
QT_SHARED_SIZE(FilmMean, 24);

// An id and the number of samples that hit it. 0 samples: an empty slot.
struct CoverageSlot {
  uint id;
  uint samples;
};
QT_SHARED_SIZE(CoverageSlot, 8);
QT_CONSTANT kCoverageSlots = 12u;  // per pixel, sorted by id; if there are more ids, the smallest are kept

// Push constants of the pass that counts the ids of a batch.
struct FilmCoverage {
  Address total;    // CoverageSlot[kCoverageSlots · pixels]
  Address values;   // uint[kBatchSamples · batch.count]; 0: no hit
  FilmBatch batch;
};
QT_SHARED_SIZE(FilmCoverage, 40);

// Push constants of the pass that replaces the total by a frame, if the program accumulates.
struct FilmFrame {
  Address total;  // vec4[count]
  Address batch;  // vec4[count]
  Address marks;  // uint[count]: |= mark in the pixels that are not finite
  uint count;     // pixels
  uint mark;
};
QT_SHARED_SIZE(FilmFrame, 32);

// Pixels of an output with a channel that is not finite.
struct NotFinite {
  uint count;
  uint first;  // smallest index of such a pixel, row by row from the top; 0xFFFFFFFF: none
};
QT_SHARED_SIZE(NotFinite, 8);

// Push constants of the pass that finds them.
struct FilmCheck {
  Address values;  // FixedSum[4 · count], vec4[count], or marks of FilmFrame
  Address result;  // NotFinite
  uint count;      // pixels
  uint sums;       // 1: `values` are sums
  uint mark;       // not 0: `values` are marks, of which this one counts
  uint padding;
};
QT_SHARED_SIZE(FilmCheck, 32);

QT_SHARED_END

#endif

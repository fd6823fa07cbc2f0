// SPDX-License-Identifier: Apache-2.0
// Writes results. If the film averages (the default), an output is the sum over the samples of a batch; the film
// divides later. A program loads the sum, adds its samples one by one in sample order, and stores the sum. The result
// then does not depend on the number of samples per launch, bit for bit.
#ifndef QUINTET_OUTPUT_GLSL
#define QUINTET_OUTPUT_GLSL

#include "frame.glsl"
#include "launch_pixel.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer StatisticsArray { uint at[]; };  // Frame::statistics

// The index of a pixel in the arrays of the film; for outputs, see outputIndex().
uint pixelIndex(uvec2 pixel) {
  const uvec2 film = pixel - frame.filmOffset;
  return film.y * frame.filmWidth + film.x;
}

// True if the output exists and is rendered, and the pixel is inside the film. The functions below ignore anything else.
bool holdsPixel(uint slot, uvec2 pixel) {
  const uvec2 film = pixel - frame.filmOffset;
  return slot < kMaxOutputs && film.x < frame.filmWidth && film.y < frame.filmHeight && frame.outputs[slot] != 0ul;
}

// `slot`: kOutput_… of the generated program constants.
vec4 loadOutput(uint slot, uvec2 pixel) {
  return holdsPixel(slot, pixel) ? OutputArray(frame.outputs[slot]).at[outputIndex(pixel)] : vec4(0.0);
}
void storeOutput(uint slot, uvec2 pixel, vec4 sum) {
  if (holdsPixel(slot, pixel)) OutputArray(frame.outputs[slot]).at[outputIndex(pixel)] = sum;
}
void addOutput(uint slot, uvec2 pixel, vec4 sample_) {
  if (holdsPixel(slot, pixel)) OutputArray(frame.outputs[slot]).at[outputIndex(pixel)] += sample_;
}
// For an output that counts ids (pixel = "coverage"): stores the id that sample `index` of the pixel has hit; 0: no
// hit.
void storeCoverage(uint slot, uvec2 pixel, uint index, uint id) {
  if (holdsPixel(slot, pixel))
    OutputArray(frame.outputs[slot]).at[outputIndex(pixel)][index % kBatchSamples] = uintBitsToFloat(id);
}

#ifdef QUINTET_INSTRUMENT
// Checked, with the line of the call (Q007).
void storeOutputAt_(uint slot, uvec2 pixel, vec4 sum, uint line) {
  if (instrumentOutput_(slot, pixel, line)) storeOutput(slot, pixel, sum);
}
void addOutputAt_(uint slot, uvec2 pixel, vec4 sample_, uint line) {
  if (instrumentOutput_(slot, pixel, line)) addOutput(slot, pixel, sample_);
}
#define storeOutput(slot_, pixel_, sum_) storeOutputAt_(slot_, pixel_, sum_, uint(__LINE__))
#define addOutput(slot_, pixel_, sample_) addOutputAt_(slot_, pixel_, sample_, uint(__LINE__))
#endif

#ifdef QUINTET_EXPLAIN_GLSL
// Logged, with the line of the call (quintet/explain.glsl).
void storeOutputAt_(uint slot, uvec2 pixel, vec4 sum, uint line) {
  explainStore_(slot, pixel, sum, kExplainStored, line);
  storeOutput(slot, pixel, sum);
}
void addOutputAt_(uint slot, uvec2 pixel, vec4 sample_, uint line) {
  explainStore_(slot, pixel, sample_, kExplainAdded, line);
  addOutput(slot, pixel, sample_);
}
void storeCoverageAt_(uint slot, uvec2 pixel, uint index, uint id, uint line) {
  explainStore_(slot, pixel, vec4(uintBitsToFloat(id), 0.0, 0.0, 0.0), kExplainCoverage, line);
  storeCoverage(slot, pixel, index, id);
}
#define storeOutput(slot_, pixel_, sum_) storeOutputAt_(slot_, pixel_, sum_, uint(__LINE__))
#define addOutput(slot_, pixel_, sample_) addOutputAt_(slot_, pixel_, sample_, uint(__LINE__))
#define storeCoverage(slot_, pixel_, index_, id_) storeCoverageAt_(slot_, pixel_, index_, id_, uint(__LINE__))
#endif

// For a program that averages by itself (accumulation = "program"): the index of the frame, and the value that the
// previous frame stored. That value is 0 in the first frame, and always 0 if the film averages.
uint launchFrame() { return launch.firstSample; }
vec4 loadPrevious(uint slot, uvec2 pixel) {
  if (!holdsPixel(slot, pixel)) return vec4(0.0);
  const Address previous = frame.previousOutputs[slot];
  return previous != 0ul ? OutputArray(previous).at[pixelIndex(pixel)] : vec4(0.0);
}

// Programs discard and count non-finite samples; `quintet render` reports their number.
bool isFinite(vec4 value) { return !(any(isnan(value)) || any(isinf(value))); }

// Adds to this pixel's counters: rays traced, samples discarded. Atomic, because several batches of a pixel can run at the same
// time.
void countRays(uvec2 pixel, uint rays, uint dropped) {
  const uvec2 film = pixel - frame.filmOffset;
  if (frame.statistics == 0ul || film.x >= frame.filmWidth || film.y >= frame.filmHeight) return;
  StatisticsArray statistics = StatisticsArray(frame.statistics);
  const uint first = 2u * pixelIndex(pixel);
  atomicAdd(statistics.at[first], rays);
  if (dropped > 0u) atomicAdd(statistics.at[first + 1u], dropped);
}

#endif

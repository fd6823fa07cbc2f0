// SPDX-License-Identifier: Apache-2.0
// Finds samples that are not finite and fireflies, by rendering each sample of all pixels alone, and explains them.
#ifndef QUINTET_JOB_SAMPLE_SEARCH_H
#define QUINTET_JOB_SAMPLE_SEARCH_H

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "job/engine.h"
#include "job/observer.h"
#include "job/pixel_explanation.h"
#include "job/render_job.h"

namespace quintet::job {

struct SearchOptions {
  bool notFinite = true;
  // Unset means if they can be found: not in programs that accumulate, and not with fewer than 4 samples per pixel.
  std::optional<bool> fireflies;
  // Fireflies: how much brighter than its surroundings one sample makes a pixel (BrightestSamples::find); above 0.
  float threshold = 2.0f;
  std::size_t limit = 10;  // of explained groups of each kind; the others are only counted
  // Per pixel, or frames; 1 to kMaxSample + 1. Unset means those of the request: RenderLimits::samples, which also decides their values.
  std::optional<std::uint64_t> samples{};
};

// The event of a sample that explains its value. Empty texts and -1 mean unknown: only programs that use the GLSL library
// state them.
struct SampleCause {
  std::int64_t bounce = -1;   // scattering events before it
  std::string lobe;           // of the latest sample of the BSDF; for light samples, of that before their surface
  std::string material;       // of the latest surface
  std::string instance;       // of the latest closest hit with a shader
  std::string event;          // "contribution", "bsdf", …
  std::string field;          // of the event, that is not finite; empty for fireflies
  std::string lobeMaterial;   // of the surface at which the lobe was sampled
  bool lobeIsBefore = false;  // by the lobe, the path has reached the latest surface from the one before
  std::optional<ValueOrigin> origin{};  // PixelExplanation::origin
};

// The first sample, or the brightest firefly, of a group of adjacent pixels.
struct FoundSample {
  uvec2 pixel{0};            // of the whole image
  std::uint32_t sample = 0;  // or frame
  uvec2 least{0}, most{0};   // of the pixels of the group
  std::uint64_t groupPixels = 1, groupSamples = 1;
  vec3 value{0.0f};     // the sum of the contributions
  float luminance = 0;  // fireflies: of the sample
  float level = 0;      // fireflies: typical luminance of the surroundings
  SampleCause cause;
};

struct SearchResult {
  std::vector<FoundSample> notFinite;                  // by sample, then row by row; at most SearchOptions::limit
  std::vector<FoundSample> fireflies;                  // brightest first; at most SearchOptions::limit
  std::uint64_t notFiniteCount = 0, fireflyCount = 0;  // all samples; of fireflies one per pixel
  std::uint64_t notFiniteGroups = 0, fireflyGroups = 0;
  std::uint64_t samples = 0;  // searched, per pixel; or frames
  bool frames = false;        // the program accumulates: samples are frames
  bool interrupted = false;   // the observer stopped; not all is searched or explained
};

// Returns the cause: the first event with a value that is not finite, or the brightest contribution. An infinite tmax of a
// ray is no cause.
SampleCause causeOf(const PixelExplanation& explanation, bool notFinite);

// Searches all samples of the request (RenderLimits::samples), or all frames, and explains those that it lists. The search
// needs exclusive use of `job`. In programs that accumulate, a pixel that is not finite is found in its first frame. If the
// observer stops during the search, what was found is explained; if it stops later, the rest is not listed. Throws
// UsageError if the number of samples is unknown or out of range, or if the fireflies that SearchOptions requests cannot be found, and for
// the frame (RenderJob::showRequestedFrame); ProgramError and gpu errors.
SearchResult searchSamples(Engine& engine, RenderJob& job, const SearchOptions& options, Observer& observer);

}  // namespace quintet::job
#endif

// SPDX-License-Identifier: Apache-2.0
// Why a sample of a pixel has its value: the tree of its rays, hits and contributions; and the search for samples that are
// not finite or much too bright. Renderer::explain() and Renderer::search() return these.
#ifndef QUINTET_EXPLANATION_H
#define QUINTET_EXPLANATION_H

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <quintet/types.h>

namespace quintet {

// What a shader printed for a pixel.
struct PrintedLine {
  std::uint32_t x = 0, y = 0;             // pixel of the whole image
  std::optional<std::uint32_t> frame{};   // of an animation, or of a program that accumulates
  std::optional<std::uint32_t> sample{};  // of the pixel, unless the program accumulates
  std::string file{};                     // of the debugPrintfEXT
  int line = 0;
  std::string text{};
};

// A field of an event. Vectors of floats are positions, directions, colors and texture coordinates.
using EventValue = std::variant<bool, std::int64_t, float, std::string, std::vector<float>, std::vector<std::int64_t>>;

// Something that the program did for the sample, with what it caused: the events below a ray are those of the shaders that
// it called. Lengths are meters, positions and directions are in world space, radiance is linear Rec. 709, and indices are
// those of the scene. The types, with their most important fields:
//   ray            rayType, origin, tmin, direction, tmax (float), result: "hit", "miss" or "not traced"
//   payload, data  when: "before" or "after"; each member of the payload or callable data under its GLSL name
//   closest-hit, hit, any-hit, intersection   instance, geometry, primitive (integers), instanceName, material, t
//   surface        position, geometricNormal, shadingNormal, uv, material
//   light, bsdf    direction, pdf, misWeight; lobe or light (strings), throughput or weight
//   emission, contribution, store   source (string); radiance or value
// docs/explain-pixel.md lists all of them. Programs that do not use the GLSL library have only those of rays and
// shaders.
struct Event {
  std::string type{};  // "ray", "closest-hit", "light", "contribution", …
  std::vector<std::pair<std::string, EventValue>> fields{};
  std::vector<Event> children{};

  // Returns the field of this name, or null if the event has none.
  const EventValue* find(std::string_view name) const {
    for (const auto& [field, value] : fields)
      if (field == name) return &value;
    return nullptr;
  }
  // Returns the field of this name, or null if the event has none or if it has another type.
  template <class T>
  const T* get(std::string_view name) const {
    const EventValue* value = find(name);
    return value ? std::get_if<T>(value) : nullptr;
  }
};

// An output of the program after the sample, for this sample alone: the value that the sample added, or the value of the
// pixel if the program accumulates.
struct ExplainedOutput {
  std::string name{};
  Float4 value{};     // of the program as it renders images
  Float4 recorded{};  // of the variant of the program that recorded the events; the same up to rounding
};

// A part of the value of the first output: light that reached the pixel along one path, or a store of a program that does
// not state contributions.
struct Contribution {
  Float3 value{};
  std::string source{};           // "background", "surface", "light sample", "store"
  std::int64_t scatterings = -1;  // of the path between the camera and the light; -1 if unknown
};

// Why a sample of a pixel has its value.
struct Explanation {
  std::uint32_t x = 0, y = 0;  // pixel of the whole image, from the top left
  std::uint32_t sample = 0;    // of the pixel, from 0
  bool frames = false;         // the program accumulates: `sample` is a frame
  std::vector<ExplainedOutput> outputs{};
  std::vector<Event> events{};                // in the order of the program
  std::vector<Contribution> contributions{};  // their sum is the value of the first output
  bool discarded = false;                     // the program discarded the sample, because its value is not finite
  std::uint32_t lostEvents = 0;               // records that the device could not store
  std::vector<PrintedLine> printed{};         // of this sample (debugPrintfEXT); at most Settings::printLimit
  std::uint64_t omittedPrints = 0;            // beyond the limit, or more than the device could store
  std::string text{};                         // the tree as `quintet explain-pixel` prints it, 100 columns wide
  std::string json{};                         // one JSON object, as `quintet explain-pixel --json` prints it
};

// What Renderer::search() looks for.
struct SearchSettings {
  // Per pixel, or frames of a program that accumulates; 1 to 2^24, at least 4 for fireflies.
  std::uint32_t samples = 64;
  bool notFinite = true;  // samples with NaN or infinity
  // Samples that alone make their pixel much brighter than its surroundings. No effect in programs that accumulate.
  bool fireflies = true;
  float threshold = 2;     // of fireflies: how many times as bright, above 0
  std::size_t limit = 10;  // of groups of each kind to explain; the others are only counted
};

// A sample that Renderer::search() found, and the event that caused its value. It is the first one, or the brightest
// firefly, of a group of pixels that touch each other. Empty strings and -1 mean unknown: only
// programs that use the GLSL library state bounce, lobe and material.
struct FoundSample {
  std::uint32_t x = 0, y = 0;  // pixel of the whole image, from the top left
  std::uint32_t sample = 0;    // or frame: an argument of Renderer::explain()
  Float3 value{};              // sum of its contributions
  float luminance = 0;         // fireflies: of the sample
  float level = 0;             // fireflies: typical luminance of the surroundings
  std::int64_t bounce = -1;    // scattering events before the cause
  std::string lobe{};          // by which the path reached the cause
  std::string material{};      // of the latest surface
  std::string instance{};      // of the latest hit
  std::string event{};         // type of the event
  std::string field{};         // of the event, that is not finite; empty for fireflies
  std::string lobeMaterial{};  // of the surface at which the lobe was sampled
  // Of the group: number of pixels, of samples that are not finite or fireflies, and the rectangle of the pixels.
  std::uint64_t pixels = 1, samples = 1;
  std::uint32_t firstX = 0, firstY = 0, lastX = 0, lastY = 0;
};

// What Renderer::search() found.
struct SearchReport {
  std::vector<FoundSample> notFinite{};  // by sample, then row by row; at most SearchSettings::limit
  std::vector<FoundSample> fireflies{};  // brightest first, one per pixel; at most SearchSettings::limit
  std::uint64_t notFiniteCount = 0;      // all
  std::uint64_t fireflyCount = 0;        // all
  std::uint64_t samples = 0;             // searched, per pixel; or frames
  // The progress function returned false: not all samples were searched, or not all that were found are listed.
  bool canceled = false;
};

}  // namespace quintet
#endif

// SPDX-License-Identifier: Apache-2.0
// Everything that an image, a film and --json say about how they were made. One table of fields gives each fact its
// names, says whether films must agree in it, and converts it to text and back.
#ifndef QUINTET_JOB_PROVENANCE_H
#define QUINTET_JOB_PROVENANCE_H

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "base/math.h"
#include "io/codec.h"
#include "render/film/film_file.h"

namespace quintet::job {

inline constexpr std::string_view kDeviceSeparator = "; ";  // in Provenance::device and driver
inline constexpr double kMaxExposure = 100.0;               // stops, in both directions

// A pixel of the whole image; (0, 0) is in the top left corner.
struct PixelPosition {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  bool operator==(const PixelPosition&) const = default;
};

struct Provenance {
  // Identity: equal for renders whose samples belong together.
  std::string version;    // of Quintet
  std::string sceneHash;  // 32 hex digits, as the other hashes
  std::string environmentHash;
  std::string program;      // name
  std::string programHash;  // of the program's files and of what they include from outside
  std::string libraryHash;  // of the shader library
  std::vector<std::pair<std::string, std::string>> parameterValues;  // name, JSON value or the hash of an image
  std::string projection;                                            // of the camera: "perspective, 0.7854 rad"
  std::string cameraPosition;                                        // world space, meters
  std::string cameraAxes;                                            // world space: x, y and z axis
  std::string lens;                                                  // aperture radius and focus distance, meters
  uvec2 size{0};                                                     // of the whole image, pixels
  render::Region region;                                             // rendered part of it
  std::uint64_t seed = 0;
  std::optional<std::uint64_t> plannedSamples;  // samplers distribute their points for this number; unset: unlimited
  bool adaptive = false;
  bool transparent = false;
  std::string shutter;  // ShutterRequest, in frames: "-0.25,0.25"; empty without one
  std::string outputs;  // of the program, those that the film stores: "color, albedo"

  // Notes: everything else that a film keeps for the images that are made of it.
  std::string commandLine;
  std::string scene;                      // path or name
  std::string environment;                // "sky.hdr", "default", "none", "of the scene"
  std::string camera;                     // "camera 0 'Main'", "automatic"
  std::optional<double> framesPerSecond;  // of an animated scene; else unset
  std::string parameters;                 // "bounces=12 clamp=0"
  std::string device;                     // kinds; several are separated by kDeviceSeparator
  std::string driver;
  double seconds = 0;       // wall clock of rendering; of an image of an animation, those of its frame
  double batchSeconds = 0;  // of the last batch
  std::optional<double> targetError;
  std::string limits;              // of the request: "64 samples, 60 s"; not stored
  std::optional<double> exposure;  // stops; unset for files of linear values
  std::string toneMap;             // empty for files of linear values; in a film empty means by the kind of output
  bool allOutputs = false;         // an image of each output
  std::string layers;              // JSON: layers of an OpenEXR file (output/layers.h); empty if none
  std::vector<std::string> instanceNames;  // for Cryptomatte: by index; empty if there are no such layers
  std::vector<std::string> materialNames;
  std::optional<mat4> worldToCamera;  // render::CameraMatrices; unset for programs with cameras of their own
  std::optional<mat4> worldToNdc;
  // Of the process, if it used several; the largest number of the parts that were merged.
  std::optional<std::uint64_t> deviceCount;
  std::string farmPlan;  // id of the plan that this render is a part of; empty if it is none

  // Result: known when rendering has ended; films have the counts themselves.
  std::string output;         // of the program, shown by an image
  std::uint64_t samples = 0;  // per pixel, an average if adaptive; or frames
  std::uint64_t rays = 0;
  std::uint64_t droppedSamples = 0;  // not finite
  std::optional<PixelPosition> firstDroppedSample;
  std::uint64_t notFinitePixels = 0;                 // of all stored outputs together
  std::optional<PixelPosition> firstNotFinitePixel;  // of the first output that has one
  std::optional<std::uint64_t> frame;                // of an animation
  bool interrupted = false;
  std::optional<double> error;      // stated relative error of the image; unset if unknown
  std::optional<double> tileError;  // 95 % of the tiles have a smaller one

  bool cropped() const { return region.width != size.x || region.height != size.y; }
};

// std::monostate: the fact is absent.
using FieldValue = std::variant<std::monostate, std::string, bool, std::uint64_t, double, uvec2, render::Region, mat4,
                                std::vector<std::string>, PixelPosition>;

struct ProvenanceField {
  enum class Role {
    identity,  // stored in films, which belong together only if they agree in it
    note,      // stored in films
    result,    // not stored
  };
  std::string_view name;         // in films and messages
  std::string_view jsonKey;      // in --json; empty if it is not listed there
  std::string_view metadataKey;  // text in PNG, string attribute in OpenEXR; empty if it is not written
  Role role = Role::identity;
  FieldValue (*get)(const Provenance&) = nullptr;
  // Throws UsageError for a text that get() cannot have given.
  void (*set)(Provenance&, const std::string& text) = nullptr;
  bool onlyIfSet = false;  // films do not store it if it is empty
};

// All fields but parameterValues, in the order in which they are shown.
std::span<const ProvenanceField> provenanceFields();

// "" if absent, "yes" or "no", "1280x720", "0,0,64,64", "34,120" for a pixel; a matrix as 16 numbers for row vectors; a list as JSON.
std::string toText(const FieldValue& value);

// The fields of a role, `parameterValues` among the identity as "parameter NAME".
render::FilmFacts toFacts(const Provenance& provenance, ProvenanceField::Role role);
// Reads identity and notes of a film. Throws UsageError that names the first fact with a wrong value.
Provenance fromFacts(const render::FilmFacts& identity, const render::FilmFacts& notes);

// (key, text) for PNG and OpenEXR. Absent and empty facts and "no" are omitted, and so are the region of a whole image and
// counts of zero dropped samples and pixels. Numbers have 6 significant digits.
io::Metadata metadataOf(const Provenance& provenance);

}  // namespace quintet::job
#endif

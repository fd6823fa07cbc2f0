// SPDX-License-Identifier: Apache-2.0
// What a front end asks for: plain data, without decisions that depend on the scene or the device. resolve() checks it.
#ifndef QUINTET_JOB_REQUEST_H
#define QUINTET_JOB_REQUEST_H

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/math.h"
#include "render/film/film_state.h"
#include "scene/load_options.h"
#include "scene/model/scene.h"

namespace quintet::job {

struct CameraRequest {
  std::string name;                     // index or name in the scene file; empty means the first camera
  std::optional<vec3> lookFrom;         // world space, meters; excludes `name`
  std::optional<vec3> lookAt;           // world space; default: the center of the scene. Requires lookFrom
  vec3 up{0, 1, 0};                     // world space, any length but 0
  std::optional<float> verticalFov;     // degrees, (0, 180); default: the camera's, or 45
  std::optional<float> apertureRadius;  // meters; default: the camera's, or 0 (pinhole)
  std::optional<float> focusDistance;   // meters along the optical axis
  bool operator==(const CameraRequest&) const = default;
};

struct EnvironmentRequest {
  // A file (equirectangular image), "none", "default", or "r,g,b" (constant radiance, linear Rec. 709). Empty means the
  // scene's environment, or the default one if the scene has no lights.
  std::string source;
  std::optional<float> intensity;  // factor
  std::optional<float> rotation;   // degrees about +y, counter-clockwise seen from above
  bool operator==(const EnvironmentRequest&) const = default;
};

// Rendering stops at the first limit that is reached. At least one is set.
struct RenderLimits {
  std::optional<std::uint64_t> samples;  // per pixel, on average if adaptive
  std::optional<double> seconds;         // wall clock of rendering
  std::optional<double> error;           // relative: render::ErrorEstimate::reaches
  bool adaptive = false;                 // distribute samples by the error of each tile
};

// Why a render stopped, unless it was interrupted.
enum class ReachedLimit {
  samples,  // or adaptive sampling found no pixel that requires more of them
  seconds,
  error,
  unknownError,  // the target error is the only limit, and the error can never be known (targetUnreachable())
};

struct FrameRequest {
  std::optional<std::uint32_t> count;  // of an animated scene or of a program that accumulates its own frames
  // Number of the first frame, if only a part of an animation is rendered; unset means the whole animation, from frame
  // 0.
  std::optional<std::uint32_t> first;
  // Time of the only frame, ≥ 0, instead of `first` and `count`: frame seconds · RenderRequest::framesPerSecond, which
  // can be between two frames.
  std::optional<double> seconds;
  // Number of frames for a program that accumulates, if `count` is unset; if both are, it runs until the time limit.
  std::optional<std::uint32_t> accumulated;
  bool every = false;  // an image of each frame, not only of the last one

  std::optional<std::uint32_t> accumulatedCount() const { return count ? count : accumulated; }
  // Of an animated scene, both ends included.
  std::uint32_t firstFrame() const { return first.value_or(0); }
  std::uint32_t lastFrame() const { return firstFrame() + count.value_or(1) - 1; }
};

// Motion blur: the shutter is open from frame + open to frame + close of each frame, or of FrameRequest::seconds. The unit is
// the frame, as in RenderMan and Blender, so that the blur in an image does not depend on where the animation begins, and
// 0.5 is the shutter angle 180° at any number of frames per second.
struct ShutterRequest {
  double open = 0;   // frames, [-kMaxShutter, kMaxShutter]
  double close = 0;  // frames, [open, kMaxShutter]; equal to `open` means an image without blur at frame + open
  bool operator==(const ShutterRequest&) const = default;
};
inline constexpr double kMaxShutter = 1000.0;

// Batches of render::kBatchSamples samples per pixel, both ends included, starting at 0.
struct BatchRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};

struct CheckpointRequest {
  std::filesystem::path file;  // .qfilm; empty disables checkpoints
  double seconds = 60.0;       // interval; 0 saves after every batch
  bool keep = false;           // leave a complete checkpoint behind when the images are written
  bool resume = false;         // continue from the checkpoint if it exists
  bool force = false;          // start over, and overwrite a checkpoint of a different render
  double waitSeconds = 10.0;   // for the end of a process that uses the file: one that was killed takes a moment
};

// What the program prints (debugPrintfEXT) goes to Observer::printed(). Without a request it is discarded, at no cost.
struct PrintRequest {
  // Pixels of the whole image whose invocations print. Width 0 means the pixel at the center of the rendered part, unless
  // `all` is set.
  render::Region pixels;
  bool all = false;           // all pixels of the rendered part, instead of `pixels`
  std::uint64_t limit = 200;  // lines until the next edit of the job; further ones are only counted
};

// How the images of this render are to be written. Stored in films, so that merging them writes the same images.
struct OutputNotes {
  double exposure = 0;      // stops
  std::string toneMap;      // empty means by the kind of output
  bool allOutputs = false;  // an image of each output
  std::string layers;       // of an OpenEXR file (output::layersText); empty if none
  bool names = false;       // keep the names of instances and materials, for Cryptomatte
};

struct RenderRequest {
  std::filesystem::path scene;                      // empty means the program's own scene, else the built-in one
  scene::LoadOptions load;                          // how `scene`, or the program's own scene, is read
  std::shared_ptr<const scene::Scene> loadedScene;  // instead of `scene`: one in host memory; may be null
  // Name or index of the glTF animation of `scene` that plays, or "none" for the rest pose. Empty means the first one
  // if `frames` asks for a frame or a time, with a shutter, or if the job is editable; else the rest pose.
  std::string animation;
  double framesPerSecond = scene::kDefaultFramesPerSecond;  // > 0; of glTF animations and FrameRequest::seconds
  bool editable = false;  // keep what the edits of RenderJob require; needs `loadedScene`
  CameraRequest camera;
  EnvironmentRequest environment;
  std::optional<Bounds3> bounds;  // that the automatic camera shows, also after edits; default: those of the scene
  uvec2 size{0};                  // pixels; a 0 is chosen by the camera's aspect ratio
  render::Region region;          // pixels from the top left; width 0 means the whole image
  bool transparent = false;       // alpha 0 where a camera ray leaves the scene, instead of the environment
  std::uint32_t seed = 0;         // of the random number generator
  std::vector<std::string> assignments;  // "name=value": parameters of the program, in this order
  std::filesystem::path parameterFile;   // JSON object of parameters, applied before `assignments`; may be empty
  std::vector<std::string> outputs;      // names of the program's optional outputs to render
  RenderLimits limits;
  FrameRequest frames;
  std::optional<ShutterRequest> shutter;  // of an animated scene; unset means that the scene stands still in each frame
  std::optional<BatchRange> batches;      // render only this part of limits.samples
  CheckpointRequest checkpoint;
  std::filesystem::path film;  // the film file (.qfilm) that will be written; empty if none
  bool overwriteFilm = false;  // allow to lose the samples that `film` holds
  double launchSeconds = 0;    // approximate duration of a launch; 0 means render::RenderSettings::launchSeconds
  double launchTimeout = 0;    // seconds after which a launch counts as hung; 0 means the default of the device
  std::optional<PrintRequest> print;
  OutputNotes outputNotes;
  std::string commandLine;  // for metadata; may be empty
  std::string farmPlan;     // id of the plan that the render is a part of, for films and metadata; may be empty
};

}  // namespace quintet::job
#endif

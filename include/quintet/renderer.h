// SPDX-License-Identifier: Apache-2.0
// Renders a scene with a program: to a number of samples, a time or an error, with progress and edits between renders.
#ifndef QUINTET_RENDERER_H
#define QUINTET_RENDERER_H

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <quintet/device.h>
#include <quintet/explanation.h>
#include <quintet/film.h>
#include <quintet/program.h>
#include <quintet/scene.h>

namespace quintet {

// A rectangle of pixels, measured from the top left corner.
struct Region {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
};

// Batches of 4 samples per pixel, both ends included, starting at 0. The renderer counts the samples of this part only: in
// Limits, RenderReport, Progress, render() and sampleCount(). The end of the part is a limit, too.
struct Batches {
  std::uint64_t first = 0, last = 0;
};

// Motion blur: the shutter is open from frame + open to frame + close. Each sample shows the scene at a time of its own.
struct Shutter {
  double open = 0;     // frames of the animation, [-1000, 1000]
  double close = 0.5;  // frames, [open, 1000]; equal to `open` means an image without blur at frame + open
};

// What decides the values of an image, besides scene and program.
struct Settings {
  std::uint32_t width = 1280;  // pixels, [1, 65536]
  std::uint32_t height = 720;
  std::optional<Region> region{};    // render only this part of the image
  std::uint32_t seed = 0;            // of the random number generator
  std::optional<Camera> camera{};    // default: the scene's first camera, else one that shows the whole scene
  std::string cameraName{};          // or a camera of the scene, by name or index
  std::optional<Shutter> shutter{};  // of an animated scene; not for programs that accumulate
  bool transparent = false;          // alpha 0 where a camera ray leaves the scene, instead of the environment
  std::vector<std::pair<std::string, std::string>> parameters{};  // name, value as on the command line ("1,0.5,0")
  std::vector<std::string> outputs{};  // optional outputs (AOVs) and heat maps to render, by name; "all": every AOV
  bool adaptive = false;             // distribute samples by the error of each tile; only for programs that support it
  std::optional<Batches> batches{};  // render this part of a render; Film::merge() joins parts
  // Pixels of the image for which RenderReport::printed gets what shaders print (debugPrintfEXT). Without it, prints cost
  // nothing.
  std::optional<Region> print{};
  std::uint64_t printLimit = 200;  // lines until the next edit; further ones are only counted
  // Number of samples for which the sampler distributes its points best; 0 means after each power of two. It decides the
  // values of samples. `quintet render --spp N` uses N.
  std::uint32_t plannedSamples = 0;
  // Bytes of host memory that a file can request while it is read: an image of `parameters`, or the checkpoint of
  // Renderer::resume(). 0 means 80 % of the machine's memory. More is a MemoryError (Remedy::raiseMemoryLimit).
  std::size_t maxMemory = 0;
  // Asked several times per second by the thread that constructs the renderer, renders, explains or searches; may be empty. True
  // ends the construction, and a render that loads the scene again after an edit, with CanceledError; a render then ends as if its
  // progress function had returned false. A call of the driver, such as the compilation of a pipeline, is not interrupted.
  std::function<bool()> canceled{};
};

// A render stops at the first limit that is reached. At least one must be set, unless Settings::batches limits the render or
// the progress function stops it.
struct Limits {
  std::optional<std::uint64_t>
      samples{};  // in total, per pixel; an average if adaptive. For a program that accumulates: frames
  std::optional<double> seconds{};  // wall clock of this and earlier calls since the last edit
  std::optional<double> error{};    // relative, with 95 % confidence: docs/cli.md; > 0
};

// The state of a render between two launches.
struct Progress {
  double samples = 0;   // per pixel, or frames, with the finished fraction of the current batch
  double seconds = 0;   // wall clock of rendering
  double fraction = 0;  // of the limit that is reached first, [0,1]; 0 if unknown
  double secondsLeft = std::numeric_limits<double>::infinity();  // infinity if unknown
  double raysPerSecond = 0;                                      // 0 if unknown
  std::optional<double> error{};  // relative error, if it is estimated; empty if it is unknown
};
// Called several times per second, between launches, from the thread that calls render(). Returning false stops the render: after
// the current batch if that takes at most about half a second, else at once and without the samples of this batch. The function
// can read images; it must not change the renderer, which is a UsageError. Exceptions stop the render and leave render().
using ProgressFunction = std::function<bool(const Progress&)>;

// Why a render stopped.
enum class StopReason {
  samples,  // also the end of a part; also no pixel requires more samples (adaptive sampling without other limits)
  time,
  error,
  canceled,
  unknownError,  // an error is the only limit, and it can never be known, because samples exceed the range of the film
};

// What Renderer::render() did.
struct RenderReport {
  StopReason reason = StopReason::samples;
  double samples = 0;                // per pixel, or frames, in total
  double seconds = 0;                // wall clock of rendering since the last edit
  std::uint64_t rays = 0;            // since the last edit
  std::uint64_t droppedSamples = 0;  // not finite and therefore not in the image
  std::optional<double> error{};     // relative error of the image; empty if it is unknown
  std::vector<std::string> warnings{};
  std::vector<PrintedLine> printed{};  // with Settings::print: by pixel and sample, for each batch
  std::uint64_t omittedPrints = 0;     // beyond the limit, or more than the device could store
};

// Renders a scene with a program. Use an object from one thread at a time; renderers of different devices can run in
// parallel.
class Renderer {
 public:
  // Uploads the scene, then compiles, checks and links the program. `device` must outlive the renderer; later changes of
  // `scene` have no effect. Throws ProgramError, UsageError, FileError, MemoryError, CanceledError, Error.
  Renderer(Device& device, const Scene& scene, const Program& program, const Settings& settings = {});
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  // Renders until a limit is reached or `progress` returns false. Another call with higher limits continues. Throws
  // UsageError, DeviceLostError, and TimeoutError, after which this object must not be destroyed (device.h). Throws also what
  // the constructor throws if the scene must be rebuilt after an edit. There is no image then; render() tries again, for
  // example after another edit.
  RenderReport render(const Limits& limits, const ProgressFunction& progress = {});
  // Adds `count` samples per pixel, or frames for a program that accumulates; multiples of 4 are fastest.
  RenderReport render(std::uint32_t count);

  double sampleCount() const;                         // per pixel, an average for adaptive sampling; or frames
  std::vector<Diagnostic> diagnostics() const;        // warnings of the check of the program
  Image image(const std::string& output = {}) const;  // film().image(output) without copying the rest
  Film film() const;                                  // everything so far, copied to host memory

  // Explains sample number `sample` (from 0) of a pixel of the whole image, or frame number `sample` of a program that
  // accumulates, whose earlier frames are rendered for that. The sample has the value that render() would give it, with the
  // edits so far; Settings::region and Settings::batches do not matter, and the samples rendered so far are kept. The first
  // call links a variant of the program that records what it does, which can take seconds. Throws UsageError for a pixel
  // outside of the image and for a sample above 2^24 - 1, and what render() throws.
  Explanation explain(std::uint32_t x, std::uint32_t y, std::uint32_t sample = 0);
  // Renders each sample of all pixels (of Settings::region) alone, and explains those that are not finite and fireflies.
  // The samples rendered so far are kept. Progress counts the samples of the search, and then, from 0 again, the
  // explanations. Returning false during the search ends it, and what was found is explained. Returning false during the
  // explanations removes the samples that are not explained yet. In programs that accumulate, a pixel that is not finite is
  // found in its first frame, and SearchSettings::fireflies has no effect. Throws UsageError for settings out of range, and
  // what render() throws.
  SearchReport search(const SearchSettings& settings = {}, const ProgressFunction& progress = {});

  // Edits. Each discards the samples so far; they take effect in the next render(). A change of camera, parameters or
  // transforms keeps the pipeline and the bottom-level acceleration structures. A change of a material compiles the
  // program if it changes which features the materials use. It rebuilds the scene on the device if it changes alpha tests
  // or textures.
  // They throw UsageError for unknown names, indices out of range and invalid values, and FileError for an image parameter
  // whose file cannot be read, and then change nothing.
  void setCamera(const Camera& camera);  // replaces the camera of the settings or the scene
  void setParameter(const std::string& name, const std::string& value);  // as in Settings::parameters
  void setTransform(int instance, const Transform& worldFromObject);     // of an instance without keyframes
  void setMaterial(int index, const Material& material);                 // as Scene::setMaterial()
  void setFrame(
      float frame);  // of the animation, which the scene must have for frames after 0. Not for programs that accumulate
  void restart();    // discards the samples so far

  // Writes the film to `file` (.qfilm) in one step. Throws FileError; UsageError for a program that accumulates.
  void saveCheckpoint(const std::filesystem::path& file) const;
  // Continues from such a file. Returns false if it does not exist or holds no samples. Throws FileError if it belongs to a
  // different render or is damaged; UsageError for a program that accumulates. Keeps the samples so far unless it returns true.
  bool resume(const std::filesystem::path& file);

 private:
  struct Impl;
  Impl& impl() const;  // throws UsageError for an empty object
  std::unique_ptr<Impl> impl_;
};

}  // namespace quintet
#endif

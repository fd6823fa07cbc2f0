// SPDX-License-Identifier: Apache-2.0
// An interactive render without a user interface: commands change what is shown, steps refine the image, and events
// report what happened. While commands arrive, images have a reduced resolution that holds a target rate. Afterwards
// the image becomes sharper in steps, and the film then becomes that of a render with the same request, byte by byte.
//
// If the device is lost, the session opens it again and continues with the scene, the edits and the settings. It gives
// up after kMaxDeviceLosses losses without progress, until a command changes the image.
//
// A session is used by one thread at a time. A front end that must not wait runs it in a thread of its own, and
// interrupts step() when it has a command.
#ifndef QUINTET_JOB_INTERACTIVE_SESSION_H
#define QUINTET_JOB_INTERACTIVE_SESSION_H

#include <cstdint>
#include <filesystem>
#include <functional>
#include <future>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "gpu/error.h"
#include "io/image.h"
#include "job/depth_map.h"
#include "job/engine.h"
#include "job/interactive/command.h"
#include "job/interactive/event.h"
#include "job/interactive/history.h"
#include "job/interactive/orbit_camera.h"
#include "job/interactive/picking.h"
#include "job/interactive/resolution_control.h"
#include "job/pixel_explainer.h"
#include "job/render_job.h"
#include "job/source_watcher.h"

namespace quintet::job::interactive {

// Losses of the device after which step() reports Failed. An image with all samples, or a minute of rendering, starts the
// count over.
constexpr unsigned kMaxDeviceLosses = 3;

struct LightState {
  scene::Light light;
  bool on = true;
  // lightColor() of the last intensity above 0, to which a light of intensity 0 returns.
  vec3 color{1.0f};
};

// Everything that undo restores.
struct SessionState {
  std::string program;                   // SessionRequest::program
  std::filesystem::path parameterFile;   // RenderRequest::parameterFile
  std::vector<std::string> assignments;  // RenderRequest::assignments
  CameraRequest camera;
  std::optional<vec3> orbitCenter;  // world space; unset means the point that the camera looks at
  EnvironmentRequest environment;
  bool environmentOn = true;
  // Those that were changed, by index in the scene.
  std::map<std::size_t, std::shared_ptr<const scene::Material>> materials;
  std::map<std::size_t, std::shared_ptr<const LightState>> lights;
  std::map<std::size_t, mat4> transforms;  // of instances
  float frame = 0;
  std::string output;                      // name
  double exposure = 0;                     // stops
  std::optional<render::ToneMap> toneMap;  // unset means by the kind of output
  uvec2 size{0};                           // pixels, of the image at full resolution
  std::uint32_t samples = 64;
  bool operator==(const SessionState&) const = default;
};

struct SessionRequest {
  std::string program = "pathtracer";  // name, folder or file
  // Scene, camera, environment, size, seed, parameters, limits.samples (default: 64), and launchSeconds (default: 0.05
  // on a CPU, 0.01 on a GPU).
  RenderRequest render;
  double updatesPerSecond = 0;  // while something moves; 0 means 12 on a CPU, else 90
  // ProgramRequest::draft for programs that change: the first images of reduced resolution appear earlier, and their last bits
  // can differ.
  bool drafts = false;
};

// `request` with the program, parameters, camera, environment, size and samples of a state. A session of it shows the
// scene as the file has it: edits of materials, lights and transforms, and what only affects the display, are not part.
SessionRequest withState(SessionRequest request, const SessionState& state);

class Session {
 public:
  // Seconds since any moment.
  using Clock = std::function<double()>;

  // Loads scene and program. `engine` and `host` outlive the session; `host` gets the stages of the work and a hung
  // device, everything else becomes events. Throws as RenderJob and program::loadProgram() do; DeviceLostError if the
  // device was lost kMaxDeviceLosses times. Nothing else may use the engine's device between two calls of the session:
  // each of them can replace it.
  Session(Engine& engine, SessionRequest request, Clock clock, Observer& host);
  ~Session();

  // Throws UsageError and FileError, and ProgramError for a program or an output whose code does not compile, and then
  // changes nothing. A command that sets what is set adds no step. Undo and redo without a step are errors, too. A step
  // that refers to a file or a name that no longer exists is removed, so that the next undo or redo reaches the step
  // after it. After any other error it stays: a program can be corrected.
  void apply(const Command& command);
  bool canUndo() const { return history_.canUndo(); }
  bool canRedo() const { return history_.canRedo(); }
  std::string undoName() const { return history_.undoName(); }  // undoName() of the command; empty without a step
  std::string redoName() const { return history_.redoName(); }

  // Renders for about this time, at least one image if there is work, and returns what happened since the last step.
  // Returns at once if a command has only changed how the image is displayed.
  // Reloads the program if one of its files was saved. `interrupted` is asked between launches, which take about
  // RenderRequest::launchSeconds: true abandons the batch in progress, whose samples are lost. A save of a file abandons it,
  // too, except in refine(). Throws gpu errors and TimeoutError. A lost device becomes DeviceReplaced, or Failed after
  // kMaxDeviceLosses losses; the functions below throw DeviceLostError then.
  std::vector<Event> step(double seconds, const std::function<bool()>& interrupted = {});
  // Refines to all samples, without images of reduced resolution. After Failed, it tries again.
  std::vector<Event> refine(const std::function<bool()>& interrupted = {});
  // Until step() has something to render: 0 if it has now, infinity if the image is complete. Saves of files are not
  // included.
  double secondsUntilWork() const;
  // The next step() has something to do besides samples: a file of the program was saved, or a command has only changed
  // how the image is displayed.
  bool hasChange() { return imageChanged_ || watcher_.pending(); }

  // The image of the latest ImageUpdated, with the current output, exposure and tone map. Valid until the next command
  // that discards samples. For display: the last bits can differ from result(). They throw Error if the last change
  // failed, and DeviceLostError; see recoverFrom().
  io::Image image() const;        // 8-bit sRGB, RGB; RGBA if RenderRequest::transparent
  io::Image linearImage() const;  // float RGBA, linear, premultiplied; without exposure
  // With the film, for output::writeOutputs(). Its size is reduced until refinement starts. Throws Error if the last
  // change failed.
  RenderResult result() const;
  // result() has samples at that size, of the complete program.
  bool hasFullSize() const { return samples_ > 0 && filmSize_ == state_.size && !job_->showsDraft(); }
  render::RayCount rays() const;  // since the last restart; waits for the device, so not for each image
  // Pixels of the image, of which the program has discarded a sample that was not finite; at most `limit`. As rays().
  std::vector<uvec2> droppedPixels(std::size_t limit) const;
  // Call it with an error that one of the functions above, or a use of their result, has thrown: the next step() renders
  // the image again on a new device. Returns false if the session gave up after kMaxDeviceLosses losses.
  bool recoverFrom(const DeviceLostError& error);

  // What is visible at a pixel of the image at full resolution; nothing if no surface is. For programs that use the
  // camera of the scene. Throws UsageError for a pixel outside, and as step() does.
  std::optional<Pick> pick(uvec2 pixel);
  // The depths of the image at full resolution, for lines over it. For the same programs. Blocks; throws as step() does.
  DepthMap depthMap();

  // Explains a sample of a pixel of the image at full resolution, as it is after all commands: the result is that of a
  // PixelExplainer for a render with the same request. For a program that accumulates, `sample` is a frame, and those
  // before it are rendered first. The image stays, and refinement continues. Blocks; compiles a variant of the program
  // after each change that compiles the program. Throws UsageError for a pixel or a sample that the image does not
  // have, ProgramError, TimeoutError and gpu errors.
  PixelExplanation explain(uvec2 pixel, std::uint32_t sample);
  // The changes so far that discarded the samples: an explanation is outdated if this number has changed since.
  std::uint64_t restarts() const { return restarts_; }

  // SetPrint; unset if nothing is printed.
  const std::optional<PrintRequest>& print() const { return job_->resolved().request.print; }
  bool callsPrint() const { return job_->callsPrint(); }  // the program has calls of debugPrintfEXT

  const WatchList& watchedFiles() const { return watched_; }  // whose saves reload the program

  const SessionState& state() const { return state_; }
  const program::Program& program() const { return job_->resolved().program; }
  const program::ParameterValues& parameters() const { return job_->resolved().parameters; }
  const std::vector<Diagnostic>& diagnostics() const { return job_->diagnostics(); }  // warnings of the program

  // The scene as it was loaded, and its objects as they are shown.
  const scene::Scene& scene() const { return *scene_; }
  const std::vector<std::string>& instanceNames() const { return instanceNames_; }
  const std::vector<std::string>& materialNames() const { return materialNames_; }
  const std::vector<std::string>& lightNames() const { return lightNames_; }
  const scene::Material& material(std::size_t index) const;
  LightState light(std::size_t index) const;
  mat4 transform(std::size_t instance) const;
  Bounds3 bounds(const std::string& instance) const;  // world space; empty name: the whole scene. Throws UsageError
  scene::Camera camera() const;                       // for the full resolution
  // Throws UsageError for an orthographic camera.
  OrbitCamera navigation() const;
  bool isAnimated() const;  // keyframes, or a glTF animation
  float lastFrame() const;  // at which something changes; 0 without animation

 private:
  class Recorder;

  SessionState changed(const Command& command) const;
  const scene::Material& materialIn(const SessionState& state, std::size_t index) const;
  LightState lightIn(const SessionState& state, std::size_t index) const;
  void show(const SessionState& next);
  void transfer(const SessionState& from, SessionState& to, unsigned& edits);
  void showProgram(program::Program program, const SessionState& next);
  void setPrint(const SetPrint& command);
  void requirePixel(uvec2 pixel) const;
  void restarted();
  template <class Function>
  std::invoke_result_t<const Function&> recovering(const Function& function);
  void replaceDevice(const std::string& cause);
  bool hasAutomaticCamera() const;
  const scene::Pose& pose() const;  // at the frame of the state
  std::size_t outputIndex() const;  // in the program

  void watchFiles(const std::vector<Diagnostic>& diagnostics);
  void reloadIfSaved();
  bool isMoving() const;
  bool hasWork() const;
  void work(double end);
  bool renderNext();  // false: interrupted
  bool added(std::optional<double> seconds, std::uint64_t samples, unsigned factor);
  void keepPreview();
  bool renderPreview(unsigned factor);
  bool renderBatch();
  void beginRefinement();

  Engine& engine_;
  const Clock clock_;
  const bool drafts_;  // SessionRequest::drafts
  std::shared_ptr<const scene::Scene> scene_;
  std::vector<std::string> instanceNames_, materialNames_, lightNames_;
  Bounds3 sceneBounds_;                      // scene::animatedBounds
  mutable std::optional<scene::Pose> pose_;  // of the last call of pose()
  std::unique_ptr<Recorder> recorder_;
  std::unique_ptr<RenderJob> job_;
  std::future<void> picking_;                  // compiles the program that picks
  std::unique_ptr<PixelExplainer> explainer_;  // of explainedPixel_; null after a restart
  uvec2 explainedPixel_{0};
  std::uint64_t restarts_ = 0;
  SourceWatcher watcher_;
  SessionState state_;
  History<SessionState> history_;
  ResolutionControl resolution_;
  WatchList watched_;
  uvec2 filmSize_{0};               // of the job
  std::uint64_t samples_ = 0;       // in the film
  double seconds_ = 0;              // in which they were rendered
  double lastRestart_ = 0;          // on clock_
  unsigned previewFactor_ = 1;      // of the latest preview
  bool preview_ = false;            // the image is a preview, which is not refined
  bool refining_ = false;           // since the last restart, the film has its full size
  bool direct_ = false;             // no previews: during refine()
  std::optional<io::Image> kept_;   // linear image of the last preview, while the film has no samples
  bool sizeOfWindow_ = false;       // SetSize::ofWindow was applied
  bool imageChanged_ = false;       // since the last event
  std::uint64_t measuredLink_ = 0;  // RenderJob::linkCount() of the last image; its time can include compilation
  bool failed_ = false;             // as of Failed
  unsigned deviceLosses_ = 0;       // without progress in between
};

}  // namespace quintet::job::interactive
#endif

// SPDX-License-Identifier: Apache-2.0
// A render from the loaded scene to its result. The construction does everything that precedes the first sample; run()
// renders.
#ifndef QUINTET_JOB_RENDER_JOB_H
#define QUINTET_JOB_RENDER_JOB_H

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "base/stopwatch.h"
#include "job/checkpoint.h"
#include "job/device_team.h"
#include "job/engine.h"
#include "job/observer.h"
#include "job/print_log.h"
#include "job/program_draft.h"
#include "job/resolve.h"
#include "job/result.h"
#include "job/runnable_program.h"
#include "job/sampling_schedule.h"
#include "job/scene_loading.h"
#include "job/view.h"
#include "render/renderer/renderer.h"
#include "render/scene/device_scene.h"

namespace quintet::job {

// A scene on the device and what was decided with it. Jobs with the same request can share it.
struct PreparedScene {
  SceneSource source;
  scene::Camera camera;
  std::string cameraDescription;
  std::string environment;  // description
  // With its image only for editable jobs. `environmentSource`: EnvironmentRequest::source for which it was chosen.
  EnvironmentChoice environmentInUse;
  std::string environmentSource;
  std::string hash, environmentHash;
  uvec2 size{0};                                          // of the whole image, pixels
  std::vector<std::filesystem::path> files;               // that the scene file names
  std::vector<std::string> instanceNames, materialNames;  // scene/model/names.h
  std::vector<std::string> lightNames;                    // of scene::Scene::lights
  std::size_t ignoredAnimations = 0;                      // of glTF files
  // Of the scene, if one follows a node of `nodeAnimation`; else empty. At frame 0.
  std::vector<scene::Camera> movingCameras;
  std::shared_ptr<const scene::NodeAnimation> nodeAnimation;            // null if no glTF animation plays
  Bounds3 bounds;                                                       // of the animated scene, if cameras move
  program::SingleAnyHit singleAnyHit = program::SingleAnyHit::tinting;  // of the acceleration structures
  Timings seconds;
  std::shared_ptr<render::DeviceScene> onDevice;                // on the first device
  std::vector<std::shared_ptr<render::DeviceScene>> onFurther;  // on the others, in the order of `devices`
  std::vector<std::size_t> devices;                             // in the engine, without those that were lost
};

// Members of RenderRequest that belong to a program.
struct ProgramRequest {
  std::vector<std::string> outputs;
  std::filesystem::path parameterFile;
  std::vector<std::string> assignments;
  // RenderJob::setProgram() can return with a draft of a large program, which takes less time; see completeProgram(). On a CPU,
  // with one device. The driver gets the draft before the check has ended: an incorrect program can crash it.
  bool draft = false;
};

// With several devices in the engine, all of them render; a program that accumulates and a request for prints use the first one.
class RenderJob {
 public:
  // Loads the scene, opens the devices and compiles the program side by side; then builds acceleration structures,
  // checks and links. `engine` outlives the job. Throws ProgramError, FileError, UsageError, MemoryError,
  // gpu::NoDeviceError, gpu::VulkanError.
  RenderJob(Engine& engine, ResolvedJob job, Observer& observer);
  // The same with a scene that outlasts the job: used if it is not null (of an earlier job with the same request and
  // unchanged scene files) and built as the program's any-hit shaders need it, else set as soon as the scene is on the device, even if the program then does not compile.
  RenderJob(Engine& engine, ResolvedJob job, Observer& observer, std::shared_ptr<PreparedScene>& scene);
  RenderJob(const RenderJob&) = delete;
  RenderJob& operator=(const RenderJob&) = delete;

  // Renders until a limit is reached or the observer stops. A second call continues with the film of the first.
  // With FrameRequest::every, Observer::frame() gets the result of each frame; the last one is returned, too. With a
  // checkpoint request, the first call resumes, and the checkpoint is saved between batches. The result's film is valid
  // as long as the job. Throws FileError (checkpoint, film to overwrite), UsageError, gpu errors.
  RenderResult run(const RenderLimits& limits, Observer& observer);

  // For front ends that show the film while it is rendered: renders the next batch or frame, to at most `samples` per
  // pixel, and waits for it. Returns the seconds that this took, or nothing if the observer abandoned it: then it adds
  // no samples. Not for adaptive renders and parts.
  std::optional<double> renderBatch(std::uint64_t samples, Observer& observer);

  // The state between two calls of run(), as run() returned it. With the error estimate only on request, because it
  // takes time. Throws Error if an edit failed.
  RenderResult result(bool withError = false) const;
  std::shared_ptr<FilmView> film() const;  // of result(), without its counts, which wait for the device
  double sampleCount() const;              // per pixel, on average if adaptive; or frames
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }  // warnings of the check

  // Edits between two renders, for jobs with RenderRequest::editable. Each discards the samples so far and takes effect
  // in the next run(), renderBatch() or update(). They throw UsageError, and FileError for an image, and then change
  // nothing. If the next render throws because the scene cannot be rebuilt, there is no film until an edit corrects the
  // cause and a render succeeds. Most edits change tables on the device. If shader definitions depend on the change,
  // the program is compiled again; if alpha tests, textures or tangents do, the scene is built again.
  void setCamera(const CameraRequest& camera);
  void setParameters(const std::vector<std::string>& assignments);       // replaces RenderRequest::assignments
  void setTransform(std::size_t instance, const mat4& worldFromObject);  // of an instance that is not animated
  void setMaterial(std::size_t index, const scene::Material& material);
  void setLight(std::size_t index, const scene::Light& light);  // in scene.lights
  void setEnvironment(const EnvironmentRequest& environment);   // replaces RenderRequest::environment
  // An environment that was chosen because of the lights of the scene stays, also if edits add or remove lights.
  // Returns the request that states it.
  const EnvironmentRequest& keepEnvironment();
  void setFrame(double frame);  // of an animated scene; not for programs that accumulate, which count their frames
  void setSize(uvec2 size);     // of the whole image; the camera stays
  // RenderRequest::limits.samples and frames.accumulated, for which the samples are distributed.
  void setPlannedSamples(std::uint32_t count);
  // Compiles the program, which can be the same with changed shaders. Throws ProgramError, too, and then the old one
  // stays. A program that accumulates has no motion blur: RenderRequest::shutter is unset until another program follows.
  void setProgram(program::Program program, const ProgramRequest& with, Observer& observer);
  // Images have the values of a draft, whose last bits can differ, until completeProgram() is called. Programs that are
  // linked for other reasons are complete.
  bool showsDraft() const { return complete_ != nullptr; }
  // Replaces a draft by the complete program, and then discards the samples. Throws gpu errors and MemoryError; then the draft
  // stays.
  void completeProgram(Observer& observer);
  // Replaces RenderRequest::print. Its pixels need not be inside the image, whose size can change. Compiles the program.
  void setPrint(std::optional<PrintRequest> print, Observer& observer);
  void restart();  // only discards the samples
  // Applies the edits to the device now. Throws as run() does.
  void update(Observer& observer);

  // Destroys everything on the device, for example because it was lost (Engine::close()), and discards the samples. The
  // next run(), renderBatch() or update() loads all of it again, with all edits. For editable jobs.
  void releaseDevice();

  // Moves the scene on the device to the frame of the last render, after a PixelExplainer has moved it.
  void showCurrentFrame();
  bool callsPrint() const { return callsPrint_; }  // the program has calls of debugPrintfEXT

  const scene::Camera& camera() const { return scene_->camera; }
  // The scene in host memory, with all edits but those of the environment. For editable jobs.
  const scene::Scene& hostScene() const { return editedScene_ ? *editedScene_ : *job_.scene.loaded; }

  // Replaces the film by the one in `file`, which belongs to this render. Returns false if the file does not exist or
  // holds no samples. Throws FileError. The film stays as it is unless the function returns true.
  bool resume(const std::filesystem::path& file, Observer& observer);

  // Call one of them after the outputs of run() were written, or could not be written: the checkpoint is removed unless
  // it must stay (CheckpointRequest::keep, incomplete render), or saved so that no sample is lost.
  void outputsWritten(const RenderResult& result, Observer& observer);
  void outputsFailed(const RenderResult& result, Observer& observer);

  const ResolvedJob& resolved() const { return job_; }
  const std::shared_ptr<PreparedScene>& scene() const { return scene_; }
  render::Renderer& renderer();                           // of the first device; throws Error if an edit failed
  std::uint64_t linkCount() const { return linkCount_; }  // of programs so far, each with a new renderer
  const render::Region& region() const;  // the rendered part of the image; throws Error if an edit failed
  // For users of renderer(): moves the scene to the frame that run() shows last. Programs that accumulate
  // count their frames, so nothing moves. Throws UsageError for a frame after the first one if nothing in the scene moves.
  void showRequestedFrame();

  double frame() const { return frame_; }  // of an animated scene
  // Passes on what the last launches printed; does it without prints, too. run() and renderBatch() do it.
  void flushPrints(Observer& observer);
  void discardPrints();  // of launches since the last call

  // Files on disk from which the scene and the program were made, for file watching.
  std::vector<std::filesystem::path> sceneFiles() const;
  std::vector<std::filesystem::path> programFiles() const;  // with included files
  std::vector<std::filesystem::path> files() const;         // of scene and program

 private:
  class FrameCrew;
  // The same job on one of its devices, for whole frames.
  RenderJob(const RenderJob& job, const TeamMember& member);

  void prepare(Observer& observer);
  void prepareScene(LoadedScene loaded, Observer& observer);
  std::size_t deviceCount(Observer& observer);  // of the engine that this job uses
  void makeScenes(PreparedScene& prepared, LoadedScene& loaded, Observer& observer) const;
  CheckedProgram checkProgram(const render::DeviceScene& scene, program::CompiledProgram compiled) const;
  std::vector<TeamMember> makeMembers(program::RunnableProgram runnable, const render::RenderSettings& settings,
                                      Observer& observer);
  void reportLosses(Observer& observer) const;
  void forgetSamples();
  bool renderRound(SamplingSchedule& schedule, const render::BatchProgress& progress);
  double roundSeconds(const RenderLimits& limits, double elapsed) const;
  void changeScenes(const std::function<void(render::DeviceScene&)>& change);
  void changeRenderers(const std::function<void(render::Renderer&)>& change);
  // `draft`: that the renderers use first, if the check finds that it can be used.
  void link(program::CompiledProgram compiled, Observer& observer, PendingPipeline* draft = nullptr);
  bool canDraft(const ResolvedJob& job) const;
  render::RenderSettings rendererSettings() const;
  Provenance makeProvenance() const;

  scene::Scene& editedScene();  // a copy of the loaded scene, for edits
  const scene::Environment& environmentInUse() const;
  void showFrame();                                        // moves the scene, the camera and the shutter to frame_
  void describeFrame();                                    // moves only the camera, and updates provenance_
  void moveShutter();                                      // of the renderer, to frame_
  std::optional<render::ShutterInterval> shutter() const;  // at frame_; unset without motion blur
  std::function<scene::Camera(double frame)> movingCamera() const;  // empty if the camera does not move
  // The frame that the scene shows between renders, and that makes the description of the camera: frame_, or with a shutter
  // the middle of its interval.
  double shownFrame() const;
  CameraChoice chooseMovingCamera(const CameraRequest& camera, double frame) const;
  void requireTeam() const;  // throws Error if an edit failed
  void rebuildScene(Observer& observer);
  void editDevice();
  void updateFrame();
  void relink(Observer& observer);
  void describeEdits() const;  // updates hashes and provenance_

  template <class Function>
  auto reportingHang(Observer& observer, const Function& function);
  std::optional<double> renderFilmBatch(std::uint64_t samples, Observer& observer);
  std::optional<double> renderNextFrame(std::uint64_t count, Observer& observer);
  // Throws UsageError if nothing in the scene moves. `consequence`: "all frames would be the same".
  void requireAnimation(std::string_view consequence) const;
  void requireFrames() const;  // that animations have
  RenderResult runFilm(const RenderLimits& limits, Observer& observer);
  RenderResult runAnimation(const RenderLimits& limits, Observer& observer);
  // The same with a frame at a time on each of several devices (frames_on_devices.cpp).
  bool givesFramesToDevices() const;
  RenderResult runFramesOnDevices(const RenderLimits& limits, Observer& observer);
  RenderResult renderAnimationFrame(std::uint32_t frame, const RenderLimits& limits, Observer& observer);
  // Results of the frames of an animation, in their order.
  struct FrameSequence {
    double seconds = 0;
    bool missed = false;
    RenderResult last, earlier;
  };
  // Passes a frame on to the observer, with its own time; `seconds` is that of all frames so far. Returns false if it is the
  // last one, or the observer stops.
  bool addToSequence(FrameSequence& sequence, std::uint32_t frame, RenderResult result, double seconds,
                     Observer& observer);
  RenderResult endSequence(FrameSequence sequence);
  bool isFrameWritten(std::uint32_t frame, Observer& observer);
  void finishFrame(const RenderResult& frame, Observer& observer);
  RenderResult runFrames(const RenderLimits& limits, Observer& observer);
  StartPoint firstSample() const;                      // of the render or part
  RenderLimits withinPart(RenderLimits limits) const;  // the same limits, not beyond the end of the part
  void beginFilm();                                    // continues from firstSample()
  StartPoint startPoint(const RenderLimits& limits, Observer& observer);
  render::Region printableRegion(const render::RenderSettings& settings) const;
  // The result after `seconds` of rendering; with the error estimate only where it is needed, because it takes time.
  RenderResult makeResult(double seconds, const StartPoint& start, bool withError) const;

  const Stopwatch clock_;
  Engine& engine_;
  ResolvedJob job_;
  std::shared_ptr<PreparedScene> scene_;
  std::vector<std::filesystem::path> includedFiles_;
  std::vector<Diagnostic> diagnostics_;
  std::size_t deviceCount_ = 1;       // that the job uses
  bool devicesNoted_ = false;         // why it does not use all of the engine
  std::unique_ptr<PrintLog> prints_;  // null unless the request asks for them
  bool printsNoted_ = false;          // Observer::printsDisabled() was called
  bool printsInAnySize_ = false;      // setPrint() was called: the pixels of the request can be outside of the image
  bool callsPrint_ = false;
  std::unique_ptr<DeviceTeam> team_;           // null after a failed edit
  std::unique_ptr<CompleteProgram> complete_;  // of the draft that team_ has; else null
  mutable Provenance provenance_;              // without the facts that a result adds; see describeEdits()
  std::optional<Checkpoint> checkpoint_;
  StartPoint start_;                                   // of the next run()
  bool started_ = false;                               // run() was called
  std::uint32_t nextFrame_ = 0;                        // of a program that accumulates
  std::shared_ptr<scene::Scene> editedScene_;          // with all edits; null before the first one
  std::map<std::size_t, mat4> movedInstances_;         // edits that the device does not have yet
  std::optional<EnvironmentChoice> plainEnvironment_;  // in use instead of the scene's; without an image
  bool sceneOutdated_ = false;                         // edits require a new scene on the device
  bool programOutdated_ = false;                       // edits require other shader definitions
  bool emissionOutdated_ = false;                      // edits that the device does not have yet
  bool lightsOutdated_ = false;
  bool environmentOutdated_ = false;
  mutable bool provenanceOutdated_ = false;
  mutable bool sceneEdited_ = false;                // since the hash of the scene was computed
  mutable bool environmentEdited_ = false;          // since the hash of the environment was computed
  double frame_ = 0;                                // of an animated scene
  bool frameOutdated_ = false;                      // the device does not show frame_ yet
  std::optional<ShutterRequest> suspendedShutter_;  // while a program that accumulates is shown
  std::uint64_t linkCount_ = 0;
  double linkedSeconds_ = 0;      // on clock_
  double firstPixelSeconds_ = 0;  // on clock_; 0: no launch has ended
};

}  // namespace quintet::job
#endif

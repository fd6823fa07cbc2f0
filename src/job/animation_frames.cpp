// SPDX-License-Identifier: Apache-2.0
// The frames of an animation: which ones a job renders, how their results reach the observer, and where the scene, its
// camera and the shutter are at a frame. frames_on_devices.cpp renders them on several devices.
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/plural.h"
#include "job/render_job.h"
#include "job/view.h"
#include "scene/animation/pose.h"

namespace quintet::job {

void RenderJob::requireFrames() const { requireAnimation("all frames would be the same; render one frame"); }

void RenderJob::requireAnimation(std::string_view consequence) const {
  if (scene_->onDevice->animated()) return;
  const std::size_t ignored = scene_->ignoredAnimations;
  const std::string cause = ignored == 0
                                ? "the scene has neither keyframes nor an animation"
                                : fmt::format("{} {} not played, and nothing has keyframes",
                                              counted(ignored, "glTF animation"), nounFor(ignored, "is", "are"));
  throw UsageError(fmt::format("{}: {}, so {}, or add keyframes in a .scene.toml file (docs/scenes.md)",
                               job_.scene.name, cause, consequence));
}

RenderResult RenderJob::renderAnimationFrame(std::uint32_t frame, const RenderLimits& limits, Observer& observer) {
  frame_ = frame;
  describeFrame();
  changeScenes([&](render::DeviceScene& scene) { scene.setFrame(shownFrame()); });
  moveShutter();
  team_->restart();
  started_ = false;  // a checkpoint can hold the samples of this frame
  return runFilm(limits, observer);
}

bool RenderJob::addToSequence(FrameSequence& sequence, std::uint32_t frame, RenderResult result, double seconds,
                              Observer& observer) {
  const FrameRequest& frames = job_.request.frames;
  RenderResult& last = sequence.last = std::move(result);
  sequence.seconds = seconds;
  // The name of a single frame needs no number.
  if (scene_->onDevice->animated()) last.provenance.frame = frame;
  const bool isLast = frame == frames.lastFrame();
  const bool stop = observer.stopRequested() == StopRequest::finish && !isLast;
  last.interrupted = last.provenance.interrupted = last.interrupted || stop;
  last.earlierTargetMissed = sequence.missed;
  if (frames.every) finishFrame(last, observer);
  last.provenance.seconds = last.seconds.render = seconds;  // of the images, their own
  if (last.interrupted || isLast) return false;
  addFrame(sequence.earlier, last);
  // The caller sees only the last result, to which addFrame() adds what is not finite.
  if (last.targetMissed) observer.warning(fmt::format("frame {}: {}", frame, resultWarnings(last).front()));
  sequence.missed = sequence.missed || last.targetMissed;
  return true;
}

RenderResult RenderJob::endSequence(FrameSequence sequence) {
  RenderResult last = std::move(sequence.last);
  if (!last.film) {  // all frames were written before, or those at the end
    last = makeResult(sequence.seconds, start_, false);
    last.provenance.frame = job_.request.frames.lastFrame();
  }
  addFrame(last, sequence.earlier);
  return last;
}

// Each frame is an image of its own; if only the last one is written, only that one is rendered.
RenderResult RenderJob::runAnimation(const RenderLimits& limits, Observer& observer) {
  if (givesFramesToDevices()) return runFramesOnDevices(limits, observer);
  const FrameRequest& frames = job_.request.frames;
  FrameSequence sequence;
  for (std::uint32_t frame = frames.every ? frames.firstFrame() : frames.lastFrame(); frame <= frames.lastFrame();
       ++frame) {
    if (isFrameWritten(frame, observer)) continue;
    RenderResult result = renderAnimationFrame(frame, limits, observer);
    if (result.abandoned) return result;
    const double seconds = sequence.seconds + result.provenance.seconds;
    if (!addToSequence(sequence, frame, std::move(result), seconds, observer)) break;
  }
  return endSequence(std::move(sequence));
}

bool RenderJob::isFrameWritten(std::uint32_t frame, Observer& observer) {
  if (!job_.request.frames.every || !job_.request.checkpoint.resume) return false;
  frame_ = frame;
  describeFrame();
  Provenance asked = provenance_;
  if (scene_->onDevice->animated()) asked.frame = frame;
  return observer.isFrameWritten(asked);
}

// The checkpoint of a frame is removed when its images are written.
void RenderJob::finishFrame(const RenderResult& frame, Observer& observer) {
  try {
    observer.frame(frame);
  } catch (...) {
    outputsFailed(frame, observer);
    throw;
  }
  // The next frame needs the file, so it does not stay for a target error that was missed.
  if (checkpoint_ && !frame.interrupted) checkpoint_->remove(observer);
}

void RenderJob::showRequestedFrame() {
  if (job_.accumulatesFrames()) return;
  const FrameRequest& frames = job_.request.frames;
  if (frames.lastFrame() > 0 || frames.seconds) requireFrames();
  if (!scene_->onDevice->animated()) return;
  if (frames.seconds) frame_ = *frames.seconds * job_.request.framesPerSecond;
  if (frames.first || frames.count) frame_ = frames.lastFrame();  // otherwise that of setFrame()
  showFrame();
}

void RenderJob::showFrame() {
  describeFrame();
  changeScenes([&](render::DeviceScene& scene) { scene.setFrame(shownFrame()); });
  moveShutter();
}

void RenderJob::moveShutter() {
  if (!shutter() && scene_->movingCameras.empty()) return;
  changeRenderers([&](render::Renderer& renderer) { renderer.setShutter(shutter(), movingCamera()); });
}

std::optional<render::ShutterInterval> RenderJob::shutter() const {
  const std::optional<ShutterRequest>& request = job_.request.shutter;
  if (!request || !(request->close > request->open)) return std::nullopt;
  return render::ShutterInterval{frame_ + request->open, frame_ + request->close};
}

std::function<scene::Camera(double frame)> RenderJob::movingCamera() const {
  if (scene_->movingCameras.empty()) return {};
  return [this](double frame) { return chooseMovingCamera(job_.request.camera, frame).camera; };
}

double RenderJob::shownFrame() const {
  const std::optional<ShutterRequest>& request = job_.request.shutter;
  return request ? frame_ + 0.5 * (request->open + request->close) : frame_;
}

void RenderJob::describeFrame() {
  if (!scene_->movingCameras.empty()) {
    CameraChoice chosen = chooseMovingCamera(job_.request.camera, shownFrame());
    scene_->camera = chosen.camera;
    scene_->cameraDescription = std::move(chosen.description);
    changeRenderers([&](render::Renderer& renderer) { renderer.setCamera(scene_->camera); });
  }
  provenance_ = makeProvenance();
}

CameraChoice RenderJob::chooseMovingCamera(const CameraRequest& camera, double frame) const {
  const scene::Pose pose = scene::poseAt(scene_->nodeAnimation.get(), frame);
  scene::Scene view;
  view.name = job_.scene.name;
  for (const scene::Camera& moving : scene_->movingCameras) view.cameras.push_back(scene::cameraAt(moving, pose));
  const float aspect = static_cast<float>(scene_->size.x) / static_cast<float>(scene_->size.y);
  return chooseCamera(view, camera, aspect, scene_->bounds);
}

void RenderJob::showCurrentFrame() {
  if (!scene_ || !scene_->onDevice->animated()) return;
  const double frame = job_.accumulatesFrames() ? double{std::max(nextFrame_, 1u) - 1.0} : shownFrame();
  changeScenes([&](render::DeviceScene& scene) { scene.setFrame(frame); });
}

}  // namespace quintet::job

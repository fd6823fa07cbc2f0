// SPDX-License-Identifier: Apache-2.0
#include "lab/session_video.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <variant>
#include <vector>

#include "base/error.h"
#include "lab/session_events.h"

namespace quintet::lab {
namespace {

namespace interactive = job::interactive;

constexpr double kWaitSeconds = 0.02;  // for a session that waits until nothing moves

void throwIfFailed(const std::vector<interactive::Event>& events) {
  for (const interactive::Event& event : events)
    if (const auto* failed = std::get_if<interactive::Failed>(&event)) throw Error(failed->message);
}

output::VideoRequest videoRequest(const RenderVideo& request, const std::filesystem::path& file) {
  if (output::findProgram("ffmpeg").empty())
    throw UsageError("videos require the program ffmpeg, which is not installed on the machine of the server");
  output::VideoRequest video{.file = file, .framesPerSecond = request.framesPerSecond};
  output::checkVideoRequest(video, false);
  return video;
}

}  // namespace

SessionVideo::Motion SessionVideo::motionOf() const {
  const bool countsFrames = session_.program().accumulation == program::Accumulation::program;
  if (request_.turn) {
    if (countsFrames || !usesCamera(session_.program()))
      throw UsageError("the camera of this program cannot be turned: it does not use the camera of the scene");
    return Motion::turn;
  }
  if (countsFrames) return Motion::frames;
  if (session_.isAnimated()) return Motion::animation;
  throw UsageError("nothing moves: the program does not count frames, and the scene is not animated");
}

SessionVideo::SessionVideo(interactive::Session& session, const RenderVideo& request, const std::filesystem::path& file)
    : session_(session), request_(request), motion_(motionOf()), writer_(videoRequest(request, file)) {
  if (motion_ != Motion::frames) return;
  // A change of the number starts with frame 0.
  const bool isSet = session_.state().samples == request_.frames;
  session_.apply(interactive::SetSamples{request_.frames + (isSet ? 1 : 0)});
}

bool SessionVideo::addFrame(const std::function<bool()>& interrupted) {
  if (!(motion_ == Motion::frames ? renderProgramFrame(interrupted) : renderFrame(interrupted))) return false;
  writer_.add(session_.image());
  ++next_;
  return true;
}

bool SessionVideo::renderFrame(const std::function<bool()>& interrupted) {
  if (motion_ == Motion::animation)
    session_.apply(interactive::SetFrame{static_cast<float>(next_)});
  else if (next_ > 0)
    session_.apply(interactive::Orbit{.right = 360.0f / static_cast<float>(request_.frames)});
  throwIfFailed(session_.refine(interrupted));
  return !interrupted();
}

// Each step renders one frame, after a preview of the first one.
bool SessionVideo::renderProgramFrame(const std::function<bool()>& interrupted) {
  while (!interrupted()) {
    const std::vector<interactive::Event> events = session_.step(0, interrupted);
    throwIfFailed(events);
    for (const interactive::Event& event : events)
      if (const auto* image = std::get_if<interactive::ImageUpdated>(&event))
        if (image->factor == 1 && image->samples == next_ + 1) return true;
    if (const double wait = session_.secondsUntilWork(); wait > 0)
      std::this_thread::sleep_for(std::chrono::duration<double>(std::min(wait, kWaitSeconds)));
  }
  return false;
}

void SessionVideo::finish(job::Observer& observer) { writer_.finish(false, observer); }

}  // namespace quintet::lab

// SPDX-License-Identifier: Apache-2.0
// A video of what a session shows, frame by frame: the frames of a program that counts them, the animation of the scene, or
// one turn of the camera around it. The frames have the size, output, exposure and samples of the session; ffmpeg encodes
// them as they are rendered (output/video/video.h).
#ifndef QUINTET_LAB_SESSION_VIDEO_H
#define QUINTET_LAB_SESSION_VIDEO_H

#include <cstdint>
#include <filesystem>
#include <functional>

#include "job/interactive/session.h"
#include "lab/page_message.h"
#include "output/video/video.h"

namespace quintet::lab {

class SessionVideo {
 public:
  // The session restarts, and stays at the last frame. Throws UsageError if ffmpeg is missing, or if all frames would be the
  // same image.
  SessionVideo(job::interactive::Session& session, const RenderVideo& request, const std::filesystem::path& file);

  // Renders and encodes one frame. Returns false if `interrupted` (Session::step) has returned true. Throws what the
  // session reports as Failed as an Error, and FileError.
  bool addFrame(const std::function<bool()>& interrupted);
  std::uint32_t frames() const { return next_; }  // so far
  bool isComplete() const { return next_ == request_.frames; }
  // After the last frame. Throws FileError.
  void finish(job::Observer& observer);

 private:
  enum class Motion { frames, animation, turn };
  Motion motionOf() const;
  bool renderFrame(const std::function<bool()>& interrupted);
  bool renderProgramFrame(const std::function<bool()>& interrupted);

  job::interactive::Session& session_;
  const RenderVideo request_;
  const Motion motion_;
  output::VideoWriter writer_;
  std::uint32_t next_ = 0;  // frame
};

}  // namespace quintet::lab
#endif

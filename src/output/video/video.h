// SPDX-License-Identifier: Apache-2.0
// Videos of animations: MP4 (H.264), WebM (VP9) and GIF, encoded by the program ffmpeg while the frames are rendered.
#ifndef QUINTET_OUTPUT_VIDEO_VIDEO_H
#define QUINTET_OUTPUT_VIDEO_VIDEO_H

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/temporary_file.h"
#include "io/image.h"
#include "job/observer.h"
#include "output/frame_files.h"
#include "output/plan.h"
#include "output/video/ffmpeg.h"

namespace quintet::output {

enum class VideoFormat { mp4, webm, gif };

// By the extension, in any case; unset if the file is no video.
std::optional<VideoFormat> videoFormat(const std::filesystem::path& file);

struct VideoRequest {
  std::filesystem::path file;
  double framesPerSecond = 24.0;
  // Constant rate factor of the encoder: 0 (best) to 51 for MP4, default 18; 0 to 63 for WebM, default 24. Not for GIF.
  std::optional<unsigned> rateFactor;
  // Keep an image of each frame until the video is complete, so that a later run with the same request does not render
  // it again: frameImages(file).
  bool resumable = false;
};

// "out.mp4" has the images "out.mp4.0000.png" and so on: OutputRequest::file of the plan of the frames.
std::filesystem::path frameImages(const std::filesystem::path& video);

// Throws FileError if ffmpeg is not installed, UsageError for a rate factor that the format does not have, and for
// frames that are not opaque.
void checkVideoRequest(const VideoRequest& request, bool transparent);

// Arguments of ffmpeg for frames of this size, RGB with 8 bits. Both sides are even, except for GIF.
std::vector<std::string> ffmpegArguments(const VideoRequest& request, uvec2 size, const std::filesystem::path& output);

// Receives the frames of one video in their order. The video appears under its name when finish() returns; without it,
// an existing file stays and nothing is left behind, except for the images of a resumable video.
class VideoWriter {
 public:
  // `plan`: of the images of the frames, whose first output is encoded as its display image.
  VideoWriter(VideoRequest request, OutputPlan plan);
  // For frames that are images already: add(const io::Image&). `request.resumable` must be false.
  explicit VideoWriter(VideoRequest request);

  // For Observer::isFrameWritten: appends the image of the frame if an earlier run has written it. Throws FileError.
  bool addWritten(const job::Provenance& frame);
  // Appends a frame. Throws FileError.
  void add(const job::RenderResult& frame, job::Observer& observer);
  void add(const io::Image& frame);  // as displayed: 8-bit RGB
  // Completes the video. `incomplete`: the render was interrupted; then a resumable video is not written, and its
  // images stay. Returns whether the video was written. Throws FileError.
  bool finish(bool incomplete, job::Observer& observer);

 private:
  void encode(const io::Image& image);
  [[noreturn]] void fail(const std::string& problem) const;

  VideoRequest request_;
  OutputPlan plan_;
  uvec2 size_{0};
  std::vector<std::filesystem::path> images_;  // of the frames, to be removed
  std::unique_ptr<TemporaryFile> temporary_;
  std::unique_ptr<FfmpegProcess> ffmpeg_;
};

}  // namespace quintet::output
#endif

// SPDX-License-Identifier: Apache-2.0
#include "output/video/video.h"

#include <algorithm>
#include <cassert>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/text.h"
#include "io/codec.h"
#include "output/write.h"

namespace quintet::output {
namespace {

constexpr const char* kProgram = "ffmpeg";
constexpr unsigned kMp4RateFactor = 18, kMaxMp4RateFactor = 51;
constexpr unsigned kWebmRateFactor = 24, kMaxWebmRateFactor = 63;

void append(std::vector<std::string>& to, std::initializer_list<std::string> words) {
  to.insert(to.end(), words.begin(), words.end());
}

// The colors are those of sRGB.
void addColors(std::vector<std::string>& arguments) {
  append(arguments,
         {"-vf", "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd", "-pix_fmt", "yuv420p", "-colorspace",
          "bt709", "-color_primaries", "bt709", "-color_trc", "iec61966-2-1", "-color_range", "tv"});
}

// MP4 and WebM store colors at half the resolution, so both sides must be even: the last column and row are repeated.
io::Image withEvenSides(const io::Image& image) {
  const std::uint32_t width = image.width + image.width % 2, height = image.height + image.height % 2;
  if (width == image.width && height == image.height) return image;
  io::Image even = io::makeImage(width, height, image.channels, image.type, image.encoding);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      std::ranges::copy(image.pixel<std::uint8_t>(std::min(x, image.width - 1), std::min(y, image.height - 1)),
                        even.pixel<std::uint8_t>(x, y).begin());
  return even;
}

}  // namespace

std::optional<VideoFormat> videoFormat(const std::filesystem::path& file) {
  const std::string extension = lowerCase(file.extension().string());
  if (extension == ".mp4") return VideoFormat::mp4;
  if (extension == ".webm") return VideoFormat::webm;
  if (extension == ".gif") return VideoFormat::gif;
  return std::nullopt;
}

std::filesystem::path frameImages(const std::filesystem::path& video) {
  std::string name = video.filename().string();
  for (char& c : name)
    if (c == '#' || c == '%') c = '_';  // they would be a pattern
  return video.parent_path() / (name + ".####.png");
}

void checkVideoRequest(const VideoRequest& request, bool transparent) {
  const VideoFormat format = *videoFormat(request.file);
  if (transparent) throw UsageError(fmt::format("{}: videos have no alpha channel", request.file.string()));
  if (request.rateFactor) {
    if (format == VideoFormat::gif)
      throw UsageError(fmt::format("{}: GIF files have no rate factor", request.file.string()));
    const unsigned largest = format == VideoFormat::mp4 ? kMaxMp4RateFactor : kMaxWebmRateFactor;
    if (*request.rateFactor > largest)
      throw UsageError(
          fmt::format("{}: the rate factor {} is not in [0, {}]", request.file.string(), *request.rateFactor, largest));
  }
  if (findProgram(kProgram).empty())
    throw FileError(request.file,
                    "requires the program ffmpeg, which was not found in PATH; install it, or write an image of each "
                    "frame (name.####.png)");
  checkWritable(request.file);
}

std::vector<std::string> ffmpegArguments(const VideoRequest& request, uvec2 size, const std::filesystem::path& output) {
  std::vector<std::string> arguments{"-hide_banner",
                                     "-loglevel",
                                     "error",
                                     "-f",
                                     "rawvideo",
                                     "-pixel_format",
                                     "rgb24",
                                     "-video_size",
                                     fmt::format("{}x{}", size.x, size.y),
                                     "-framerate",
                                     fmt::format("{}", request.framesPerSecond),
                                     "-i",
                                     "pipe:0",
                                     "-an"};
  switch (*videoFormat(request.file)) {
    case VideoFormat::mp4:
      append(arguments, {"-c:v", "libx264", "-crf", std::to_string(request.rateFactor.value_or(kMp4RateFactor))});
      addColors(arguments);
      append(arguments, {"-movflags", "+faststart", "-f", "mp4"});
      break;
    case VideoFormat::webm:
      append(arguments, {"-c:v", "libvpx-vp9", "-crf", std::to_string(request.rateFactor.value_or(kWebmRateFactor)),
                         "-b:v", "0", "-row-mt", "1"});
      addColors(arguments);
      append(arguments, {"-f", "webm"});
      break;
    case VideoFormat::gif:  // with a palette per frame, because one for all requires all frames in memory
      append(arguments,
             {"-filter_complex", "[0:v]split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new=1", "-loop",
              "0", "-f", "gif"});
      break;
  }
  append(arguments, {"-y", output.string()});
  return arguments;
}

VideoWriter::VideoWriter(VideoRequest request, OutputPlan plan)
    : request_(std::move(request)), plan_(std::move(plan)) {}

VideoWriter::VideoWriter(VideoRequest request) : request_(std::move(request)) { assert(!request_.resumable); }

void VideoWriter::fail(const std::string& problem) const { throw FileError(request_.file, problem); }

bool VideoWriter::addWritten(const job::Provenance& frame) {
  if (!request_.resumable || !isFrameWritten(plan_, frame)) return false;
  const std::filesystem::path file = frameFiles(plan_, *frame.frame).front();
  images_.push_back(file);
  encode(io::toChannels(io::readImage(file), 3));
  return true;
}

void VideoWriter::add(const job::RenderResult& frame, job::Observer& observer) {
  if (request_.resumable)
    for (const WrittenFile& file : writeOutputs(plan_, frame, observer)) images_.push_back(file.path);
  encode(displayImage(plan_, *frame.film));
}

void VideoWriter::add(const io::Image& frame) { encode(frame); }

void VideoWriter::encode(const io::Image& image) {
  const io::Image frame = videoFormat(request_.file) == VideoFormat::gif ? image : withEvenSides(image);
  if (!ffmpeg_) {
    try {
      temporary_ = std::make_unique<TemporaryFile>(request_.file);
    } catch (const std::system_error& error) {
      fail("cannot be written: " + error.code().message());
    }
    size_ = {frame.width, frame.height};
    ffmpeg_ =
        std::make_unique<FfmpegProcess>(findProgram(kProgram), ffmpegArguments(request_, size_, temporary_->path()));
  }
  if (uvec2{frame.width, frame.height} != size_) fail("its frames have different sizes");
  if (!ffmpeg_->write(std::as_bytes(std::span(frame.data)))) {
    const std::string problem = ffmpeg_->finish();
    fail(problem.empty() ? "ffmpeg ended before the last frame" : problem);
  }
}

bool VideoWriter::finish(bool incomplete, job::Observer& observer) {
  if (!ffmpeg_) return false;
  if (incomplete && request_.resumable) {
    observer.note(
        fmt::format("{}: not written yet; the images of {} frames are kept", request_.file.string(), images_.size()));
    return false;
  }
  observer.stage("writing " + request_.file.string());
  if (const std::string problem = ffmpeg_->finish(); !problem.empty()) fail(problem);
  int failed = temporary_->flush();
  if (failed == 0) failed = temporary_->renameToTarget();
  if (failed != 0) fail("cannot be written: " + std::generic_category().message(failed));
  for (const std::filesystem::path& image : images_) {
    std::error_code ignored;
    std::filesystem::remove(image, ignored);
  }
  return true;
}

}  // namespace quintet::output

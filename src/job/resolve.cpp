// SPDX-License-Identifier: Apache-2.0
#include "job/resolve.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/plural.h"
#include "render/film/film_file.h"
#include "scene/model/names.h"

namespace quintet::job {
namespace {

[[noreturn]] void rejectFrames(const FrameRequest& frames, const program::Program& program) {
  const std::uint32_t first = frames.firstFrame(), last = frames.lastFrame();
  throw UsageError(fmt::format(
      "{}: the program '{}' accumulates, so each frame depends on all frames before it and on their total number; "
      "render "
      "all frames in one process",
      first == last ? fmt::format("frame {}", first) : fmt::format("frames {}–{}", first, last), program.name));
}

bool accumulates(const program::Program& program) { return program.accumulation == program::Accumulation::program; }

void checkFrames(const RenderRequest& request, const program::Program& program) {
  const FrameRequest& frames = request.frames;
  if (!(std::isfinite(request.framesPerSecond) && request.framesPerSecond > 0))
    throw UsageError(fmt::format("{} frames per second: the rate must be above 0", request.framesPerSecond));
  if (accumulates(program) && frames.first) rejectFrames(frames, program);
  if (!frames.seconds) return;
  if (!(std::isfinite(*frames.seconds) && *frames.seconds >= 0))
    throw UsageError(fmt::format("time {}: it must be at least 0 seconds", *frames.seconds));
  if (frames.first || frames.count) throw UsageError("a time and a range of frames exclude each other");
  if (frames.every) throw UsageError("a time is one image; a name with a frame number requires frames");
  if (accumulates(program))
    throw UsageError(fmt::format("time: the program '{}' counts its frames itself; give their number", program.name));
}

void checkShutter(const RenderRequest& request, const program::Program& program) {
  if (!request.shutter) return;
  const auto [open, close] = *request.shutter;
  for (const double time : {open, close})
    if (!(std::abs(time) <= kMaxShutter))
      throw UsageError(
          fmt::format("shutter {},{}: the times must be {} to {} frames", open, close, -kMaxShutter, kMaxShutter));
  if (close < open) throw UsageError(fmt::format("shutter {},{}: it closes before it opens", open, close));
  if (accumulates(program))
    throw UsageError(
        fmt::format("shutter: the program '{}' averages its frames itself, without motion blur", program.name));
}

void checkLimits(const RenderRequest& request, const program::Program& program) {
  const RenderLimits& limits = request.limits;
  const bool averages = accumulates(program);
  if (limits.adaptive && !program.adaptive)
    throw UsageError(
        fmt::format("adaptive sampling: the program '{}' takes the same number of samples in all pixels "
                    "(docs/programs.md: adaptive)",
                    program.name));
  if (limits.error && averages)
    throw UsageError(fmt::format(
        "target error: the program '{}' averages its samples itself, so their variance is unknown", program.name));
  if (averages && (!request.checkpoint.file.empty() || !request.film.empty()))
    throw UsageError(fmt::format(
        "the program '{}' averages its samples itself, so checkpoints and films are not available", program.name));
  const bool severalFrames = request.frames.every && request.frames.lastFrame() > request.frames.firstFrame();
  if (severalFrames && (request.batches || !request.film.empty()))
    throw UsageError("frames: a film holds one frame; render each frame with a film of its own");
  if (severalFrames && request.checkpoint.keep)
    throw UsageError("frames: they share one checkpoint, which cannot be kept; render each frame alone");
  if (!request.batches) return;
  if (limits.seconds || limits.error || limits.adaptive || !limits.samples)
    throw UsageError(
        "batches: a part of a render is a fixed number of samples, without time limit, target error or "
        "adaptive sampling");
  const std::uint64_t count = (*limits.samples + render::kBatchSamples - 1) / render::kBatchSamples;
  if (request.batches->last >= count)
    throw UsageError(fmt::format("batches: batch {} does not exist; the last batch of {} is {}", request.batches->last,
                                 counted(*limits.samples, "sample"), count - 1));
}

// True if both name the same file, also through links or "..".
bool isSameFile(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code failed;
  if (std::filesystem::equivalent(a, b, failed)) return true;
  const auto resolved = [&](const std::filesystem::path& file) {
    const std::filesystem::path path = std::filesystem::weakly_canonical(std::filesystem::absolute(file), failed);
    return failed ? file.lexically_normal() : path;
  };
  return resolved(a) == resolved(b);
}

void checkFiles(const RenderRequest& request) {
  const std::filesystem::path& checkpoint = request.checkpoint.file;
  if (!request.film.empty()) checkWritable(request.film);
  if (checkpoint.empty()) return;
  if (checkpoint.extension() != render::kFilmExtension)
    throw UsageError(
        fmt::format("checkpoint {}: the extension must be {}", checkpoint.string(), render::kFilmExtension));
  if (!request.film.empty() && isSameFile(checkpoint, request.film))
    throw UsageError(fmt::format("checkpoint {}: it is also the output", checkpoint.string()));
  checkWritable(checkpoint);
}

}  // namespace

ResolvedJob resolve(RenderRequest request, program::Program program) {
  ResolvedJob job;
  job.parameters = parameterValues(program, request);
  checkFrames(request, program);
  checkShutter(request, program);
  checkLimits(request, program);
  checkFiles(request);
  if (request.loadedScene) {
    job.scene.name = scene::nameForMessages(*request.loadedScene);
    job.scene.loaded = request.loadedScene;
  } else {
    job.scene = chooseSceneSource(request.scene, program, loadOptions(request, accumulates(program)));
  }
  job.request = std::move(request);
  job.program = std::move(program);
  return job;
}

program::ParameterValues parameterValues(const program::Program& program, const RenderRequest& request) {
  program::ParameterValues values(program.parameters);
  if (!request.parameterFile.empty())
    values.setFromJson(readTextFile(request.parameterFile), request.parameterFile.string());
  for (const std::string& assignment : request.assignments) values.setAssignment(assignment);
  return values;
}

bool isProgramSource(const std::filesystem::path& name) {
  constexpr std::string_view kExtensions[] = {".toml",  ".glsl",  ".h",     ".rgen", ".rint",
                                              ".rahit", ".rchit", ".rmiss", ".rcall"};
  return !name.string().starts_with('.') &&
         std::ranges::find(kExtensions, name.extension().string()) != std::end(kExtensions);
}

}  // namespace quintet::job

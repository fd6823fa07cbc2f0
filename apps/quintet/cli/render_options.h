// SPDX-License-Identifier: Apache-2.0
// The options that several commands share: declared in groups, parsed as text, then converted to requests.
#ifndef QUINTET_CLI_RENDER_OPTIONS_H
#define QUINTET_CLI_RENDER_OPTIONS_H

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/option_table.h"
#include "job/request.h"
#include "job/result.h"
#include "output/frame_files.h"
#include "output/plan.h"
#include "output/video/video.h"

namespace quintet::job {
class RenderJob;
}

namespace quintet::cli {

inline constexpr double kMaxFrames = 1e6;  // of --frame and --frames

struct RenderOptions {
  std::string program = "pathtracer";
  std::string device;  // with declareProcess() also a list
  bool mixedDevices = false;
  job::RenderRequest request;
  output::OutputRequest output;
  std::optional<output::VideoRequest> video;  // then `output` is for the images of its frames
  ConsoleOptions console;
  bool programHelp = false;  // print the program's parameters
  bool layerList = false;    // print the program's layers
  // Called before the first sample; an exception ends the render.
  std::function<void(const job::RenderJob&)> prepared;
  // Called when all outputs are written: with the frames of an animation, else an empty list.
  std::function<void(const job::RenderResult&, const std::vector<output::FrameFiles>&)> written;
};

// Option values as text.
struct LoadTexts {
  std::string missingTextures, maxMemory;
};
struct RenderTexts {
  LoadTexts load;
  std::string scene, output, size, region, frame, frames, at, fps, shutter, rateFactor, exposure, toneMap, pngBits;
  std::string spp, time, untilError, seed, bounces, clamp;
  std::string lookFrom, lookAt, up, fov, aperture, focus, envIntensity, envRotation;
  std::string exrType, exrCompression, exrTiles;
  std::string checkpoint, batches, timeout, print, printLimit;
  std::vector<std::string> layers;
};

inline constexpr const char* kStrictHelp =
    "Fail if a part of the scene file is ignored or repaired, with a list of these parts";
inline constexpr const char* kMaxMemoryHelp =
    "Memory that a file can request while it is read, with K, M, G or T for powers of 1024 (default: 80 % of the "
    "memory)";
// How scene files are read; of all commands that load scenes.
void declareLoading(OptionTable& table, LoadTexts& texts, scene::LoadOptions& options,
                    const char* strictHelp = kStrictHelp);
void convertLoading(const LoadTexts& texts, scene::LoadOptions& options);  // throws UsageError

void declareImage(OptionTable& table, RenderTexts& texts, RenderOptions& options);  // except the output file
// Size, region and background. `regionHelp` is the help of --region; null omits the option.
void declareSize(OptionTable& table, RenderTexts& texts, RenderOptions& options, const char* regionHelp = nullptr);
void declareFrame(OptionTable& table, RenderTexts& texts, const char* verb);         // "Render only this frame of …"
void declareFrames(OptionTable& table, RenderTexts& texts, RenderOptions& options);  // --frames and --all-frames
void declareAnimation(OptionTable& table, RenderTexts& texts,
                      RenderOptions& options);  // --animation, --fps and --shutter
void declareDisplay(OptionTable& table, RenderTexts& texts, const char* group, const char* otherwise);
void declareQuality(OptionTable& table, RenderTexts& texts, RenderOptions& options);
void declareView(OptionTable& table, RenderTexts& texts, RenderOptions& options);
void declareProgramName(OptionTable& table, RenderOptions& options);
void declareParameters(OptionTable& table, RenderOptions& options);  // of the program
void declareProgram(OptionTable& table, RenderOptions& options);     // parameters and outputs
inline constexpr const char* kLaunchLimitHelp =
    "Time limit of one launch, without compilation (default: 60; on a CPU 120)";
void declareDevice(OptionTable& table, RenderTexts& texts, RenderOptions& options);
// Device and messages.
void declareProcess(OptionTable& table, RenderTexts& texts, RenderOptions& options);
// The part of declareProcess() that decides which devices render: also a list of them.
void declareDevices(OptionTable& table, RenderTexts& texts, RenderOptions& options);
// What `render` and `run` share: what an image looks like, without the program.
void declareImageOptions(OptionTable& table, RenderTexts& texts, RenderOptions& options);
// What an image of a scene looks like: every option of `render` but its files, devices, messages and checkpoints.
void declareRendering(OptionTable& table, RenderTexts& texts, RenderOptions& options);
void declarePrint(OptionTable& table, RenderTexts& texts);  // what the program prints
void declareCheckpoints(OptionTable& table, RenderTexts& texts, RenderOptions& options);
void declareExr(OptionTable& table, RenderTexts& texts, bool ofFilms = false);

// Fills in requests from the texts, except `output.file` and `request.scene`. Throws UsageError.
void convert(const RenderTexts& texts, RenderOptions& options);
// If the output file is a video, `output` becomes the request for the images of its frames. Before convert().
void chooseVideo(RenderOptions& options);
// --frame, --frames, --at: which frames the request is for, and whether each is written. Throws UsageError.
void convertFrames(const RenderTexts& texts, RenderOptions& options);
// Converts the options of declareRendering(): convert(), chooseVideo() and convertFrames(). The scene and the output file
// are in `texts.scene` and `options.output.file`. Throws UsageError.
void convertRendering(const RenderTexts& texts, RenderOptions& options);
// The part of convert() that `merge` needs.
void convertOutput(const RenderTexts& texts, output::OutputRequest& output);

// Throws UsageError if --json and `-o -` both claim standard output, or if that is a terminal; and if --json-progress and
// --preview both claim standard error.
void checkStandardStreams(const RenderOptions& options);

}  // namespace quintet::cli
#endif

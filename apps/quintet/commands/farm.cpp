// SPDX-License-Identifier: Apache-2.0
#include "commands/farm.h"

#include <fmt/format.h>

#include "base/error.h"
#include "cli/parser.h"
#include "output/video/video.h"

namespace quintet::cli {

Option planArgument(std::filesystem::path& plan) {
  return {.names = "PLAN",
          .help = "The file plan.json, or its folder",
          .target = &plan,
          .candidates = {.extensions = {"json"}, .folders = true},
          .required = true};
}

void declarePlanned(OptionTable& table, RenderTexts& texts, RenderOptions& options) {
  declareRendering(table, texts, options);
  declareDevices(table, texts, options);
  table.add("Long renders", {{.names = "--checkpoint",
                              .value = "SECONDS",
                              .help = "Write a checkpoint of a part every N seconds, 0: after each batch (default: 60)",
                              .target = &texts.checkpoint}});
}

void convertPlanned(RenderTexts& texts, RenderOptions& options, const std::filesystem::path& image, bool frames) {
  if (output::videoFormat(image))
    throw UsageError(
        fmt::format("{}: a plan cannot write a video; write images of the frames with --image 'f####.png', and make "
                    "the video of them, for example with ffmpeg",
                    image.string()));
  if (output::isStandardOutput(image)) throw UsageError("--image: a plan writes files, not standard output");
  texts.output = image.string();
  options.output.file = image;
  options.output.everyFrame = frames;
  // The interval alone; the file of the checkpoint is that of the part.
  options.request.checkpoint.file = "part.qfilm";
  convertRendering(texts, options);
  options.request.checkpoint.file.clear();
}

RenderOptions plannedOptions(const farm::Plan& plan) {
  RenderOptions options;
  RenderTexts texts;
  OptionTable table("farm run", "");
  declarePlanned(table, texts, options);
  parse(table, plan.options);
  texts.scene = plan.scene.string();
  convertPlanned(texts, options, plan.image, plan.kind == farm::PartKind::frames);
  return options;
}

}  // namespace quintet::cli

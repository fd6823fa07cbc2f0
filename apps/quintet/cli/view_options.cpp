// SPDX-License-Identifier: Apache-2.0
#include "cli/view_options.h"

#include "base/error.h"
#include "cli/candidates.h"
#include "cli/parser.h"
#include "cli/values.h"

namespace quintet::cli {

OptionTable viewOptionTable(ViewOptions& options, RenderTexts& texts) {
  OptionTable table(
      "view",
      "Opens a scene in a window: the program quintet-view, which gets all arguments. With --script, runs an "
      "interactive session without a window.");
  table.add({{.names = "SCENE",
              .help = "Scene file: .gltf, .glb or .scene.toml (default: the program's own, or built in)",
              .target = &texts.scene,
              .candidates = {.extensions = kSceneExtensions}}});
  table.add(
      "Session",
      {{.names = "--script",
        .value = "FILE",
        .help =
            "Read commands from this file without a window, one JSON object per line; - is standard input. Events are "
            "printed as lines of JSON",
        .target = &options.script,
        .candidates = {.extensions = {"*"}}},
       {.names = "--keep-going",
        .help = "Continue after a command of the script that fails; the exit status is then 1",
        .target = &options.keepGoing}});
  declareSize(table, texts, options);
  table.add("Image", {{.names = "--spp",
                       .value = "N",
                       .help = "Number of samples per pixel that the image reaches (default: 64)",
                       .target = &texts.spp},
                      {.names = "--seed",
                       .value = "N",
                       .help = "Seed of the random number generator (default: 0)",
                       .target = &texts.seed}});
  declareView(table, texts, options);
  declareAnimation(table, texts, options);
  table.add(
      "Window",
      {{.names = "--window-size",
        .value = "WxH",
        .help = "Size of the window in screen coordinates (default: the last one)",
        .target = &options.windowSize},
       {.names = "--scale",
        .value = "X",
        .help = "Size of text and controls, 0.5 to 4 (default: that of the settings, or of the display)",
        .target = &options.scaleText},
       {.names = "--theme",
        .value = "dark|light",
        .help = "Colors of the window (default: those of the settings, or dark)",
        .target = &options.theme,
        .candidates = {.names = {"dark", "light"}}},
       {.names = "--present-device",
        .value = "NAME",
        .help = "Device that draws the window, as for --device (default: the first one that can present)",
        .target = &options.presentDevice,
        .candidates = {.names = deviceNames()}},
       {.names = "--no-settings", .help = "Neither read nor write the user settings", .target = &options.noSettings},
       {.names = "--events",
        .value = "FILE",
        .help = "Write events as lines of JSON to this file",
        .target = &options.events,
        .candidates = {.extensions = {"*"}}}});
  declareProgramName(table, options);
  declareParameters(table, options);
  declareDevice(table, texts, options);
  table.addExamples({
      {"quintet view scene.glb"},
      {"quintet view scene.glb --script tour.jsonl", "docs/viewer.md lists the commands"},
      {"echo '{\"do\":\"save\",\"file\":\"a.png\"}' | quintet view scene.glb --script -"},
  });
  return table;
}

std::optional<ViewOptions> parseViewOptions(Arguments arguments) {
  ViewOptions options;
  options.program.clear();
  RenderTexts texts;
  if (!parse(viewOptionTable(options, texts), arguments)) return std::nullopt;
  options.request.scene = texts.scene;
  options.request.commandLine = commandLine("view", arguments);
  options.output.file = "view.png";  // files are chosen later
  convert(texts, options);
  convertFrames(texts, options);
  options.startScreen = texts.scene.empty() && options.program.empty();
  if (options.program.empty()) options.program = ViewOptions().program;
  if (const auto scale = parseReal("--scale", options.scaleText, 0.5, 4.0)) options.scale = static_cast<float>(*scale);
  if (!options.theme.empty()) parseChoice("--theme", options.theme, {"dark", "light"});
  if (!options.windowSize.empty()) parseSize("--window-size", options.windowSize);
  return options;
}

}  // namespace quintet::cli

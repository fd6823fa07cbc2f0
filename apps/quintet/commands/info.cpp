// SPDX-License-Identifier: Apache-2.0
// `quintet info`: devices, a scene, an image or a film.
#include "output/info.h"

#include "base/file.h"
#include "cli/parser.h"
#include "cli/render_options.h"

namespace quintet::cli {
namespace {

struct InfoOptions {
  std::optional<std::string> file;
  scene::LoadOptions load;
  LoadTexts loadTexts;
  bool json = false;
};

OptionTable declareInfo(InfoOptions& options) {
  OptionTable table("info", "Describes the Vulkan devices, or a scene, an image or a film.");
  table.add({{.names = "FILE",
              .help = "A scene, an image or a film (.qfilm); without it, the devices",
              .target = &options.file,
              .candidates = {.extensions = {"gltf", "glb", "scene.toml", "png", "exr", "hdr", "jpg", "jpeg", "webp",
                                            "qfilm"}}},
             {.names = "--json", .help = "Print one JSON object instead of text", .target = &options.json}});
  declareLoading(table, options.loadTexts, options.load);
  table.addExamples({
      {"quintet info", "every device, and why one cannot be used"},
      {"quintet info scene.glb", "counts, cameras, extensions; what is used, unused, ignored or repaired"},
      {"quintet info scene.glb --strict", "fails if something is ignored or repaired"},
      {"quintet info out.png", "size, format, and how Quintet rendered it"},
      {"quintet info out.exr", "layers, channels, types, compression, windows, attributes"},
      {"quintet info part.qfilm", "which samples of which render"},
      {"quintet info --json | jq '.devices[].name'"},
  });
  return table;
}

}  // namespace

OptionTable infoOptions() {
  InfoOptions options;
  return declareInfo(options).withoutTargets();
}

int infoCommand(Arguments arguments) {
  InfoOptions options;
  if (!parse(declareInfo(options), arguments)) return 0;
  convertLoading(options.loadTexts, options.load);
  writeFile("-", options.file ? output::fileInfo(*options.file, options.json, options.load)
                              : output::devicesInfo(options.json));
  return 0;
}

}  // namespace quintet::cli

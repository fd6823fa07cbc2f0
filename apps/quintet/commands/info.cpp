// SPDX-License-Identifier: Apache-2.0
// `quintet info`: devices, a scene, an image or a film.
#include "output/info.h"

#include "base/file.h"
#include "cli/parser.h"

namespace quintet::cli {
namespace {

constexpr const char* kExamples =
    "  quintet info               every device, and why one cannot be used\n"
    "  quintet info scene.glb     counts, cameras, extensions; what was ignored or repaired\n"
    "  quintet info out.png       size, format, and how Quintet rendered it\n"
    "  quintet info out.exr       layers, channels, types, compression, windows, attributes\n"
    "  quintet info part.qfilm    which samples of which render\n"
    "  quintet info --json | jq '.devices[].name'\n";

}  // namespace

int infoCommand(Arguments arguments) {
  CLI::App app("Describes the Vulkan devices, or a scene, an image or a film.", "quintet info");
  std::string file;
  bool json = false;
  app.add_option("FILE", file, "A scene, an image or a film (.qfilm); without it, the devices")->type_name("");
  app.add_flag("--json", json, "Print one JSON object instead of text");
  setUp(app, kExamples);
  if (!parse(app, arguments)) return 0;
  writeFile("-", app.count("FILE") == 0 ? output::devicesInfo(json) : output::fileInfo(file, json));
  return 0;
}

}  // namespace quintet::cli

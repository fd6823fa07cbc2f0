// `quintet info`: devices, a scene, a picture or a film.
#include "info.h"

#include <vector>

#include "base/file.h"
#include "cli.h"
#include "scene/load.h"

namespace quintet::app {
namespace {

constexpr const char* kExamples =
    "  quintet info               every device, and why one cannot be used\n"
    "  quintet info scene.glb     counts, cameras, extensions; what was ignored or repaired\n"
    "  quintet info out.png       size, format, and how Quintet rendered it\n"
    "  quintet info out.exr       layers, channels, types, compression, windows, attributes\n"
    "  quintet info part.qfilm    which samples of which rendering\n"
    "  quintet info --json | jq '.devices[].name'\n";

}  // namespace

int infoCommand(Arguments arguments) {
  CLI::App app("Describes the Vulkan devices, or a scene, a picture or a film.", "quintet info");
  std::string file;
  bool json = false;
  app.add_option("FILE", file, "A scene, a picture or a film (.qfilm); none: the devices")->type_name("");
  app.add_flag("--json", json, "One JSON object instead of text");
  setUp(app, kExamples);
  if (!parse(app, arguments)) return 0;

  std::string text;
  if (app.count("FILE") == 0) {
    text = devicesInfo(json);
  } else {
    const std::vector<std::byte> bytes = readFile(file);
    text = scene::sceneFormat(file, bytes) != scene::SceneFormat::none ? sceneInfo(file, json)
                                                                       : imageInfo(file, bytes, json);
  }
  writeFile("-", text);
  return 0;
}

}  // namespace quintet::app

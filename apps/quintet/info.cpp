// `quintet info`: devices, a scene or a picture.
#include "info.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>
#include <vector>

#include "base/file.h"
#include "cli.h"

namespace quintet::app {
namespace {

constexpr const char* kExamples =
    "  quintet info               every device, and why one cannot be used\n"
    "  quintet info scene.glb     counts, cameras, extensions; what was ignored or repaired\n"
    "  quintet info out.png       size, format, and how Quintet rendered it\n"
    "  quintet info --json | jq '.devices[].name'\n";

// By the name, else by the content: a GLB's magic number, or JSON's brace.
bool isScene(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".gltf" || extension == ".glb") return true;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return text.starts_with("glTF") || (first != std::string_view::npos && text[first] == '{');
}

}  // namespace

int infoCommand(Arguments arguments) {
  CLI::App app("Describes the Vulkan devices, or a scene, or a picture.", "quintet info");
  std::string file;
  bool json = false;
  app.add_option("FILE", file, "A glTF scene or a picture; none: the devices")->type_name("");
  app.add_flag("--json", json, "One JSON object instead of text");
  setUp(app, kExamples);
  if (!parse(app, arguments)) return 0;

  std::string text;
  if (app.count("FILE") == 0) {
    text = devicesInfo(json);
  } else {
    const std::vector<std::byte> bytes = readFile(file);
    text = isScene(file, bytes) ? sceneInfo(file, json) : imageInfo(file, bytes, json);
  }
  writeFile("-", text);
  return 0;
}

}  // namespace quintet::app

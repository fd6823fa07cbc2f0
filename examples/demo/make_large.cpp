// SPDX-License-Identifier: Apache-2.0
// quintet_make_large OUT.glb: writes a scene of ten million triangles, or another number, for measurements of loading.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string_view>

#include <fmt/format.h>

#include "demo/large_scene.h"

namespace {

constexpr const char* kUsage =
    "usage: quintet_make_large OUT.glb [--triangles N] [--meshes M] [--textures K] [--texture-size S] [--normal-maps]\n"
    "Writes a displaced sphere of about N triangles (default 10000000) in M meshes (1), with K base color textures (0) "
    "of "
    "S x S pixels (1024).\n";

bool parse(int argc, char** argv, quintet::demo::LargeSceneOptions& options) {
  for (int i = 2; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (name == "--normal-maps") {
      options.normalMaps = true;
      continue;
    }
    char* end = nullptr;
    const unsigned long value = i + 1 < argc ? std::strtoul(argv[i + 1], &end, 10) : 0;
    if (!end || *end != '\0' || value > 4'000'000'000ul) return false;
    const auto small = static_cast<std::uint32_t>(value);
    if (name == "--triangles")
      options.triangles = value;
    else if (name == "--meshes")
      options.meshes = small;
    else if (name == "--textures")
      options.textures = small;
    else if (name == "--texture-size" && small > 0 && small <= 16384)
      options.textureSize = small;
    else
      return false;
    ++i;
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  quintet::demo::LargeSceneOptions options;
  if (argc < 2 || argv[1][0] == '-' || !parse(argc, argv, options)) {
    std::fputs(kUsage, stderr);
    return 2;
  }
  try {
    fmt::print("{}: {} triangles\n", argv[1], quintet::demo::writeLargeScene(argv[1], options));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "quintet_make_large: %s\n", error.what());
    return 1;
  }
}

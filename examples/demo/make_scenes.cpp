// SPDX-License-Identifier: Apache-2.0
// quintet_make_scenes OUTDIR: writes the scenes of the tests and the benchmark.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>

#include "base/file.h"
#include "demo/test_scenes.h"
#include "io/codec.h"

int main(int argc, char** argv) {
  using namespace quintet;
  if (argc != 2) {
    std::fputs("usage: quintet_make_scenes OUTDIR\nWrites OUTDIR/cornell.glb, glass.glb, …, sky.hdr\n", stderr);
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder);
    for (const demo::TestScene& scene : demo::testScenes()) {
      writeFile(folder / (std::string(scene.name) + ".glb"), scene.make());
    }
    writeFile(folder / "sky.hdr", io::encodeHdr(demo::skyImage(demo::testSky(), 1024, 512)));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "quintet_make_scenes: %s\n", error.what());
    return 1;
  }
}

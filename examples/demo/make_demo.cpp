// SPDX-License-Identifier: Apache-2.0
// quintet_make_demo OUTDIR: writes demo.glb and sky.hdr, the scene and the sky of `make demo`.
#include <cstdio>
#include <exception>
#include <filesystem>

#include "base/file.h"
#include "demo/still_life.h"
#include "io/codec.h"

int main(int argc, char** argv) {
  using namespace quintet;
  if (argc != 2) {
    std::fputs("usage: quintet_make_demo OUTDIR\nWrites OUTDIR/demo.glb and OUTDIR/sky.hdr.\n", stderr);
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder);
    writeFile(folder / "demo.glb", demo::stillLife());
    writeFile(folder / "sky.hdr", io::encodeHdr(demo::skyImage(demo::stillLifeSky(), 1024, 512)));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "quintet_make_demo: %s\n", error.what());
    return 1;
  }
}

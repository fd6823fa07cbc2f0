// SPDX-License-Identifier: Apache-2.0
// quintet_ship_programs FOLDER: compiles the path tracer and the passes of the film for all scenes of triangles, and writes the
// modules as CompilerOptions::shipped needs them. The build runs it, and embeds the folder in the binary. A program, an output
// or a feature that is missing here is compiled at run time.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "base/parallel.h"
#include "program/compile.h"
#include "program/inline_traces.h"
#include "program/load.h"
#include "shader/library.h"

namespace {

using namespace quintet;
using Defines = std::vector<std::pair<std::string, std::string>>;

// The definitions of src/render/scene/scene_features.h that are not specialization constants.
std::vector<Defines> variants() {
  std::vector<Defines> all;
  const Defines triangles = {{"QUINTET_NO_PROCEDURALS", "1"},
                             {"QUINTET_NO_CSG", "1"},
                             {"QUINTET_NO_TORUS", "1"},
                             {"QUINTET_NO_PROCEDURAL_ALPHA", "1"},
                             {"QUINTET_NO_PROCEDURAL_PANES", "1"}};
  for (const bool lavapipe : {false, true})
    for (const bool alpha : {false, true})
      for (const bool transmittance : {false, true})
        for (const bool panes : {false, true}) {  // specialized, but lavapipe uses no ray queries with them
          if (panes && !(lavapipe && transmittance)) continue;
          if (lavapipe && transmittance && !alpha && !panes) continue;  // only alpha or panes tint light
          Defines& defines = all.emplace_back(triangles);
          if (!alpha) defines.emplace_back("QUINTET_NO_SEEDS", "1");
          if (!transmittance) defines.emplace_back("QUINTET_NO_TRANSMITTANCE", "1");
          if (!lavapipe) continue;
          defines.emplace_back("QUINTET_MERGED_INSTANCES", "1");
          if (!panes) defines.emplace_back(program::kInlineTraces, "1");
          defines.emplace_back("QUINTET_CORRUPTS_HIT_ATTRIBUTES", "1");
          if (alpha) defines.emplace_back("QUINTET_RECOMPUTE_BARYCENTRICS", "1");
        }
  return all;
}

std::vector<shader::Source> sources() {
  std::vector<shader::Source> all;
  const program::Program pathtracer = program::loadProgram("<programs/pathtracer>");
  const std::vector<std::string> files = program::stageFiles(pathtracer);
  for (const Defines& defines : variants())
    for (std::size_t i = 0; i < files.size(); ++i)
      all.push_back(program::stageSource(pathtracer, files[i], i, defines, program::Instrumentation::none));
  for (const char* pass : {"film_add", "film_check", "film_mean"}) all.push_back(shader::passSource(pass));
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: quintet_ship_programs FOLDER\n", stderr);
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    const shader::Compiler compiler(shader::CompilerOptions{});
    std::vector<shader::Source> open;
    std::set<Hash> keys;
    for (shader::Source& source : sources())
      if (keys.insert(compiler.shippedKey(source)).second) open.push_back(std::move(source));
    parallelFor(open.size(), [&](std::size_t i) {
      const shader::ShippedModule module = compiler.ship(open[i]);
      writeFile(folder / shader::shippedName(module.key), std::as_bytes(std::span(module.spirv)));
    });
  } catch (const std::exception& error) {
    std::fprintf(stderr, "quintet_ship_programs: %s\n", error.what());
    return 1;
  }
}

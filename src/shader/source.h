// SPDX-License-Identifier: Apache-2.0
// The input of a compilation: the GLSL source of one stage, and the options of the compiler.
#ifndef QUINTET_SHADER_SOURCE_H
#define QUINTET_SHADER_SOURCE_H

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/embedded.h"
#include "shader/stage.h"

namespace quintet::shader {

struct Source {
  Stage stage = Stage::compute;
  std::string text;  // GLSL 460; any other #version is compiled as 460, with a warning
  // Path in diagnostics; #include "…" searches its folder. Files in memory have brackets: "<programs/x.rgen>".
  std::string name;
  std::vector<std::pair<std::string, std::string>> defines;
  // Files in memory by include name, e.g. "quintet/generated/program.glsl"; brackets around the name are optional. They
  // take precedence over all folders. A quoted include among them is first resolved relative to the including file.
  // Diagnostics name them <quintet/generated/program.glsl>.
  std::map<std::string, std::string> virtualFiles;
  bool optimize = true;  // false: without spirv-opt, whatever the options of the compiler are
};

struct CompilerOptions {
  // Folder that overrides the embedded library with its quintet/ folder; $QUINTET_SHADER_PATH if empty.
  std::filesystem::path libraryOverride;
  std::vector<std::filesystem::path> includeFolders;  // additional folders for #include <…>
  std::filesystem::path cacheFolder;                  // of compiled shaders; empty means that they are kept in memory
  bool optimize = true;                               // run spirv-opt
  // Keep sources, lines and names in the SPIR-V. The code is the same; spirv::withoutDebugInfo removes them.
  bool debugInfo = true;
  // Modules that Compiler::ship() has made, by shippedName(), sorted by path. They replace the compilation of sources with
  // their key, with `optimize` only. They have no sources and no lines, and names only of types and global variables.
  std::span<const EmbeddedFile> shipped = {};
};

}  // namespace quintet::shader
#endif

// SPDX-License-Identifier: Apache-2.0
// The shaders of gpu::DrawListRenderer (shaders/window), compiled.
#ifndef QUINTET_VIEWER_WINDOW_SHADERS_H
#define QUINTET_VIEWER_WINDOW_SHADERS_H

#include <cstdint>
#include <filesystem>
#include <vector>

namespace quintet::viewer {

struct WindowShaders {
  std::vector<std::uint32_t> vertex, fragment;  // SPIR-V
};

// `caches`: job::EngineOptions::caches. Throws ProgramError if the compiler rejects them.
WindowShaders compileWindowShaders(const std::filesystem::path& caches);

}  // namespace quintet::viewer
#endif

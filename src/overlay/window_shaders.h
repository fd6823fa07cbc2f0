// SPDX-License-Identifier: Apache-2.0
// The shaders of gpu::DrawListRenderer and gpu::LineRenderer (shaders/window), compiled.
#ifndef QUINTET_OVERLAY_WINDOW_SHADERS_H
#define QUINTET_OVERLAY_WINDOW_SHADERS_H

#include <cstdint>
#include <filesystem>
#include <vector>

namespace quintet::overlay {

struct WindowShaders {
  std::vector<std::uint32_t> vertex, fragment;  // SPIR-V
};

// `caches`: job::EngineOptions::caches. They throw ProgramError if the compiler rejects them.
WindowShaders compileWindowShaders(const std::filesystem::path& caches);  // of gpu::DrawListRenderer
WindowShaders compileLineShaders(const std::filesystem::path& caches);    // of gpu::LineRenderer

}  // namespace quintet::overlay
#endif

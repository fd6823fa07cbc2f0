// SPDX-License-Identifier: Apache-2.0
// The images of a program's parameters on the device. Each takes a slot of the scene's bindless array, after the
// scene's own textures. The shader reads the slot's index as parameters.NAME.
#ifndef QUINTET_RENDER_RENDERER_PARAMETER_TEXTURES_H
#define QUINTET_RENDER_RENDERER_PARAMETER_TEXTURES_H

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "program/description/program.h"
#include "render/scene/texture_upload.h"

namespace quintet::render {

class ParameterTextures {
 public:
  // Reads and uploads the images. `maxMemory`: RenderSettings. Throws FileError for a missing or broken image, MemoryError for
  // one above the limit, and UsageError for too many.
  ParameterTextures(gpu::Context& context, TextureSlots& slots, const program::Program& program,
                    const program::ParameterValues& values, std::size_t maxMemory);
  ~ParameterTextures();
  // Replaces the images by those of other values of the same program, in the same slots. No launch may use them. Throws
  // FileError and MemoryError like the constructor, and then changes nothing.
  void replace(const program::Program& program, const program::ParameterValues& values);
  ParameterTextures(const ParameterTextures&) = delete;
  ParameterTextures& operator=(const ParameterTextures&) = delete;

  // Returns the slots in the order that ParameterValues::pack takes.
  std::span<const std::uint32_t> indices() const { return indices_; }

 private:
  std::deque<gpu::Image> upload(const program::Program& program, const program::ParameterValues& values) const;
  void setTextures();

  gpu::Context& context_;
  std::size_t maxMemory_;
  TextureSlots& slots_;
  std::vector<std::uint32_t> indices_;
  std::deque<gpu::Image> images_;
  gpu::Sampler sampler_;
};

}  // namespace quintet::render
#endif

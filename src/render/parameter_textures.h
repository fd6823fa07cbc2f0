// Pictures of a program's image parameters on the device: each gets a slot of the scene's bindless array, behind the
// scene's own textures; the slot's index is what the shader reads as parameters.NAME.
#ifndef QUINTET_RENDER_PARAMETER_TEXTURES_H
#define QUINTET_RENDER_PARAMETER_TEXTURES_H

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "gpu/descriptors.h"
#include "program/program.h"

namespace quintet::render {

// The slots that a scene keeps free for all renderers that use it.
class TextureSlots {
 public:
  static constexpr std::uint32_t kCount = 64;

  // Slots first … first + count - 1 of a set that outlives this.
  TextureSlots(gpu::BindlessSet& set, std::uint32_t first, std::uint32_t count);

  gpu::BindlessSet& set() { return set_; }
  // Throws UsageError if so many are not free.
  std::vector<std::uint32_t> take(std::size_t count);
  void giveBack(std::span<const std::uint32_t> slots);

 private:
  gpu::BindlessSet& set_;
  std::vector<std::uint32_t> free_;  // the next one last
};

class ParameterTextures {
 public:
  // Reads and uploads the pictures. Throws FileError (missing or broken picture), UsageError (too many).
  ParameterTextures(gpu::Context& context, TextureSlots& slots, const program::Program& program,
                    const program::ParameterValues& values);
  ~ParameterTextures();
  ParameterTextures(const ParameterTextures&) = delete;
  ParameterTextures& operator=(const ParameterTextures&) = delete;

  // For ParameterValues::pack.
  std::span<const std::uint32_t> indices() const { return indices_; }

 private:
  TextureSlots& slots_;
  std::vector<std::uint32_t> indices_;
  std::deque<gpu::Image> images_;
  gpu::Sampler sampler_;
};

}  // namespace quintet::render
#endif

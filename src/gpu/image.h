// SPDX-License-Identifier: Apache-2.0
// 2D images with one view, and samplers. Both can be destroyed at any time, like buffers.
#ifndef QUINTET_GPU_IMAGE_H
#define QUINTET_GPU_IMAGE_H

#include <cstdint>
#include <string>

#include "gpu/context.h"

namespace quintet::gpu {

struct ImageOptions {
  std::uint32_t width = 1;
  std::uint32_t height = 1;
  VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
  VkImageUsageFlags usage = VK_IMAGE_USAGE_SAMPLED_BIT;  // transfer source and destination are always added
  std::string name;
};

// Returns the bytes per pixel; throws UsageError for formats that Quintet does not use.
std::uint32_t bytesPerPixel(VkFormat format);

class Image {
 public:
  Image() = default;
  Image(Context& context, const ImageOptions& options);
  ~Image();
  Image(Image&& other) noexcept;
  Image& operator=(Image&& other) noexcept;

  VkImage handle() const { return handle_; }
  VkImageView view() const { return view_; }
  VkFormat format() const { return options_.format; }
  std::uint32_t width() const { return options_.width; }
  std::uint32_t height() const { return options_.height; }
  VkDeviceSize byteSize() const;  // tightly packed

 private:
  void release();
  Context* context_ = nullptr;
  VkImage handle_ = VK_NULL_HANDLE;
  VkImageView view_ = VK_NULL_HANDLE;
  VmaAllocation allocation_ = VK_NULL_HANDLE;
  ImageOptions options_;
};

struct SamplerOptions {
  VkFilter filter = VK_FILTER_LINEAR;
  VkSamplerAddressMode addressU = VK_SAMPLER_ADDRESS_MODE_REPEAT;
  VkSamplerAddressMode addressV = VK_SAMPLER_ADDRESS_MODE_REPEAT;
  bool operator==(const SamplerOptions&) const = default;
};

class Sampler {
 public:
  Sampler() = default;
  Sampler(Context& context, const SamplerOptions& options);
  ~Sampler();
  Sampler(Sampler&& other) noexcept;
  Sampler& operator=(Sampler&& other) noexcept;
  VkSampler handle() const { return handle_; }

 private:
  void release();
  Context* context_ = nullptr;
  VkSampler handle_ = VK_NULL_HANDLE;
};

}  // namespace quintet::gpu
#endif

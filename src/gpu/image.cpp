// SPDX-License-Identifier: Apache-2.0
#include "gpu/image.h"

#include <utility>

#include <fmt/format.h>

#include "gpu/error.h"
#include "gpu/mebibytes.h"
#include "gpu/vma.h"

namespace quintet::gpu {
namespace {

VkImageCreateInfo createInfo(const ImageOptions& options) {
  VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = options.format;
  info.extent = {options.width, options.height, 1};
  info.mipLevels = 1;
  info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = options.usage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  info.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
  info.initialLayout = VK_IMAGE_LAYOUT_UNDEFINED;
  return info;
}

void validateSize(const Context& context, const ImageOptions& options, VkDeviceSize bytes) {
  const DeviceInfo& device = context.info();
  if (options.width == 0 || options.height == 0 || options.width > device.maxImageSize ||
      options.height > device.maxImageSize)
    throw MemoryError(fmt::format("image '{}' of {} × {} pixels: the device supports 1 to {} pixels per side",
                                  options.name, options.width, options.height, device.maxImageSize));
  if (bytes > device.memoryBytes)
    throw MemoryError(fmt::format("image '{}' of {:.1f} MiB is larger than the device's memory of {:.1f} MiB",
                                  options.name, mebibytes(bytes), mebibytes(device.memoryBytes)));
  context.allocator().checkFreeMemory(bytes, fmt::format("image '{}'", options.name));
}

void validateFormat(const Context& context, const VkImageCreateInfo& info, const std::string& name) {
  VkImageFormatProperties properties{};
  check(vkGetPhysicalDeviceImageFormatProperties(context.physicalDevice(), info.format, info.imageType, info.tiling,
                                                 info.usage, info.flags, &properties),
        "use the format of image", name);
}

}  // namespace

Image::Image(Context& context, const ImageOptions& options) : context_(&context), options_(options) {
  validateSize(context, options, byteSize());
  const VkImageCreateInfo info = createInfo(options);
  validateFormat(context, info, options.name);
  VmaAllocationCreateInfo allocation{};
  allocation.usage = VMA_MEMORY_USAGE_AUTO_PREFER_DEVICE;
  if (context.allocator().needsOwnBlock(byteSize())) allocation.flags = VMA_ALLOCATION_CREATE_DEDICATED_MEMORY_BIT;
  check(vmaCreateImage(context.allocator().handle(), &info, &allocation, &handle_, &allocation_, nullptr),
        fmt::format("allocate {:.1f} MiB for image", mebibytes(byteSize())), options.name);
  context.allocator().track(allocation_, Purpose::textures);

  VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  view.image = handle_;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = options.format;
  view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  const VkResult result = context.vk().vkCreateImageView(context.device(), &view, nullptr, &view_);
  if (result != VK_SUCCESS) release();
  check(result, "create a view of image", options.name);
  context.setName(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<std::uint64_t>(handle_), options.name);
}

Image::~Image() { release(); }

Image::Image(Image&& other) noexcept { *this = std::move(other); }

Image& Image::operator=(Image&& other) noexcept {
  if (this == &other) return *this;
  release();
  context_ = std::exchange(other.context_, nullptr);
  handle_ = std::exchange(other.handle_, VkImage{VK_NULL_HANDLE});
  view_ = std::exchange(other.view_, VkImageView{VK_NULL_HANDLE});
  allocation_ = std::exchange(other.allocation_, nullptr);
  options_ = std::move(other.options_);
  return *this;
}

void Image::release() {
  if (!handle_) return;
  context_->retire([context = context_, handle = handle_, view = view_, allocation = allocation_] {
    context->vk().vkDestroyImageView(context->device(), view, nullptr);
    context->allocator().untrack(allocation);
    vmaDestroyImage(context->allocator().handle(), handle, allocation);
  });
  handle_ = VK_NULL_HANDLE;
  view_ = VK_NULL_HANDLE;
}

VkDeviceSize Image::byteSize() const {
  return VkDeviceSize{options_.width} * options_.height * bytesPerPixel(options_.format);
}

std::uint32_t bytesPerPixel(VkFormat format) {
  switch (format) {
    case VK_FORMAT_R8_UNORM:
    case VK_FORMAT_R8_SRGB:
    case VK_FORMAT_R8_UINT: return 1;
    case VK_FORMAT_R8G8_UNORM:
    case VK_FORMAT_R8G8_SRGB:
    case VK_FORMAT_R16_UNORM:
    case VK_FORMAT_R16_SFLOAT: return 2;
    case VK_FORMAT_R8G8B8A8_UNORM:
    case VK_FORMAT_R8G8B8A8_SRGB:
    case VK_FORMAT_R8G8B8A8_UINT:
    case VK_FORMAT_B8G8R8A8_UNORM:
    case VK_FORMAT_B8G8R8A8_SRGB:
    case VK_FORMAT_R16G16_UNORM:
    case VK_FORMAT_R16G16_SFLOAT:
    case VK_FORMAT_R32_UINT:
    case VK_FORMAT_R32_SFLOAT:
    case VK_FORMAT_E5B9G9R9_UFLOAT_PACK32: return 4;
    case VK_FORMAT_R16G16B16A16_UNORM:
    case VK_FORMAT_R16G16B16A16_SFLOAT:
    case VK_FORMAT_R32G32_UINT:
    case VK_FORMAT_R32G32_SFLOAT: return 8;
    case VK_FORMAT_R32G32B32A32_UINT:
    case VK_FORMAT_R32G32B32A32_SFLOAT: return 16;
    default: throw UsageError(fmt::format("image format {} (VkFormat) is not supported", int{format}));
  }
}

Sampler::Sampler(Context& context, const SamplerOptions& options) : context_(&context) {
  VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  info.magFilter = options.filter;
  info.minFilter = options.filter;
  info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST;
  info.addressModeU = options.addressU;
  info.addressModeV = options.addressV;
  info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  info.maxLod = VK_LOD_CLAMP_NONE;
  check(context.vk().vkCreateSampler(context.device(), &info, nullptr, &handle_), "create a sampler");
}

Sampler::~Sampler() { release(); }

Sampler::Sampler(Sampler&& other) noexcept { *this = std::move(other); }

Sampler& Sampler::operator=(Sampler&& other) noexcept {
  if (this == &other) return *this;
  release();
  context_ = std::exchange(other.context_, nullptr);
  handle_ = std::exchange(other.handle_, VkSampler{VK_NULL_HANDLE});
  return *this;
}

void Sampler::release() {
  if (!handle_) return;
  context_->retire(
      [context = context_, handle = handle_] { context->vk().vkDestroySampler(context->device(), handle, nullptr); });
  handle_ = VK_NULL_HANDLE;
}

}  // namespace quintet::gpu

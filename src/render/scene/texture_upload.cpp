// SPDX-License-Identifier: Apache-2.0
#include "render/scene/texture_upload.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/plural.h"
#include "quintet/shared/material.h"

namespace quintet::render {
namespace {

VkSamplerAddressMode addressMode(scene::Wrap wrap) {
  switch (wrap) {
    case scene::Wrap::repeat: return VK_SAMPLER_ADDRESS_MODE_REPEAT;
    case scene::Wrap::mirroredRepeat: return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
    case scene::Wrap::clampToEdge: return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  }
  return VK_SAMPLER_ADDRESS_MODE_REPEAT;
}

VkFormat textureFormat(io::PixelType type, bool sRgb) {
  switch (type) {
    case io::PixelType::u8: return sRgb ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM;
    case io::PixelType::u16: return VK_FORMAT_R16G16B16A16_UNORM;
    case io::PixelType::f32: return VK_FORMAT_R32G32B32A32_SFLOAT;
  }
  return VK_FORMAT_UNDEFINED;
}

}  // namespace

gpu::Image& addTexture(std::deque<gpu::Image>& textures, gpu::Context& context, gpu::Uploader& uploader,
                       const io::Image& source, bool sRgb, const std::string& name) {
  // Vulkan has no 16-bit sRGB format, so such images are decoded here.
  const bool decoded = sRgb && source.type == io::PixelType::u16;
  const io::Image linear = decoded ? io::toFloat(source) : io::Image{};
  const io::Image& image = decoded ? linear : source;
  gpu::ImageOptions options;
  options.width = image.width;
  options.height = image.height;
  options.format = textureFormat(image.type, sRgb);
  options.name = name;
  gpu::Image& texture = textures.emplace_back(context, options);
  uploader.upload(texture,
                  [&](std::uint32_t first, std::span<std::byte> rows) { io::writeChannels(image, 4, first, rows); });
  return texture;
}

VkDeviceSize textureUploadBytes(const scene::Scene& scene) {
  VkDeviceSize bytes = 0;
  for (const scene::NamedImage& image : scene.images)
    bytes += 4 * image.image.pixelCount() * io::bytesPerSample(image.image.type);
  return bytes;
}

TextureUpload::TextureUpload(gpu::Context& context, gpu::Uploader& uploader, const scene::Scene& scene,
                             scene::Scene* consumed)
    : context_(context), uploader_(uploader), scene_(scene), consumed_(consumed) {}

void TextureUpload::expect(int texture, bool sRgb) {
  const int image = scene_.textures[static_cast<std::size_t>(texture)].image;
  if (image != scene::kNone) expected_.insert({image, sRgb});
}

void TextureUpload::freeImage(int image, bool sRgb) {
  expected_.erase({image, sRgb});
  if (!consumed_ || expected_.contains({image, !sRgb})) return;
  std::vector<std::byte>().swap(consumed_->images[static_cast<std::size_t>(image)].image.data);
}

std::optional<std::uint32_t> TextureUpload::find(int texture, bool sRgb) const {
  const auto known = indexByTexture_.find({texture, sRgb});
  return known == indexByTexture_.end() ? std::nullopt : std::optional(known->second);
}

std::uint32_t TextureUpload::index(int texture, bool sRgb) {
  const auto known = indexByTexture_.find({texture, sRgb});
  if (known != indexByTexture_.end()) return known->second;
  const scene::Texture& t = scene_.textures[static_cast<std::size_t>(texture)];
  if (t.image == scene::kNone) return shared::kNoTexture;
  const gpu::Image*& image = imageByKey_[{t.image, sRgb}];
  if (!image) {
    const scene::NamedImage& source = scene_.images[static_cast<std::size_t>(t.image)];
    if (source.image.empty()) return shared::kNoTexture;
    image = &upload(source.image, sRgb, source.name);
    freeImage(t.image, sRgb);
  }
  gpu::SamplerOptions options;
  options.filter = t.sampler.filter == scene::Filter::nearest ? VK_FILTER_NEAREST : VK_FILTER_LINEAR;
  options.addressU = addressMode(t.sampler.wrapU);
  options.addressV = addressMode(t.sampler.wrapV);
  entries_.push_back({image, &sampler(options)});
  return indexByTexture_[{texture, sRgb}] = count() - 1;
}

std::uint32_t TextureUpload::addEnvironment(const io::Image& image) {
  gpu::SamplerOptions options;
  options.addressV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  entries_.push_back({&upload(image, false, "environment"), &sampler(options)});
  return count() - 1;
}

void TextureUpload::bind(gpu::BindlessSet& set) const {
  for (std::uint32_t i = 0; i < count(); ++i) set.setTexture(i, *entries_[i].image, *entries_[i].sampler);
  if (unused_.image) set.fillTextures(count(), *unused_.image, *unused_.sampler);
}

void TextureUpload::addUnused() {
  io::Image white = io::makeImage(1, 1, 4, io::PixelType::u8, io::ColorEncoding::linear);
  for (std::uint8_t& sample : white.samples<std::uint8_t>()) sample = 255;
  unused_ = {&addTexture(images_, context_, uploader_, white, false, "unused slots"), &sampler({})};
}

const gpu::Image& TextureUpload::upload(const io::Image& source, bool sRgb, const std::string& name) {
  const gpu::Image& image = addTexture(images_, context_, uploader_, source, sRgb, name);
  bytes_ += image.byteSize();
  return image;
}

const gpu::Sampler& TextureUpload::sampler(const gpu::SamplerOptions& options) {
  const auto found =
      std::find_if(samplers_.begin(), samplers_.end(), [&](const auto& entry) { return entry.first == options; });
  if (found != samplers_.end()) return found->second;
  samplers_.emplace_back(options, gpu::Sampler(context_, options));
  return samplers_.back().second;
}

TextureSlots::TextureSlots(gpu::BindlessSet& set, std::uint32_t first, std::uint32_t count) : set_(set) {
  for (std::uint32_t i = count; i > 0; --i) free_.push_back(first + i - 1);
}

std::vector<std::uint32_t> TextureSlots::acquire(std::size_t count) {
  if (count > free_.size())
    throw UsageError(
        fmt::format("not enough texture slots for {}: {} free", counted(count, "image parameter"), free_.size()));
  const std::vector<std::uint32_t> slots(free_.rbegin(), free_.rbegin() + static_cast<std::ptrdiff_t>(count));
  free_.resize(free_.size() - count);
  return slots;
}

void TextureSlots::release(std::span<const std::uint32_t> slots) {
  free_.insert(free_.end(), slots.rbegin(), slots.rend());
}

}  // namespace quintet::render

// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <type_traits>

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "io/codec.h"
#include "scene/gltf/extensions.h"
#include "scene/model/limits.h"
#include "scene/model/material_textures.h"

namespace quintet::scene {
namespace {

Wrap wrapOf(int mode) {
  if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::clampToEdge;
  if (mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return Wrap::mirroredRepeat;
  return Wrap::repeat;
}

Sampler readSampler(const Document& document, int index) {
  if (index == kNone) return {};
  const tinygltf::Sampler& sampler = document.model.samplers[static_cast<std::size_t>(index)];
  return {wrapOf(sampler.wrapS), wrapOf(sampler.wrapT),
          sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST ? Filter::nearest : Filter::linear};
}

// The beginning of an image, far more than the header of a KTX2 file, so that the image is not read twice. The whole image
// in another format.
FileBytes headerOf(const Document& document, const std::string& uri, const std::string& location) {
  constexpr std::size_t kHeader = 65536;
  constexpr std::string_view kKtx = "\xABKTX";
  const FileBytes bytes = document.loadBeginning(uri, location, kHeader);
  const bool isKtx = bytes.size() >= kKtx.size() && std::memcmp(bytes.data(), kKtx.data(), kKtx.size()) == 0;
  return isKtx ? bytes : document.loadUri(uri, location);
}

// Why an image cannot be used, from its header; empty if there is no problem.
std::string headerProblem(const Document& document, int index) {
  const ImageSource& source = document.images[static_cast<std::size_t>(index)];
  const std::string location = fmt::format("/images/{}", index);
  try {
    if (source.bufferView == kNone)
      io::probeImage(headerOf(document, source.uri, location + "/uri"), location);
    else
      io::probeImage(document.view(source.bufferView), location);
  } catch (const FileError& error) {
    return error.problem();
  }
  return {};
}

// Replaces the colors by the roughness 1 - glossiness · alpha. `one` is the sample value of 1.
template <class T>
void toRoughness(io::Image& image, float glossiness, float one) {
  const std::size_t channels = image.channels, colors = image.colorChannels();
  const std::span<T> samples = image.samples<T>();
  for (std::size_t i = 0; i < samples.size(); i += channels) {
    const float alpha = image.hasAlpha() ? static_cast<float>(samples[i + colors]) : one;
    const float roughness = std::max(one - glossiness * alpha, 0.0f);
    std::fill_n(samples.begin() + i, colors, static_cast<T>(std::is_integral_v<T> ? roughness + 0.5f : roughness));
  }
}

void toRoughness(io::Image& image, float glossiness) {
  if (image.type == io::PixelType::u8) toRoughness<std::uint8_t>(image, glossiness, 255.0f);
  if (image.type == io::PixelType::u16) toRoughness<std::uint16_t>(image, glossiness, 65535.0f);
  if (image.type == io::PixelType::f32) toRoughness<float>(image, glossiness, 1.0f);
}

// For each image its bytes in the document, or nothing if another image overlaps them.
std::vector<std::span<const std::byte>> unsharedBytes(const Document& document, std::span<const ImageUse> images) {
  std::vector<std::span<const std::byte>> views(images.size()), unshared(images.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    const int view = document.images[static_cast<std::size_t>(images[i].image)].bufferView;
    if (view != kNone) views[i] = document.bufferViews[static_cast<std::size_t>(view)];
  }
  std::vector<std::size_t> order(images.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return views[i].data(); });
  const std::byte* end = nullptr;  // of all views before this one
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::span<const std::byte> view = views[order[k]];
    const std::byte* next = k + 1 < order.size() ? views[order[k + 1]].data() : nullptr;
    const std::byte* last = view.data() + view.size();
    if (end <= view.data() && (!next || last <= next)) unshared[order[k]] = view;
    end = std::max(end, last);
  }
  return unshared;
}

}  // namespace

NamedImage loadImage(const Document& document, std::size_t index, MemoryBudget& budget) {
  const ImageSource& source = document.images[index];
  const std::string location = fmt::format("/images/{}", index);
  NamedImage result;
  result.name = fmt::format("{}: {}", document.file.filename().string(), location);
  try {
    if (source.bufferView != kNone) {
      result.image = io::decodeImage(document.view(source.bufferView), location, budget);
    } else {
      const FileBytes bytes = document.loadUri(source.uri, location + "/uri");
      if (!isDataUri(source.uri)) result.name = document.pathOfUri(source.uri).string();
      result.image = io::decodeImage(bytes, location, budget);
    }
  } catch (const FileError& error) {
    if (error.file() == document.file) throw;
    // The codec states a location inside the image, which is a part of the scene's file.
    const std::string inside = error.location().empty() ? error.problem() : error.location() + ": " + error.problem();
    document.fail(location,
                  source.uri.empty() || isDataUri(source.uri) ? inside : percentDecode(source.uri) + ": " + inside);
  }
  return result;
}

TextureTable::TextureTable(const Document& document, Report& report) : document_(document), report_(report) {}

int TextureTable::useImage(const ImageUse& use) {
  int& known = indexOfImage_[use];
  if (known == 0) {
    imageUses_.push_back(use);
    known = static_cast<int>(imageUses_.size());
  }
  return known - 1;
}

int TextureTable::chooseImage(int texture) {
  const tinygltf::Texture& from = document_.model.textures[static_cast<std::size_t>(texture)];
  if (const tinygltf::Value* webp = findExtension(from.extensions, kTextureWebp)) return indexOf(*webp, "source");
  if (const tinygltf::Value* basisu = findExtension(from.extensions, kTextureBasisu)) {
    const int image = indexOf(*basisu, "source");
    // Without a fallback, an image that is missing, invalid or not supported is an error when it is decoded.
    if (from.source == kNone) return image;
    const std::string problem = headerProblem(document_, image);
    if (problem.empty()) return image;
    report_.ignored.push_back(fmt::format("/textures/{}/extensions/{}: {}; replaced by the fallback /images/{}",
                                          texture, kTextureBasisu, problem, from.source));
    return from.source;
  }
  if (from.source == kNone) problems_.emplace(texture, "no image in a supported format (PNG, JPEG, WebP, KTX2)");
  return from.source;
}

int TextureTable::use(int texture, const std::string& location, std::optional<float> glossiness) {
  const auto found = indexOfTexture_.find({texture, glossiness});
  if (found != indexOfTexture_.end()) return found->second;
  const tinygltf::Texture& from = document_.model.textures[static_cast<std::size_t>(texture)];
  const int image = chooseImage(texture);
  if (image == kNone) {
    report_.ignored.push_back(fmt::format("{}: texture {} has {}", location, texture, problems_.at(texture)));
    return kNone;
  }
  used_.insert(texture);
  const auto index = static_cast<int>(textures_.size());
  textures_.push_back({from.name, useImage({image, glossiness}), readSampler(document_, from.sampler)});
  indexOfTexture_.emplace(ImageUse{texture, glossiness}, index);
  return index;
}

bool describeImages(const Document& document, std::span<const ImageUse> uses, std::vector<NamedImage>& images) {
  images.resize(uses.size());
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const int view = document.images[static_cast<std::size_t>(uses[i].image)].bufferView;
    if (view == kNone) return false;
    try {
      const io::ImageInfo info = io::probeImage(document.view(view), "image");
      io::Image& image = images[i].image;
      image.width = info.width;
      image.height = info.height;
      image.channels = info.channels;
      image.type = info.type;
    } catch (const FileError&) {
      return false;  // decodeImages reports it
    }
  }
  return true;
}

std::vector<ImageFailure> decodeImages(const Document& document, std::span<const ImageUse> uses,
                                       std::vector<NamedImage>& images, std::vector<std::string>& repaired,
                                       MemoryBudget& budget) {
  images.resize(uses.size());
  std::vector<std::string> repairs(uses.size());
  std::vector<ImageFailure> failures(uses.size());
  const std::vector<std::span<const std::byte>> unshared = unsharedBytes(document, uses);
  parallelFor(uses.size(), [&](std::size_t i) {
    try {
      images[i] = loadImage(document, static_cast<std::size_t>(uses[i].image), budget);
      repairs[i] = repairImage(document, uses[i].image, images[i].image);
      if (uses[i].glossiness) toRoughness(images[i].image, *uses[i].glossiness);
    } catch (const FileError& error) {
      images[i] = {};
      failures[i] = {i, error.location(), error.problem(),
                     error.remedy() == Remedy::none ? Remedy::omitTextures : error.remedy()};
    }
    releasePages(unshared[i]);
  });
  std::erase_if(failures, [](const ImageFailure& failure) { return failure.problem.empty(); });
  for (std::string& line : repairs)
    if (!line.empty() && std::ranges::find(repaired, line) == repaired.end()) repaired.push_back(std::move(line));
  return failures;
}

std::string repairImage(const Document& document, int image, io::Image& pixels) {
  const std::string repair = repairTexels(pixels);
  if (repair.empty()) return {};
  const std::string& uri = document.images[static_cast<std::size_t>(image)].uri;
  const std::string name = uri.empty() || isDataUri(uri) ? "" : percentDecode(uri) + ": ";
  return fmt::format("/images/{}: {}{}", image, name, repair);
}

void removeTextures(Scene& scene, int image, std::optional<float> glossiness) {
  for (Material& material : scene.materials)
    for (const MaterialTexture& texture : kMaterialTextures) {
      TextureUse& use = material.*texture.use;
      if (!use.used() || scene.textures[static_cast<std::size_t>(use.texture)].image != image) continue;
      use = {};
      if (texture.use == &Material::metallicRoughnessTexture && glossiness) material.roughness = 1.0f - *glossiness;
    }
  NamedImage& removed = scene.images[static_cast<std::size_t>(image)];
  removed.name = "missing";
  removed.image = {};
  removed.image.width = removed.image.height = removed.image.channels = 1;
  removed.image.data.assign(1, std::byte{255});
}

}  // namespace quintet::scene

// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "io/codec.h"
#include "scene/gltf/extensions.h"

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

io::Image decode(std::span<const std::byte> bytes, const std::string& location, MemoryBudget& budget) {
  const io::ImageInfo info = io::probeImage(bytes, location);
  budget.take(std::size_t{info.width} * info.height * info.channels * io::bytesPerSample(info.type));
  return io::decodeImage(bytes, location);
}

NamedImage loadImage(const Document& document, std::size_t index, MemoryBudget& budget) {
  const ImageSource& source = document.images[index];
  const std::string location = fmt::format("/images/{}", index);
  NamedImage result;
  result.name = fmt::format("{}: {}", document.file.filename().string(), location);
  try {
    if (source.bufferView != kNone) {
      result.image = decode(document.view(source.bufferView), location, budget);
    } else {
      const FileBytes bytes = document.loadUri(source.uri, location + "/uri");
      if (!isDataUri(source.uri)) result.name = document.pathOfUri(source.uri).string();
      result.image = decode(bytes, location, budget);
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

// For each image its bytes in the document, or nothing if another image overlaps them.
std::vector<std::span<const std::byte>> unsharedBytes(const Document& document, std::span<const int> images) {
  std::vector<std::span<const std::byte>> views(images.size()), unshared(images.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    const int view = document.images[static_cast<std::size_t>(images[i])].bufferView;
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

TextureTable::TextureTable(const Document& document, Report& report)
    : document_(document),
      report_(report),
      textureOf_(document.model.textures.size(), kNone),
      imageOf_(document.images.size(), kNone) {}

int TextureTable::useImage(int image) {
  int& known = imageOf_[static_cast<std::size_t>(image)];
  if (known == kNone) {
    known = static_cast<int>(imageSources_.size());
    imageSources_.push_back(image);
  }
  return known;
}

int TextureTable::use(int texture, const std::string& location) {
  int& known = textureOf_[static_cast<std::size_t>(texture)];
  if (known != kNone) return known;
  const tinygltf::Texture& from = document_.model.textures[static_cast<std::size_t>(texture)];
  const tinygltf::Value* webp = findExtension(from.extensions, kTextureWebp);
  const int image = webp ? indexOf(*webp, "source") : from.source;
  if (image == kNone) {
    report_.ignored.push_back(
        fmt::format("{}: texture {} has no image in a supported format (PNG, JPEG, WebP)", location, texture));
    return kNone;
  }
  known = static_cast<int>(textures_.size());
  textures_.push_back({from.name, useImage(image), readSampler(document_, from.sampler)});
  return known;
}

bool describeImages(const Document& document, std::span<const int> imageSources, std::vector<NamedImage>& images) {
  images.resize(imageSources.size());
  for (std::size_t i = 0; i < imageSources.size(); ++i) {
    const int view = document.images[static_cast<std::size_t>(imageSources[i])].bufferView;
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

void decodeImages(const Document& document, std::span<const int> imageSources, std::vector<NamedImage>& images,
                  MemoryBudget& budget) {
  images.resize(imageSources.size());
  const std::vector<std::span<const std::byte>> unshared = unsharedBytes(document, imageSources);
  parallelFor(imageSources.size(), [&](std::size_t i) {
    images[i] = loadImage(document, static_cast<std::size_t>(imageSources[i]), budget);
    releasePages(unshared[i]);
  });
}

}  // namespace quintet::scene

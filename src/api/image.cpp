// SPDX-License-Identifier: Apache-2.0
// Images of the public API: access to pixels, and files.
#include <algorithm>
#include <cctype>
#include <cstring>

#include <fmt/format.h>

#include <quintet/quintet.h>

#include "base/file.h"
#include "io/codec.h"
#include "render/tone_map/tone_map.h"

namespace quintet {
namespace {

io::Image toIoImage(const Image& image) {
  const std::size_t expected = std::size_t{4} * image.width * image.height;
  if (image.pixels.size() != expected)
    throw UsageError(fmt::format("an image of {}x{} has {} floats, not {}", image.width, image.height, expected,
                                 image.pixels.size()));
  io::Image result = io::makeImage(image.width, image.height, 4, io::PixelType::f32, io::ColorEncoding::linear);
  result.premultiplied = true;
  std::memcpy(result.data.data(), image.pixels.data(), result.data.size());
  return result;
}

}  // namespace

std::array<float, 4> Image::at(std::uint32_t x, std::uint32_t y) const {
  if (x >= width || y >= height)
    throw UsageError(fmt::format("pixel ({}, {}) is outside of the image of {}x{}", x, y, width, height));
  const float* p = &pixels[4 * (std::size_t{y} * width + x)];
  return {p[0], p[1], p[2], p[3]};
}

void Image::write(const std::filesystem::path& file) const {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const render::ToneMap operation = toneMap ? render::ToneMap::neutral : render::ToneMap::linear;
  if (extension == ".png")
    return writeFile(file, io::encodePng(render::toDisplay(toIoImage(*this), operation, 0.0f, true), {}));
  if (extension == ".exr") return writeFile(file, io::encodeExr(toIoImage(*this), {}));
  if (extension == ".hdr") return writeFile(file, io::encodeHdr(toIoImage(*this)));
  throw UsageError(fmt::format("{}: the extension must be .png, .exr or .hdr", file.string()));
}

}  // namespace quintet

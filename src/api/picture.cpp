#include <algorithm>
#include <cctype>
#include <cstring>

#include <fmt/format.h>

#include "api/impl.h"
#include "base/file.h"
#include "io/codec.h"
#include "render/tone_map.h"

namespace quintet {
namespace {

io::Image toImage(const Picture& picture) {
  if (picture.pixels.size() != std::size_t{4} * picture.width * picture.height)
    throw UsageError(
        fmt::format("a picture of {}x{} with {} floats", picture.width, picture.height, picture.pixels.size()));
  io::Image image = io::makeImage(picture.width, picture.height, 4, io::PixelType::f32, io::ColorEncoding::linear);
  image.premultiplied = true;
  std::memcpy(image.data.data(), picture.pixels.data(), image.data.size());
  return image;
}

}  // namespace

std::array<float, 4> Picture::at(std::uint32_t x, std::uint32_t y) const {
  if (x >= width || y >= height)
    throw UsageError(fmt::format("pixel ({}, {}) of a picture of {}x{}", x, y, width, height));
  const float* p = &pixels[4 * (std::size_t{y} * width + x)];
  return {p[0], p[1], p[2], p[3]};
}

void Picture::write(const std::filesystem::path& file) const {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const render::ToneMap operation = toneMap ? render::ToneMap::neutral : render::ToneMap::linear;
  if (extension == ".png")
    return writeFile(file, io::encodePng(render::toDisplay(toImage(*this), operation, 0.0f, true), {}));
  if (extension == ".exr") return writeFile(file, io::encodeExr(toImage(*this), {}));
  if (extension == ".hdr") return writeFile(file, io::encodeHdr(toImage(*this)));
  throw UsageError(fmt::format("{}: the extension must be .png, .exr or .hdr", file.string()));
}

}  // namespace quintet

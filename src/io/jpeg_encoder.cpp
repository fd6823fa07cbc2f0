// SPDX-License-Identifier: Apache-2.0
#include "io/jpeg_encoder.h"

#include <turbojpeg.h>

#include <cstdint>
#include <memory>
#include <new>

#include "base/error.h"

namespace quintet::io {

std::vector<std::byte> encodeJpeg(const Image& image, int quality) {
  constexpr std::uint32_t kMaxSide = 65500;
  // Such an image is displayed enlarged, where half the resolution of its colors would be visible.
  constexpr std::uint64_t kSmallPixels = 320 * 180;
  if (image.empty() || image.type != PixelType::u8 || image.width > kMaxSide || image.height > kMaxSide)
    throw UsageError("JPEG stores 8 bit samples of images with 1 to 65500 pixels per side");
  const Image opaque = image.hasAlpha() ? toChannels(image, image.colorChannels()) : Image();
  const Image& source = image.hasAlpha() ? opaque : image;
  const std::unique_ptr<void, decltype(&tjDestroy)> encoder(tjInitCompress(), &tjDestroy);
  if (!encoder) throw std::bad_alloc();
  const bool gray = source.channels == 1;
  const bool isSmall = std::uint64_t{source.width} * source.height <= kSmallPixels;
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const int failed = tjCompress2(encoder.get(), reinterpret_cast<const unsigned char*>(source.data.data()),
                                 static_cast<int>(source.width), 0, static_cast<int>(source.height),
                                 gray ? TJPF_GRAY : TJPF_RGB, &bytes, &size,
                                 gray      ? TJSAMP_GRAY
                                 : isSmall ? TJSAMP_444
                                           : TJSAMP_420,
                                 quality, 0);
  const std::unique_ptr<unsigned char, decltype(&tjFree)> owner(bytes, &tjFree);
  if (failed != 0) throw Error(tjGetErrorStr2(encoder.get()));
  const auto* begin = reinterpret_cast<const std::byte*>(bytes);
  return {begin, begin + size};
}

}  // namespace quintet::io

// SPDX-License-Identifier: Apache-2.0
// An image in host memory and conversions between sample types, encodings and channel counts. Rows run from top to
// bottom, pixels are tightly packed, samples are in host byte order. Channels are gray, gray + alpha, RGB or RGBA with
// Rec. 709 primaries. Alpha is coverage in [0,1] and always linear.
#ifndef QUINTET_IO_IMAGE_H
#define QUINTET_IO_IMAGE_H

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace quintet::io {

inline constexpr std::uint32_t kMaxImageSide = 65536;                // pixels
inline constexpr std::size_t kMaxImageBytes = std::size_t{1} << 30;  // of a decoded image

// u8 and u16 are unsigned normalized: 255 or 65535 represent 1.
enum class PixelType : std::uint8_t { u8, u16, f32 };
enum class ColorEncoding : std::uint8_t { sRgb, linear };

std::size_t bytesPerSample(PixelType type);

struct Image {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t channels = 0;  // 1 … 4
  PixelType type = PixelType::u8;
  ColorEncoding encoding = ColorEncoding::sRgb;
  std::vector<std::byte> data;  // height · rowBytes()
  // True if color is premultiplied by alpha (EXR), false if alpha is straight (PNG, WebP).
  bool premultiplied = false;

  bool empty() const { return data.empty(); }
  bool hasAlpha() const { return channels == 2 || channels == 4; }
  std::uint32_t colorChannels() const { return channels <= 2 ? 1u : 3u; }
  std::size_t pixelCount() const { return static_cast<std::size_t>(width) * height; }
  std::size_t sampleCount() const { return pixelCount() * channels; }
  std::size_t rowBytes() const { return static_cast<std::size_t>(width) * channels * bytesPerSample(type); }

  // All samples. T is std::uint8_t, std::uint16_t or float and must match `type`.
  template <class T>
  std::span<T> samples() {
    checkType<T>();
    return {reinterpret_cast<T*>(data.data()), sampleCount()};
  }
  template <class T>
  std::span<const T> samples() const {
    checkType<T>();
    return {reinterpret_cast<const T*>(data.data()), sampleCount()};
  }
  // The `channels` samples of one pixel. (0,0) is the top left pixel.
  template <class T>
  std::span<T> pixel(std::uint32_t x, std::uint32_t y) {
    return samples<T>().subspan(offset(x, y), channels);
  }
  template <class T>
  std::span<const T> pixel(std::uint32_t x, std::uint32_t y) const {
    return samples<T>().subspan(offset(x, y), channels);
  }

 private:
  template <class T>
  void checkType() const {
    static_assert(std::is_same_v<T, std::uint8_t> || std::is_same_v<T, std::uint16_t> || std::is_same_v<T, float>);
    assert(type == (std::is_same_v<T, float> ? PixelType::f32 : sizeof(T) == 2 ? PixelType::u16 : PixelType::u8));
    assert(data.size() == sampleCount() * sizeof(T));
  }
  std::size_t offset(std::uint32_t x, std::uint32_t y) const {
    assert(x < width && y < height);
    return (static_cast<std::size_t>(y) * width + x) * channels;
  }
};

// Properties of an image file as its header states them.
struct ImageInfo {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t channels = 0;  // of the decoded image
  PixelType type = PixelType::u8;
  std::string_view format;  // "PNG", "JPEG", "WebP", "Radiance HDR", "OpenEXR", "KTX2"
  // Bytes that decoding needs for a while, besides the file and the decoded image; less than 1 MiB does not count.
  std::size_t temporaryBytes = 0;
  std::size_t byteCount() const {  // of the decoded image
    return std::size_t{width} * height * channels * bytesPerSample(type);
  }
};

// Keywords and texts in the order of the file. Keywords have 1 to 79 bytes of printable ASCII; texts are UTF-8.
using Metadata = std::vector<std::pair<std::string, std::string>>;

// Returns an image with all samples 0.
Image makeImage(std::uint32_t width, std::uint32_t height, std::uint32_t channels, PixelType type,
                ColorEncoding encoding);

// Converts to linear floats; sRGB-encoded samples are decoded. Alpha stays premultiplied or straight.
Image toFloat(const Image& image);

// The same for samples that are encoded by a power instead of the sRGB curve: color becomes sample^gamma. Images that are
// linear already stay as they are.
Image decodePower(const Image& image, float gamma);

// Converts to sRGB-encoded bytes with straight alpha, without tone mapping. Values are clamped to [0,1]; NaN becomes 0.
Image toSrgb8(const Image& image);

// Converts to a different number of channels; type and encoding stay. Gray is repeated, missing alpha is 1, RGB becomes
// gray by its luminance (Rec. 709 weights, linear light), and alpha is dropped for 1 and 3 channels.
Image toChannels(const Image& image, std::uint32_t channels);

// Writes the rows from `first` on with `channels` channels to `rows`, whose size must be a multiple of the row size.
// Runs on all cores.
void writeChannels(const Image& image, std::uint32_t channels, std::uint32_t first, std::span<std::byte> rows);

// Converts to linear floats and multiplies color by alpha.
Image toPremultiplied(const Image& image);

// Resizes with a box filter of exact pixel areas in linear light with premultiplied alpha, which preserves the mean.
// The result has linear floats, and straight alpha if the input has. Throws UsageError if a size is 0.
Image resizeBox(const Image& image, std::uint32_t width, std::uint32_t height);

// Resizes the image with more pixels to the size of the other one. Images of the same size stay as they are.
void resizeToSmaller(Image& a, Image& b);

}  // namespace quintet::io
#endif

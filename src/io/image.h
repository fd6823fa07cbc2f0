// A picture in host memory, and the conversions between its forms. Rows run top to bottom, pixels are
// tightly packed, samples are in host byte order. Channels: 1 grey, 2 grey + alpha, 3 RGB, 4 RGBA;
// Rec. 709 primaries. Alpha is coverage in [0,1], never under the sRGB curve.
#ifndef QUINTET_IO_IMAGE_H
#define QUINTET_IO_IMAGE_H

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace quintet::io {

// u8 and u16 are unsigned normalised: 255 or 65535 stand for 1.
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
  // True: colour is already multiplied by alpha (the rule in EXR). False: straight (PNG, WebP).
  bool premultiplied = false;

  bool empty() const { return data.empty(); }
  bool hasAlpha() const { return channels == 2 || channels == 4; }
  std::uint32_t colorChannels() const { return channels <= 2 ? 1u : 3u; }
  std::size_t pixelCount() const { return static_cast<std::size_t>(width) * height; }
  std::size_t sampleCount() const { return pixelCount() * channels; }
  std::size_t rowBytes() const { return static_cast<std::size_t>(width) * channels * bytesPerSample(type); }

  // All samples; T is std::uint8_t, std::uint16_t or float and must be what `type` says.
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
  // The `channels` samples of one pixel; (0,0) is the top left.
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

// All samples 0.
Image makeImage(std::uint32_t width, std::uint32_t height, std::uint32_t channels, PixelType type,
                ColorEncoding encoding);

// Linear floats: the sRGB curve is undone where `encoding` says so. Alpha stays premultiplied or straight.
Image toFloat(const Image& image);

// sRGB-encoded bytes with straight alpha; values outside [0,1] are clamped, NaN gives 0. No tone mapping.
Image toSrgb8(const Image& image);

// The same picture with another channel count; type and encoding stay. Grey is repeated; missing alpha
// is 1; RGB becomes grey by its luminance (Rec. 709 weights, linear light); alpha that does not fit is dropped.
Image toChannels(const Image& image, std::uint32_t channels);

// The same, but only the rows from `first` on, as many as `rows` has room for; `rows` holds whole ones. On all cores.
void writeChannels(const Image& image, std::uint32_t channels, std::uint32_t first, std::span<std::byte> rows);

// Colour times alpha, in linear floats. No alpha: only toFloat.
Image toPremultiplied(const Image& image);

// Resampled by exact pixel areas (box filter), in linear light with premultiplied alpha, so that mean
// values are kept; straight input gives straight output. Linear floats. Throws UsageError if a size is 0.
Image resizeBox(const Image& image, std::uint32_t width, std::uint32_t height);

}  // namespace quintet::io
#endif

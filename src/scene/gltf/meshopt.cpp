// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/meshopt.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <vector>

namespace quintet::scene {
namespace {

constexpr std::byte kVersion1{0xA1};
constexpr std::size_t kGroup = 16, kLeastTail = 24, kBlockBytes = 8192, kMostElements = 256;

// The bytes of a stream that are not read yet.
class StreamBytes {
 public:
  explicit StreamBytes(std::span<const std::byte> bytes) : bytes_(bytes) {}
  bool has(std::size_t count) const { return count <= bytes_.size(); }
  bool empty() const { return bytes_.empty(); }
  std::span<const std::byte> take(std::size_t count) {
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }

 private:
  std::span<const std::byte> bytes_;
};

// Reads 16 differences of `bits` bits (1, 2 or 4). The largest number stands for a byte that follows.
bool readGroup(StreamBytes& stream, std::uint32_t bits, std::uint8_t* differences) {
  const std::size_t size = 2 * bits, perByte = 8 / bits;
  if (!stream.has(size)) return false;
  const auto packed = stream.take(size);
  const std::uint32_t largest = (1u << bits) - 1;
  for (std::size_t i = 0; i < kGroup; ++i) {
    // Single bits start with the lowest one, others with the highest ones.
    const std::size_t slot = bits == 1 ? i % perByte : perByte - 1 - i % perByte;
    const std::uint32_t value = std::to_integer<std::uint32_t>(packed[i / perByte]) >> (slot * bits) & largest;
    differences[i] = static_cast<std::uint8_t>(value);
    if (value != largest) continue;
    if (!stream.has(1)) return false;
    differences[i] = std::to_integer<std::uint8_t>(stream.take(1)[0]);
  }
  return true;
}

// Reads the differences of one byte of `count` elements.
bool readDifferences(StreamBytes& stream, std::uint32_t control, std::size_t count,
                     std::array<std::uint8_t, kMostElements>& differences) {
  constexpr std::uint32_t kZero = 2, kRaw = 3;
  constexpr std::uint32_t kBits[2][4] = {{0, 1, 2, 4}, {1, 2, 4, 8}};
  if (control == kZero) {
    std::fill_n(differences.begin(), count, std::uint8_t{0});
    return true;
  }
  const auto copy = [&](std::size_t first, std::size_t bytes) {
    if (!stream.has(bytes)) return false;
    std::memcpy(differences.data() + first, stream.take(bytes).data(), bytes);
    return true;
  };
  if (control == kRaw) return copy(0, count);
  const std::size_t groups = (count + kGroup - 1) / kGroup, headerSize = (groups + 3) / 4;
  if (!stream.has(headerSize)) return false;
  const auto header = stream.take(headerSize);
  for (std::size_t g = 0; g < groups; ++g) {
    const std::uint32_t bits = kBits[control][std::to_integer<std::uint32_t>(header[g / 4]) >> (2 * (g % 4)) & 3];
    if (bits == 0)
      std::fill_n(differences.begin() + static_cast<std::ptrdiff_t>(kGroup * g), kGroup, std::uint8_t{0});
    else if (bits == 8 ? !copy(kGroup * g, kGroup) : !readGroup(stream, bits, differences.data() + kGroup * g))
      return false;
  }
  return true;
}

template <class T>
T unfold(T value) {  // 0, 1, 2, 3, … become 0, -1, 1, -2, …
  return static_cast<T>((value & 1) != 0 ? ~(value >> 1) : value >> 1);
}

// Turns differences into values, for each T of a channel of four bytes. `previous`: those of the last element.
template <class T, class Apply>
void addDifferences(std::byte* channel, std::size_t count, std::size_t stride, std::byte* previous, Apply apply) {
  for (std::size_t part = 0; part < 4; part += sizeof(T)) {
    T value;
    std::memcpy(&value, previous + part, sizeof value);
    for (std::size_t i = 0; i < count; ++i) {
      std::byte* at = channel + i * stride + part;
      T difference;
      std::memcpy(&difference, at, sizeof difference);
      value = apply(value, difference);
      std::memcpy(at, &value, sizeof value);
    }
    std::memcpy(previous + part, &value, sizeof value);
  }
}

void addDifferences(std::uint32_t mode, std::byte* channel, std::size_t count, std::size_t stride,
                    std::byte* previous) {
  const auto sum = [](auto a, auto b) { return static_cast<decltype(a)>(a + unfold(b)); };
  const auto rotation = static_cast<int>(mode >> 4);
  switch (mode & 15) {
    case 0: return addDifferences<std::uint8_t>(channel, count, stride, previous, sum);
    case 1: return addDifferences<std::uint16_t>(channel, count, stride, previous, sum);
    default:
      return addDifferences<std::uint32_t>(
          channel, count, stride, previous,
          [rotation](std::uint32_t a, std::uint32_t b) { return a ^ std::rotr(b, rotation); });
  }
}

bool isValidMode(std::byte mode) { return (mode & std::byte{15}) == std::byte{2} || mode <= std::byte{1}; }

template <class T>
void decodeColors(std::span<std::byte> elements) {
  constexpr int kMax = std::numeric_limits<T>::max();
  for (std::size_t at = 0; at < elements.size(); at += 4 * sizeof(T)) {
    std::array<T, 4> in{}, out{};
    std::memcpy(in.data(), elements.data() + at, sizeof in);
    // The highest bit of alpha states the number of bits.
    const int bits = std::bit_width(in[3]), largest = (1 << bits) - 1;
    const auto asSigned = [](T value) { return int{static_cast<std::make_signed_t<T>>(value)}; };
    const int y = in[0], co = asSigned(in[1]), cg = asSigned(in[2]), alpha = in[3] & (largest >> 1);
    const std::array<int, 4> rgba{y + co - cg, y + cg, y - co - cg, alpha << 1 | (alpha & 1)};
    for (std::size_t c = 0; c < 4 && bits > 0; ++c) {
      const double value = static_cast<double>(rgba[c]) * kMax / largest + 0.5;
      out[c] = static_cast<T>(std::clamp(value, 0.0, static_cast<double>(kMax)));
    }
    std::memcpy(elements.data() + at, out.data(), sizeof out);
  }
}

}  // namespace

bool isMeshoptVersion1(std::span<const std::byte> stream) { return !stream.empty() && stream[0] == kVersion1; }

bool decodeMeshoptVersion1(std::span<std::byte> elements, std::size_t stride, std::span<const std::byte> stream) {
  const std::size_t channels = stride / 4, tail = stride + channels, tailSize = std::max(tail, kLeastTail);
  if (!isMeshoptVersion1(stream) || stream.size() < 1 + tailSize) return false;
  const auto tailBytes = stream.last(tail);
  std::vector<std::byte> previous(tailBytes.begin(), tailBytes.begin() + static_cast<std::ptrdiff_t>(stride));
  const auto modes = tailBytes.last(channels);
  if (!std::ranges::all_of(modes, isValidMode)) return false;

  StreamBytes data(stream.subspan(1, stream.size() - 1 - tailSize));
  const std::size_t count = elements.size() / stride;
  const std::size_t most = std::min(kBlockBytes / stride / kGroup * kGroup, kMostElements);
  std::array<std::uint8_t, kMostElements> differences{};
  for (std::size_t first = 0; first < count; first += most) {
    const std::size_t here = std::min(most, count - first);
    std::byte* const block = elements.data() + first * stride;
    if (!data.has(channels)) return false;
    const auto controls = data.take(channels);
    for (std::size_t k = 0; k < stride; ++k) {
      const std::uint32_t control = std::to_integer<std::uint32_t>(controls[k / 4]) >> (2 * (k % 4)) & 3;
      if (!readDifferences(data, control, here, differences)) return false;
      for (std::size_t i = 0; i < here; ++i) block[i * stride + k] = static_cast<std::byte>(differences[i]);
    }
    for (std::size_t c = 0; c < channels; ++c)
      addDifferences(std::to_integer<std::uint32_t>(modes[c]), block + 4 * c, here, stride, previous.data() + 4 * c);
  }
  return data.empty();
}

void decodeMeshoptColors(std::span<std::byte> elements, std::size_t stride) {
  if (stride == 4)
    decodeColors<std::uint8_t>(elements);
  else
    decodeColors<std::uint16_t>(elements);
}

}  // namespace quintet::scene

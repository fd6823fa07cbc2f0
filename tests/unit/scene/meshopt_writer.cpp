// SPDX-License-Identifier: Apache-2.0
#include "scene/meshopt_writer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace quintet::test {
namespace {

using Stream = std::vector<unsigned char>;

// The difference that the codec stores for a channel of four bytes.
std::uint32_t differenceOf(std::uint32_t value, std::uint32_t previous, unsigned char mode) {
  if (mode % 16 == 2) return std::rotl(value ^ previous, mode / 16);
  const std::uint32_t bits = mode == 0 ? 8 : 16, mask = (1u << bits) - 1;
  std::uint32_t result = 0;
  for (std::uint32_t shift = 0; shift < 32; shift += bits) {
    const std::uint32_t difference = ((value >> shift) - (previous >> shift)) & mask;
    const bool negative = difference >> (bits - 1) != 0;
    result |= ((negative ? ~(difference << 1) : difference << 1) & mask) << shift;
  }
  return result;
}

void writeGroup(Stream& stream, const unsigned char* bytes, std::uint32_t bits) {
  if (bits == 0) return;
  if (bits == 8) {
    stream.insert(stream.end(), bytes, bytes + 16);
    return;
  }
  const std::uint32_t largest = (1u << bits) - 1, perByte = 8 / bits;
  Stream packed(2 * bits), others;
  for (std::uint32_t i = 0; i < 16; ++i) {
    const std::uint32_t value = std::min<std::uint32_t>(bytes[i], largest);
    if (value == largest) others.push_back(bytes[i]);
    const std::uint32_t slot = bits == 1 ? i % 8 : perByte - 1 - i % perByte;
    packed[i / perByte] = static_cast<unsigned char>(packed[i / perByte] | value << (slot * bits));
  }
  stream.insert(stream.end(), packed.begin(), packed.end());
  stream.insert(stream.end(), others.begin(), others.end());
}

}  // namespace

std::vector<unsigned char> writeMeshoptVersion1(const std::vector<unsigned char>& elements, std::size_t stride,
                                                const std::vector<unsigned char>& modes, std::mt19937& random) {
  constexpr std::uint32_t kBits[2][4] = {{0, 1, 2, 4}, {1, 2, 4, 8}};
  const std::size_t count = elements.size() / stride, most = std::min<std::size_t>(8192 / stride / 16 * 16, 256);
  Stream baseline(stride);
  for (unsigned char& byte : baseline) byte = static_cast<unsigned char>(random());
  Stream previous = baseline, stream{0xA1};
  for (std::size_t first = 0; first < count; first += most) {
    const std::size_t here = std::min(most, count - first), rounded = (here + 15) / 16 * 16;
    std::vector<Stream> columns(stride, Stream(rounded));  // differences, by byte of the element
    for (std::size_t i = 0; i < here; ++i)
      for (std::size_t c = 0; c < stride; c += 4) {
        std::uint32_t value = 0, last = 0;
        std::memcpy(&value, elements.data() + (first + i) * stride + c, 4);
        std::memcpy(&last, previous.data() + c, 4);
        std::memcpy(previous.data() + c, &value, 4);
        const std::uint32_t difference = differenceOf(value, last, modes[c / 4]);
        for (std::size_t k = 0; k < 4; ++k) columns[c + k][i] = static_cast<unsigned char>(difference >> (8 * k));
      }
    Stream controls(stride / 4), data;
    for (std::size_t k = 0; k < stride; ++k) {
      const Stream& column = columns[k];
      const auto isZero = [](auto begin, auto end) { return std::all_of(begin, end, [](int v) { return v == 0; }); };
      std::uint32_t control = random() % 4;
      if (control == 2 && !isZero(column.begin(), column.end())) control = 1;
      controls[k / 4] = static_cast<unsigned char>(controls[k / 4] | control << (2 * (k % 4)));
      if (control == 3) data.insert(data.end(), column.begin(), column.begin() + static_cast<std::ptrdiff_t>(here));
      if (control >= 2) continue;
      Stream header((rounded / 16 + 3) / 4), groups;
      for (std::size_t g = 0; g < rounded / 16; ++g) {
        const unsigned char* bytes = column.data() + 16 * g;
        std::uint32_t choice = random() % 4;
        if (kBits[control][choice] == 0 && !isZero(bytes, bytes + 16)) choice = 3;
        header[g / 4] = static_cast<unsigned char>(header[g / 4] | choice << (2 * (g % 4)));
        writeGroup(groups, bytes, kBits[control][choice]);
      }
      data.insert(data.end(), header.begin(), header.end());
      data.insert(data.end(), groups.begin(), groups.end());
    }
    stream.insert(stream.end(), controls.begin(), controls.end());
    stream.insert(stream.end(), data.begin(), data.end());
  }
  const std::size_t tail = stride + modes.size();
  if (tail < 24) stream.resize(stream.size() + 24 - tail);
  stream.insert(stream.end(), baseline.begin(), baseline.end());
  stream.insert(stream.end(), modes.begin(), modes.end());
  return stream;
}

}  // namespace quintet::test

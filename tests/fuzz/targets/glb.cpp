// SPDX-License-Identifier: Apache-2.0
// GLB: the container, and the JSON and the buffer in it. The sizes in the container are corrected, unless the input is of
// odd size, because otherwise few changes of the JSON would reach the reader.
#include <cstdint>
#include <cstring>
#include <vector>

#include "scene/gltf/gltf.h"
#include "scene_target.h"

namespace quintet::fuzz {
namespace {

constexpr std::size_t kHeaderSize = 12, kChunkHeaderSize = 8;

std::uint32_t readU32(std::span<const std::byte> bytes, std::size_t offset) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

void writeU32(std::vector<std::byte>& bytes, std::size_t offset, std::size_t value) {
  const auto stored = static_cast<std::uint32_t>(value);
  std::memcpy(bytes.data() + offset, &stored, sizeof stored);
}

// The JSON chunk ends where the header of the BIN chunk is found, or at the end.
std::vector<std::byte> withSizes(Input input) {
  std::vector<std::byte> bytes(input.begin(), input.end());
  if (bytes.size() < kHeaderSize + kChunkHeaderSize) return bytes;
  constexpr std::uint32_t kBinary = 0x004E4942;
  std::size_t json = bytes.size();
  for (std::size_t at = kHeaderSize + 2 * kChunkHeaderSize; at <= bytes.size(); ++at)
    if (readU32(bytes, at - 4) == kBinary) {
      json = at - kChunkHeaderSize;
      break;
    }
  while ((json - kHeaderSize) % 4 != 0) {  // white space of JSON
    bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(json), std::byte{' '});
    ++json;
  }
  writeU32(bytes, 8, bytes.size());
  writeU32(bytes, kHeaderSize, json - kHeaderSize - kChunkHeaderSize);
  if (json + kChunkHeaderSize <= bytes.size()) writeU32(bytes, json, bytes.size() - json - kChunkHeaderSize);
  return bytes;
}

}  // namespace

void readInput(Input input) {
  static const InputFile kFile("scene.glb");
  if (input.size() % 2 == 0)
    kFile.write(withSizes(input));
  else
    kFile.write(input);
  acceptErrors([] { checkScene(scene::loadGltf(kFile.path(), loadOptions())); });
}

}  // namespace quintet::fuzz

#include "render/film_blocks.h"

#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <new>

#include "base/parallel.h"

namespace quintet::render {
namespace {

static_assert(std::endian::native == std::endian::little, "sums are stored as they lie in memory");

constexpr std::size_t kBlockBytes = std::size_t{1} << 20;  // about, before compression
constexpr std::size_t kLargestRatio = 1032;                // of deflate (zlib's documentation)
constexpr int kLevel = 1;                                  // what is left to compress is mostly noise

std::size_t blockBytes(std::size_t elementBytes) {
  return std::max(kBlockBytes / elementBytes, std::size_t{1}) * elementBytes;
}

std::vector<std::byte> split(std::span<const std::byte> bytes, std::size_t elementBytes) {
  std::vector<std::byte> planes(bytes.size());
  const std::size_t count = bytes.size() / elementBytes;
  for (std::size_t b = 0; b < elementBytes; ++b)
    for (std::size_t i = 0; i < count; ++i) planes[b * count + i] = bytes[i * elementBytes + b];
  return planes;
}

void join(std::span<const std::byte> planes, std::span<std::byte> bytes, std::size_t elementBytes) {
  const std::size_t count = bytes.size() / elementBytes;
  for (std::size_t b = 0; b < elementBytes; ++b)
    for (std::size_t i = 0; i < count; ++i) bytes[i * elementBytes + b] = planes[b * count + i];
}

std::vector<std::byte> deflated(std::span<const std::byte> bytes) {
  std::vector<std::byte> out(::compressBound(bytes.size()));
  uLongf size = out.size();
  const int code = ::compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                               reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), kLevel);
  if (code != Z_OK) throw std::bad_alloc();  // the only reason left
  out.resize(size);
  return out;
}

bool inflated(std::span<const std::byte> bytes, std::span<std::byte> out) {
  uLongf size = out.size();
  const int code = ::uncompress(reinterpret_cast<Bytef*>(out.data()), &size,
                                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  if (code == Z_MEM_ERROR) throw std::bad_alloc();
  return code == Z_OK && size == out.size();
}

}  // namespace

void appendBlocks(std::vector<std::byte>& out, std::span<const std::byte> bytes, std::size_t elementBytes) {
  assert(bytes.size() % elementBytes == 0);
  const std::size_t size = blockBytes(elementBytes);
  std::vector<std::vector<std::byte>> blocks((bytes.size() + size - 1) / size);
  parallelFor(blocks.size(), [&](std::size_t i) {
    blocks[i] = deflated(split(bytes.subspan(i * size, std::min(size, bytes.size() - i * size)), elementBytes));
  });
  for (const std::vector<std::byte>& block : blocks) {
    const auto length = static_cast<std::uint32_t>(block.size());
    const auto* begin = reinterpret_cast<const std::byte*>(&length);
    out.insert(out.end(), begin, begin + sizeof length);
    out.insert(out.end(), block.begin(), block.end());
  }
}

bool blocksMayHold(std::size_t rawBytes, std::size_t compressedBytes) {
  return rawBytes / kLargestRatio <= compressedBytes;
}

bool takeBlocks(std::span<const std::byte>& in, std::span<std::byte> bytes, std::size_t elementBytes) {
  const std::size_t size = blockBytes(elementBytes);
  std::vector<std::span<const std::byte>> blocks((bytes.size() + size - 1) / size);
  for (std::span<const std::byte>& block : blocks) {
    std::uint32_t length = 0;
    if (in.size() < sizeof length) return false;
    std::memcpy(&length, in.data(), sizeof length);
    in = in.subspan(sizeof length);
    if (in.size() < length) return false;
    block = in.first(length);
    in = in.subspan(length);
  }
  std::atomic<bool> right = true;
  parallelFor(blocks.size(), [&](std::size_t i) {
    const std::span<std::byte> part = bytes.subspan(i * size, std::min(size, bytes.size() - i * size));
    std::vector<std::byte> planes(part.size());
    if (inflated(blocks[i], planes))
      join(planes, part, elementBytes);
    else
      right = false;
  });
  return right;
}

}  // namespace quintet::render

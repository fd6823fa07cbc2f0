// SPDX-License-Identifier: Apache-2.0
#include "render/film/film_file.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstring>

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/plural.h"
#include "render/film/film_format.h"

namespace quintet::render {
namespace {

using Bytes = std::span<const std::byte>;

// Appends `bytes`, whose elements have `elementBytes` each, as blocks.
void appendBlocks(std::vector<std::byte>& out, std::span<const std::byte> bytes, std::size_t elementBytes) {
  assert(bytes.size() % elementBytes == 0);
  const std::size_t size = filmBlockBytes(elementBytes);
  std::vector<std::vector<std::byte>> blocks((bytes.size() + size - 1) / size);
  parallelFor(blocks.size(), [&](std::size_t i) {
    blocks[i] = encodeFilmBlock(bytes.subspan(i * size, std::min(size, bytes.size() - i * size)), elementBytes);
  });
  for (const std::vector<std::byte>& block : blocks) {
    const auto length = static_cast<std::uint32_t>(block.size());
    const auto* begin = reinterpret_cast<const std::byte*>(&length);
    out.insert(out.end(), begin, begin + sizeof length);
    out.insert(out.end(), block.begin(), block.end());
  }
}

// Fills `bytes` from the blocks at the front of `in`, and advances `in` past them. Returns false if the blocks are
// invalid.
bool takeBlocks(std::span<const std::byte>& in, std::span<std::byte> bytes, std::size_t elementBytes) {
  const std::size_t size = filmBlockBytes(elementBytes);
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
  std::atomic<bool> valid = true;
  parallelFor(blocks.size(), [&](std::size_t i) {
    const std::span<std::byte> part = bytes.subspan(i * size, std::min(size, bytes.size() - i * size));
    if (!decodeFilmBlock(blocks[i], part, elementBytes)) valid = false;
  });
  return valid;
}

std::array<std::uint64_t, 2> hashOf(Bytes bytes) { return filmHash(Hasher().add(bytes).finish()); }

template <class T>
void appendArray(std::vector<std::byte>& out, const std::vector<T>& values, std::size_t group = 1) {
  appendBlocks(out, std::as_bytes(std::span(values)), sizeof(T) * group);
}

// Reads the arrays in their order.
class Payload {
 public:
  Payload(const std::filesystem::path& file, Bytes bytes, MemoryBudget& budget)
      : file_(file), bytes_(bytes), budget_(budget) {}

  FilmFile fill(FilmHeader header) {
    FilmState& film = header.file.film;
    take(film.counts.cellBatches, header.cells);
    take(header.file.plan, header.planned);
    if (!areConsistent(film.counts, header.file.plan)) fail("no render has these numbers of batches");
    take(film.statistics, film.pixelCount());
    for (std::size_t i = 0; i < film.planes.size(); ++i) {
      forArrays(film.planes[i], [&](const char* name, auto& array, std::size_t group) {
        if (header.stores(i, name)) take(array, film.pixelCount() * group, group);
      });
    }
    if (!bytes_.empty()) fail(counted(bytes_.size(), "excess byte"));
    return std::move(header.file);
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const { throw FileError(file_, "payload", problem); }

  template <class T>
  void take(std::vector<T>& values, std::size_t count, std::size_t group = 1) {
    bool valid = filmBlocksCanHold(count * sizeof(T), bytes_.size());
    if (valid) {
      budget_.take(count * sizeof(T));
      values.resize(count);
      valid = takeBlocks(bytes_, std::as_writable_bytes(std::span(values)), sizeof(T) * group);
    }
    if (!valid) fail("the blocks do not match the header");
  }

  const std::filesystem::path& file_;
  Bytes bytes_;
  MemoryBudget& budget_;
};

// Header and payload of a file whose length and checksum are valid.
struct Parts {
  Bytes header, payload;
};

Parts checkedParts(Bytes bytes, const std::filesystem::path& file) {
  const FilmPrefix prefix =
      checkedFilmPrefix(bytes.first(std::min(bytes.size(), kFilmPrefixBytes)), bytes.size(), file);
  const auto hash = hashOf(bytes.first(bytes.size() - kFilmHashBytes));
  if (std::memcmp(hash.data(), bytes.last(kFilmHashBytes).data(), kFilmHashBytes) != 0)
    throw FileError(file, "is damaged: its checksum does not match its content");
  return {bytes.subspan(kFilmPrefixBytes, prefix.headerBytes),
          bytes.subspan(kFilmPrefixBytes + prefix.headerBytes, prefix.payloadBytes)};
}

}  // namespace

std::vector<std::byte> encodeFilm(const FilmFile& file) {
  const std::string header = filmHeaderText(file);
  std::vector<std::byte> out(kFilmPrefixBytes + header.size());
  std::memcpy(out.data() + kFilmPrefixBytes, header.data(), header.size());
  appendArray(out, file.film.counts.cellBatches);
  appendArray(out, file.plan);
  appendArray(out, file.film.statistics);
  for (const FilmPlane& plane : file.film.planes)
    forArrays(plane, [&](const char*, const auto& array, std::size_t group) { appendArray(out, array, group); });
  const FilmPrefix prefix{kFilmFormatVersion, static_cast<std::uint32_t>(header.size()),
                          out.size() - kFilmPrefixBytes - header.size()};
  std::memcpy(out.data(), kFilmMagic.data(), kFilmMagic.size());
  std::memcpy(out.data() + kFilmMagic.size(), &prefix, sizeof prefix);
  const auto hash = hashOf(out);
  const Bytes hashBytes = std::as_bytes(std::span(hash));
  out.insert(out.end(), hashBytes.begin(), hashBytes.end());
  return out;
}

bool isFilmFile(Bytes bytes) {
  return bytes.size() >= kFilmMagic.size() && std::memcmp(bytes.data(), kFilmMagic.data(), kFilmMagic.size()) == 0;
}

FilmFile decodeFilm(Bytes bytes, const std::filesystem::path& file) {
  MemoryBudget budget(file, 0, Remedy::none);
  return decodeFilm(bytes, file, budget);
}

FilmFile decodeFilm(Bytes bytes, const std::filesystem::path& file, MemoryBudget& budget) {
  const Parts parts = checkedParts(bytes, file);
  return Payload(file, parts.payload, budget).fill(parseFilmHeader(parts.header, file));
}

void writeFilm(const std::filesystem::path& path, const FilmFile& file) { writeFile(path, encodeFilm(file)); }
FilmFile readFilm(const std::filesystem::path& path, std::size_t maxMemory) {
  MemoryBudget budget(path, maxMemory);
  return decodeFilm(readFile(path, budget), path, budget);
}

}  // namespace quintet::render

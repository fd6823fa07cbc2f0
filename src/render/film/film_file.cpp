// SPDX-License-Identifier: Apache-2.0
#include "render/film/film_file.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <string>

#include "base/file.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "render/film/film_format.h"
#include "render/film/film_reader.h"

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

std::array<std::uint64_t, 2> hashOf(Bytes bytes) { return filmHash(Hasher().add(bytes).finish()); }

template <class T>
void appendArray(std::vector<std::byte>& out, const std::vector<T>& values, std::size_t group = 1) {
  appendBlocks(out, std::as_bytes(std::span(values)), sizeof(T) * group);
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
  return FilmReader(bytes, file).read(budget);
}

void writeFilm(const std::filesystem::path& path, const FilmFile& file) { writeFile(path, encodeFilm(file)); }
FilmFile readFilm(const std::filesystem::path& path, std::size_t maxMemory) { return FilmReader(path).read(maxMemory); }

}  // namespace quintet::render

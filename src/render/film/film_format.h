// SPDX-License-Identifier: Apache-2.0
// The parts of the film file format (film_file.h) that whole files and streams share: the prefix, the header, and the
// compressed blocks of the arrays. Only sources of this folder include it.
#ifndef QUINTET_RENDER_FILM_FILM_FORMAT_H
#define QUINTET_RENDER_FILM_FILM_FORMAT_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/hash.h"
#include "render/film/film_content.h"

namespace quintet::render {

// Visits the arrays of a plane by their names in the header, with the number of elements per pixel.
template <class Plane, class Visit>
void forArrays(Plane& plane, const Visit& visit) {
  visit("sums", plane.sums, std::size_t{4});
  visit("squares", plane.squares, std::size_t{4});
  visit("values", plane.values, std::size_t{1});
  visit("coverage", plane.coverage, std::size_t{shared::kCoverageSlots});
}

inline constexpr std::uint32_t kFilmFormatVersion = 3;

// As in PNG: the first byte is not text, and the end reveals a transfer that changed line endings.
inline constexpr std::array<unsigned char, 8> kFilmMagic{0x89, 'Q', 'F', 'I', 'L', 'M', '\r', '\n'};
inline constexpr std::size_t kFilmPrefixBytes = 24;  // with the magic
inline constexpr std::size_t kFilmHashBytes = 16;

struct FilmPrefix {
  std::uint32_t version = kFilmFormatVersion;
  std::uint32_t headerBytes = 0;
  std::uint64_t payloadBytes = 0;
};
static_assert(sizeof(FilmPrefix) == kFilmPrefixBytes - sizeof kFilmMagic);

// Reads the prefix of a file of `fileBytes` bytes. `start`: its first bytes, at least kFilmPrefixBytes unless the file is
// shorter. Throws FileError unless it is a film file of this version with this length.
FilmPrefix checkedFilmPrefix(std::span<const std::byte> start, std::uint64_t fileBytes,
                             const std::filesystem::path& file);

std::array<std::uint64_t, 2> filmHash(const Hash& hash);  // as the file stores it

struct FilmHeader {
  FilmFile file;                                 // without its arrays
  std::size_t cells = 0, planned = 0;            // sizes of the arrays cellBatches and plan
  std::vector<std::vector<std::string>> arrays;  // names of the arrays of each plane

  bool stores(std::size_t plane, std::string_view array) const;
};
// Throws FileError.
FilmHeader parseFilmHeader(std::span<const std::byte> header, const std::filesystem::path& file);
std::string filmHeaderText(const FilmFile& file);

// Size of a block before compression, for elements of this size. The last block of an array can be shorter.
std::size_t filmBlockBytes(std::size_t elementBytes);
std::size_t largestFilmBlock(std::size_t rawBytes);  // bytes of a compressed block at most
// Returns whether so many compressed bytes can hold `rawBytes`. Checked before memory is allocated for them.
bool filmBlocksCanHold(std::size_t rawBytes, std::size_t compressedBytes);
std::vector<std::byte> encodeFilmBlock(std::span<const std::byte> bytes, std::size_t elementBytes);
// Returns false unless the block fills `out` exactly.
bool decodeFilmBlock(std::span<const std::byte> block, std::span<std::byte> out, std::size_t elementBytes);

}  // namespace quintet::render
#endif

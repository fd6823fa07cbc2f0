// SPDX-License-Identifier: Apache-2.0
// A film in a file (.qfilm): the checkpoint of a render, or a part of one. All sums are stored exactly, so that
// resuming from a file, and merging files, gives the same bytes as one uninterrupted render.
//
//   8 bytes   magic
//   u32       format version
//   u32       size of the header in bytes
//   u64       size of the payload in bytes
//   header    JSON: identity, notes, region, samples, cells, plan, planes
//   payload   arrays in compressed blocks: cell batches, plan, statistics, then for each plane those of sums, squares,
//             values and coverage that the header lists
//   16 bytes  XXH3 (base/hash.h) of all preceding bytes
//
// Integers are little-endian. A block is a u32 compressed size and zlib data. The elements of a block are split by
// byte: byte 0 of all elements, then byte 1, and so on. The high and low words of fixed-point sums are mostly zero, and
// compress well that way.
#ifndef QUINTET_RENDER_FILM_FILM_FILE_H
#define QUINTET_RENDER_FILM_FILM_FILE_H

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "base/memory_budget.h"
#include "render/film/film_content.h"

namespace quintet::render {

inline constexpr const char* kFilmExtension = ".qfilm";

std::vector<std::byte> encodeFilm(const FilmFile& file);

// Returns whether the bytes start with the magic of a film file.
bool isFilmFile(std::span<const std::byte> bytes);

// Throws FileError for a file that is not a film file, has a different version, or is truncated or damaged; MemoryError for
// one whose header states more arrays than the budget allows. `file` is used in messages only. Without a budget, 80 % of
// the machine's memory are the limit.
FilmFile decodeFilm(std::span<const std::byte> bytes, const std::filesystem::path& file);
FilmFile decodeFilm(std::span<const std::byte> bytes, const std::filesystem::path& file, MemoryBudget&);

// Replaces the file atomically (base/file.h): readers see either the old or the new file.
void writeFilm(const std::filesystem::path& path, const FilmFile& file);
// FilmReader(path).read(maxMemory).
FilmFile readFilm(const std::filesystem::path& path, std::size_t maxMemory = 0);

}  // namespace quintet::render
#endif

// A film in a file (.qfilm): the checkpoint of a rendering, or a part of one. Sums are kept as they are, so that going on
// from a file, and joining files, gives the bytes that one rendering would have given.
//
//   8 bytes   magic
//   u32       version of this format
//   u32       bytes of the header
//   u64       bytes of the payload
//   header    JSON: who wrote it, identity, notes, region, sample counts, planes
//   payload   the arrays in blocks (film_blocks.h): cells, plan, statistics, then for each plane what it has of sums,
//             squares, values, coverage
//   16 bytes  XXH3 (base/hash.h) of all bytes before it
//
// Integers are little-endian.
#ifndef QUINTET_RENDER_FILM_FILE_H
#define QUINTET_RENDER_FILM_FILE_H

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "render/film_state.h"

namespace quintet::render {

inline constexpr std::uint32_t kFilmFileVersion = 2;
inline constexpr const char* kFilmExtension = ".qfilm";

// Names and values in the order in which they are told: {"seed", "3"}. A name is there once.
using FilmFacts = std::vector<std::pair<std::string, std::string>>;

const std::string* findFact(const FilmFacts& facts, const std::string& name);  // null: not there

struct FilmFile {
  FilmFacts identity;  // what decides about the samples' values: films agree in all of it, or do not belong together
  FilmFacts notes;     // everything else that is worth knowing: names of files, device, how the picture is to be shown
  FilmState film;
  // Of adaptive sampling that goes on: the batches that each cell shall have (planCells), as decided at an earlier film
  // than this one. Empty: nothing was decided yet. The next decision follows from the film once this one is carried out.
  std::vector<std::uint32_t> plan;
};

// Where two identities differ; a side that lacks the name has no value.
struct FactDifference {
  std::string name;
  const std::string* left = nullptr;
  const std::string* right = nullptr;
};
std::vector<FactDifference> differences(const FilmFacts& left, const FilmFacts& right);

std::vector<std::byte> encodeFilm(const FilmFile& file);

// It begins like one.
bool isFilmFile(std::span<const std::byte> bytes);

// Throws FileError that says what is wrong: not a film file, another version, truncated, damaged.
FilmFile decodeFilm(std::span<const std::byte> bytes, const std::filesystem::path& file);

// In one step (base/file.h): a reader sees the old file or the new one, never half of it.
void writeFilm(const std::filesystem::path& path, const FilmFile& file);
FilmFile readFilm(const std::filesystem::path& path);

}  // namespace quintet::render
#endif

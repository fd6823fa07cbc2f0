// SPDX-License-Identifier: Apache-2.0
// Reads a film file as a stream: its header alone, its checksum, or its arrays, which are added to a film block by block.
// A few blocks are in memory at a time, however large the file is. Reading, hashing and decompressing overlap.
#ifndef QUINTET_RENDER_FILM_FILM_READER_H
#define QUINTET_RENDER_FILM_FILM_READER_H

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "base/memory_budget.h"
#include "render/film/film_content.h"

namespace quintet::render {

class FilmReader {
 public:
  // Opens the file and reads its header. Throws FileError for a file that is not a film file, has a different version or
  // the wrong length, or whose header is damaged. A damaged payload is not noticed yet.
  explicit FilmReader(const std::filesystem::path& path);
  // The same for the content of a file, which must outlive the reader; `file` is used in messages only.
  FilmReader(std::span<const std::byte> bytes, const std::filesystem::path& file);
  ~FilmReader();
  FilmReader(const FilmReader&) = delete;
  FilmReader& operator=(const FilmReader&) = delete;

  const FilmFile& header() const;  // without arrays
  std::uint64_t fileBytes() const;
  // Whether a film has the region, the outputs and the arrays of this one, so that both can be added (sameArrays).
  bool hasArraysOf(const FilmState& film) const;

  // Each of these reads the rest of the file, so only one of them can be called, once. They throw FileError for a damaged
  // file, whose checksum they verify.
  // The whole film. `maxMemory`: bytes of host memory that its arrays can request; 0 means 80 % of the machine's memory.
  FilmFile read(std::size_t maxMemory = 0);
  FilmFile read(MemoryBudget&);
  // Merges the film into `film`: like mergeFilm(film, readFilm(path)), but this film is never in memory. Asserts
  // hasArraysOf(film). Throws UsageError as mergeFilm() does; after an exception, `film` is invalid.
  void addTo(FilmState& film);
  void verify();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace quintet::render
#endif

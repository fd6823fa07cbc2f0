// The header of a film file (film_file.h) as JSON: what the film is of, and which arrays follow it in the payload.
#ifndef QUINTET_RENDER_FILM_HEADER_H
#define QUINTET_RENDER_FILM_HEADER_H

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "render/film_file.h"

namespace quintet::render {

// The arrays of a plane that may be in a file, by name.
template <class Plane, class Visit>
void forArrays(Plane& plane, const Visit& visit) {
  visit("sums", plane.sums, std::size_t{4});
  visit("squares", plane.squares, std::size_t{4});
  visit("values", plane.values, std::size_t{1});
  visit("coverage", plane.coverage, std::size_t{shared::kCoverageSlots});
}

std::string filmHeaderText(const FilmFile& file);

struct FilmHeader {
  FilmFile file;                                 // without its arrays
  std::size_t cells = 0, planned = 0;            // of the arrays cellBatches and plan
  std::vector<std::vector<std::string>> arrays;  // by plane, those that it has
};

// `file` is for errors. The checksum was right, so whatever is wrong was written like that: throws FileError.
FilmHeader readFilmHeader(std::span<const std::byte> header, const std::filesystem::path& file);

}  // namespace quintet::render
#endif

// SPDX-License-Identifier: Apache-2.0
// Whether two films show the same image, except for noise: the statistical test of render/film/film_ztest.h on film files.
#ifndef QUINTET_JOB_FILM_COMPARISON_H
#define QUINTET_JOB_FILM_COMPARISON_H

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "job/provenance.h"
#include "render/film/film_file.h"
#include "render/film/film_ztest.h"

namespace quintet::job {

struct FilmComparison {
  std::array<std::filesystem::path, 2> files;
  std::array<render::FilmFile, 2> films;
  std::array<Provenance, 2> provenance;
  render::ZTestOptions options;
  render::ZTest test;
  std::vector<std::string> notes;  // what limits the verdict

  std::uint64_t samples(std::size_t film) const;  // per pixel, on average if adaptive
};

// `mayDiffer`: names of identity facts, or their first words, in which the films may differ besides seed and planned
// samples. `maxMemory` of each film: see render::readFilm. Throws FileError for files that are not films or whose identities differ, UsageError for unknown names, Error if
// the films cannot be tested.
FilmComparison compareFilms(const std::filesystem::path& a, const std::filesystem::path& b,
                            const std::vector<std::string>& mayDiffer, const render::ZTestOptions& options,
                            std::size_t maxMemory = 0);

}  // namespace quintet::job
#endif

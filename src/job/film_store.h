// SPDX-License-Identifier: Apache-2.0
// Film files on disk: reading them with their provenance, whether they belong to a render, what they hold in words, and
// protection against losing samples.
#ifndef QUINTET_JOB_FILM_STORE_H
#define QUINTET_JOB_FILM_STORE_H

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "job/provenance.h"
#include "render/film/film_file.h"

namespace quintet::job {

struct StoredFilm {
  render::FilmFile file;
  Provenance provenance;  // from the facts of the file
};

// Throws FileError for a file that is not a film, is damaged, or whose facts are invalid or do not fit its arrays.
// `maxMemory`: see render::readFilm; more is a MemoryError.
StoredFilm readStoredFilm(const std::filesystem::path& path, std::size_t maxMemory = 0);
// `path`: for messages only.
StoredFilm decodeStoredFilm(std::span<const std::byte> bytes, const std::filesystem::path& path, MemoryBudget&);

// The facts of a film, whose arrays are not used. Throws FileError that names `path` for invalid facts.
Provenance provenanceOf(const render::FilmFile& file, const std::filesystem::path& path);

// Throws FileError "belongs to `owner` (seed 3, expected 7); CONSEQUENCE" unless the identities agree. `owner`: "a
// different render"; an empty consequence is omitted.
void requireSameIdentity(const render::FilmFacts& found, const render::FilmFacts& expected,
                         const std::filesystem::path& file, const std::string& owner, const std::string& consequence,
                         Remedy remedy);

// Throws FileError if `file` is a film that holds samples which a film of this identity with these samples would not
// hold: they would be lost. Sample counts of an adaptive render that are not known yet have no cells. `maxMemory`: see
// render::readFilm.
void rejectLoss(const std::filesystem::path& file, const render::FilmFacts& identity,
                const render::SampleCounts& samples, std::size_t maxMemory = 0);

// "samples 0–15", "samples 0–15 and 32", "sample 32"; "no samples".
std::string rangesText(const std::vector<render::SampleRange>& ranges);
// "samples 0–15"; for an adaptive film "20.5 samples per pixel on average (16–24)".
std::string samplesText(const render::FilmState& film);

}  // namespace quintet::job
#endif

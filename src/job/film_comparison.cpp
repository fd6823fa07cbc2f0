// SPDX-License-Identifier: Apache-2.0
#include "job/film_comparison.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/plural.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "job/film_store.h"

namespace quintet::job {
namespace {

using render::FilmFacts;
using render::FilmFile;

StoredFilm readFilmToTest(const std::filesystem::path& path, std::size_t maxMemory) {
  MemoryBudget budget(path, maxMemory);
  const std::vector<std::byte> bytes = readFile(path, budget);
  if (!bytes.empty() && !render::isFilmFile(bytes))
    throw FileError(path,
                    "is not a film (.qfilm); the test requires films, because an image does not record its noise");
  return decodeStoredFilm(bytes, path, budget);
}

bool matches(const std::string& fact, const std::string& name) { return fact == name || fact.starts_with(name + " "); }

FilmFacts without(const FilmFacts& facts, const std::vector<std::string>& names) {
  FilmFacts result;
  for (const auto& fact : facts)
    if (std::ranges::none_of(names, [&](const std::string& name) { return matches(fact.first, name); }))
      result.push_back(fact);
  return result;
}

void checkNames(const FilmFacts& facts, const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const auto& [fact, value] : facts) known.push_back(fact);
  for (const std::string& name : names)
    if (std::ranges::none_of(known, [&](const std::string& fact) { return matches(fact, name); }))
      throw UsageError(fmt::format("may-differ: films have no fact '{}'{}; 'quintet info FILM' lists them",
                                   printable(name), suggestion(name, known)));
}

bool shareSamples(const FilmFile& a, const FilmFile& b) {
  for (const render::SampleRange& r : a.film.counts.ranges)
    for (const render::SampleRange& s : b.film.counts.ranges)
      if (r.begin < s.end && s.begin < r.end) return true;
  return false;
}

std::vector<std::string> notesOn(const FilmComparison& c) {
  std::vector<std::string> notes;
  if (c.provenance[0].seed == c.provenance[1].seed && shareSamples(c.films[0], c.films[1]))
    notes.push_back(
        fmt::format("both films contain the same samples of seed {}: their difference is rounding, not noise, and the "
                    "test says little; render one of them with a different seed",
                    c.provenance[0].seed));
  if (c.samples(0) != c.samples(1))
    notes.push_back(
        "the films have different numbers of samples: rare bright samples skew the difference, and p is less "
        "accurate");
  for (std::size_t i = 0; i < 2; ++i) {
    std::uint64_t dropped = 0;
    for (const uvec2& pixel : c.films[i].film.statistics) dropped += pixel.y;
    if (dropped > 0)
      notes.push_back(fmt::format("{} of {} {} not finite and {} omitted", counted(dropped, "sample"), "AB"[i],
                                  nounFor(dropped, "was", "were"), nounFor(dropped, "is", "are")));
  }
  return notes;
}

}  // namespace

std::uint64_t FilmComparison::samples(std::size_t film) const {
  return static_cast<std::uint64_t>(render::averageSamples(films[film].film.region, films[film].film.counts));
}

FilmComparison compareFilms(const std::filesystem::path& a, const std::filesystem::path& b,
                            const std::vector<std::string>& mayDiffer, const render::ZTestOptions& options,
                            std::size_t maxMemory) {
  FilmComparison c;
  c.files = {a, b};
  for (std::size_t i = 0; i < 2; ++i) {
    StoredFilm stored = readFilmToTest(c.files[i], maxMemory);
    c.films[i] = std::move(stored.file);
    c.provenance[i] = std::move(stored.provenance);
  }
  checkNames(c.films[0].identity, mayDiffer);
  std::vector<std::string> ignored = mayDiffer;
  ignored.insert(ignored.end(), {"seed", "planned samples"});
  requireSameIdentity(without(c.films[1].identity, ignored), without(c.films[0].identity, ignored), b,
                      fmt::format("a different render than {}", a.string()), "", Remedy::allowDifference);
  c.options = options;
  c.options.channels = c.provenance[0].transparent && c.provenance[1].transparent ? 4 : 3;
  try {
    c.test = render::zTest(c.films[0].film, c.films[1].film, c.options);
  } catch (const UsageError& error) {
    throw Error(fmt::format("{} and {}: {}", a.string(), b.string(), error.what()));
  }
  c.notes = notesOn(c);
  return c;
}

}  // namespace quintet::job

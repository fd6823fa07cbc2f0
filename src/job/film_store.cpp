// SPDX-License-Identifier: Apache-2.0
#include "job/film_store.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/file.h"
#include "base/plural.h"

namespace quintet::job {
namespace {

using render::FilmFacts;
using render::SampleRange;

constexpr std::size_t kShownDigits = 12;  // of a hash

bool isHash(const std::string& text) {
  return text.size() == 32 && text.find_first_not_of("0123456789abcdef") == text.npos;
}

bool isOnlyIfSet(const std::string& name) {
  return std::ranges::any_of(provenanceFields(),
                             [&](const ProvenanceField& field) { return field.onlyIfSet && field.name == name; });
}

std::string shown(const std::string& name, const std::string* value) {
  if (!value) return isOnlyIfSet(name) ? "none" : "unknown";
  if (value->empty()) return "none";
  return isHash(*value) ? value->substr(0, kShownDigits) : *value;
}

// "seed 3, expected 7; size 64x64, expected 32x32"
std::string differencesText(const FilmFacts& found, const FilmFacts& expected) {
  constexpr std::size_t kShownDifferences = 4;
  const std::vector<render::FactDifference> differences = render::differences(found, expected);
  std::string text;
  for (std::size_t i = 0; i < std::min(differences.size(), kShownDifferences); ++i)
    text +=
        fmt::format("{}{} {}, expected {}", i > 0 ? "; " : "", differences[i].name,
                    shown(differences[i].name, differences[i].left), shown(differences[i].name, differences[i].right));
  if (differences.size() > kShownDifferences)
    text += fmt::format("; and {} more", differences.size() - kShownDifferences);
  return text;
}

}  // namespace

StoredFilm readStoredFilm(const std::filesystem::path& path, std::size_t maxMemory) {
  MemoryBudget budget(path, maxMemory);
  return decodeStoredFilm(readFile(path, budget), path, budget);
}

StoredFilm decodeStoredFilm(std::span<const std::byte> bytes, const std::filesystem::path& path, MemoryBudget& budget) {
  StoredFilm stored;
  stored.file = render::decodeFilm(bytes, path, budget);
  stored.provenance = provenanceOf(stored.file, path);
  return stored;
}

Provenance provenanceOf(const render::FilmFile& file, const std::filesystem::path& path) {
  Provenance provenance;
  try {
    provenance = fromFacts(file.identity, file.notes);
  } catch (const UsageError& error) {
    throw FileError(path, "header", error.what());
  }
  if (provenance.region != file.film.region) throw FileError(path, "header", "region differs from that of the samples");
  return provenance;
}

void requireSameIdentity(const FilmFacts& found, const FilmFacts& expected, const std::filesystem::path& file,
                         const std::string& owner, const std::string& consequence, Remedy remedy) {
  const std::string differences = differencesText(found, expected);
  if (differences.empty()) return;
  throw FileError(
      file, fmt::format("belongs to {} ({}){}{}", owner, differences, consequence.empty() ? "" : "; ", consequence),
      remedy);
}

void rejectLoss(const std::filesystem::path& file, const FilmFacts& identity, const render::SampleCounts& samples,
                std::size_t maxMemory) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return;
  render::FilmFile found;
  try {
    found = render::readFilm(file, maxMemory);
  } catch (const FileError& error) {
    throw FileError(file, error.location(), error.problem(), Remedy::overwrite);
  }
  requireSameIdentity(found.identity, identity, file, "a different render", "its samples would be lost",
                      Remedy::overwrite);
  for (const SampleRange& held : found.film.counts.ranges)
    if (std::ranges::none_of(samples.ranges,
                             [&](const SampleRange& s) { return s.begin <= held.begin && held.end <= s.end; }))
      throw FileError(file, fmt::format("holds {} of this render, which would be lost", rangesText({held})),
                      Remedy::overwrite);
  const std::vector<std::uint32_t>& batches = found.film.counts.cellBatches;
  for (std::size_t c = 0; c < batches.size(); ++c)
    if (c >= samples.cellBatches.size() || samples.cellBatches[c] < batches[c])
      throw FileError(file, fmt::format("holds {} of this render, which would be lost", samplesText(found.film)),
                      Remedy::overwrite);
}

std::string rangesText(const std::vector<SampleRange>& ranges) {
  if (ranges.empty()) return "no samples";
  std::uint64_t count = 0;
  std::vector<std::string> texts;
  for (const SampleRange& range : ranges) {
    count += range.end - range.begin;
    texts.push_back(range.end - range.begin == 1 ? fmt::format("{}", range.begin)
                                                 : fmt::format("{}–{}", range.begin, range.end - 1));
  }
  return fmt::format("{} {}", nounFor(count, "sample"), fmt::join(texts, " and "));
}

std::string samplesText(const render::FilmState& film) {
  const std::vector<std::uint32_t>& batches = film.counts.cellBatches;
  if (batches.empty()) return rangesText(film.counts.ranges);
  std::uint32_t fewest = std::numeric_limits<std::uint32_t>::max(), most = 0;
  const std::vector<std::uint32_t> pixels = render::cellPixels(film.region);
  for (std::size_t c = 0; c < batches.size(); ++c) {
    if (pixels[c] == 0) continue;
    fewest = std::min(fewest, batches[c]);
    most = std::max(most, batches[c]);
  }
  return fmt::format("{:.1f} samples per pixel on average ({}–{})", render::averageSamples(film.region, film.counts),
                     fewest * render::kBatchSamples, most * render::kBatchSamples);
}

}  // namespace quintet::job

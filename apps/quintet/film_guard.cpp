#include "film_guard.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "film_facts.h"
#include "standard_error.h"
#include "values.h"

namespace quintet::app {

using render::SampleRange;

void refuseOther(const render::FilmFacts& found, const render::FilmFacts& identity, const IdentityCheck& check) {
  const std::vector<render::FactDifference> different = render::differences(found, identity);
  if (different.empty()) return;
  for (const std::string& line : differenceLines(different, check.where, check.here))
    printError("quintet: {}: {}\n", plain(check.file.string()), plain(line));
  throw FileError(check.file, check.problem);
}

void refuseLoss(const std::filesystem::path& file, const render::FilmFacts& identity,
                const render::SampleCounts& samples) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return;
  render::FilmFile found;
  try {
    found = render::readFilm(file);
  } catch (const FileError& error) {
    throw FileError(file, error.place(), error.problem() + "; --force overwrites it");
  }
  refuseOther(found.identity, identity,
              {file, "in the file", "here", "holds another rendering, which would be lost; --force overwrites it"});
  for (const SampleRange& held : found.film.counts.ranges)
    if (std::ranges::none_of(samples.ranges,
                             [&](const SampleRange& s) { return s.begin <= held.begin && held.end <= s.end; }))
      throw FileError(file, fmt::format("holds samples {} to {} of this rendering, which would be lost; --force "
                                        "overwrites it",
                                        held.begin, held.end - 1));
  const std::vector<std::uint32_t>& batches = found.film.counts.cellBatches;
  const auto loses = [&](std::size_t cell) {
    return cell >= samples.cellBatches.size() || samples.cellBatches[cell] < batches[cell];
  };
  for (std::size_t c = 0; c < batches.size(); ++c)
    if (loses(c))
      throw FileError(file, fmt::format("holds {} of this rendering, which would be lost; --force overwrites it",
                                        samplesText(found)));
}

}  // namespace quintet::app

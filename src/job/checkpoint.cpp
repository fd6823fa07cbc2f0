// SPDX-License-Identifier: Apache-2.0
#include "job/checkpoint.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/plural.h"
#include "gpu/error.h"

namespace quintet::job {
namespace {

using render::SampleRange;

std::uint64_t averageSamples(const render::FilmState& film) {
  return static_cast<std::uint64_t>(render::averageSamples(film.region, film.counts));
}

// The samples of the file are the first ones of this render or part.
void checkSamples(const std::filesystem::path& file, const render::FilmState& film, const StartPoint& start,
                  const RenderLimits& limits) {
  const std::vector<SampleRange>& ranges = film.counts.ranges;
  if (ranges.empty()) return;
  if (ranges.size() > 1 || ranges.front().begin != start.begin)
    throw FileError(file,
                    fmt::format("holds {}, but this render starts at sample {}", rangesText(ranges), start.begin));
  if (limits.samples && ranges.front().end > *limits.samples)
    throw FileError(
        file, fmt::format("holds {}, but this render ends at sample {}", rangesText(ranges), *limits.samples - 1));
}

}  // namespace

std::optional<StoredFilm> loadCheckpoint(const CheckpointRequest& request, const Provenance& expected,
                                         const render::FilmState& empty, const StartPoint& start,
                                         const RenderLimits& limits, Observer& observer, std::size_t maxMemory) {
  const std::filesystem::path& path = request.file;
  if (!std::filesystem::exists(path)) {
    if (request.resume)
      observer.note(fmt::format("{}: no checkpoint found, starting from the first sample", path.string()));
    return std::nullopt;
  }
  StoredFilm stored;
  const render::FilmFile& file = stored.file;
  try {
    stored = readStoredFilm(path, maxMemory);
    requireSameIdentity(file.identity, toFacts(expected, ProvenanceField::Role::identity), path, "a different render",
                        "", Remedy::startOver);
    if (!render::sameArrays(file.film, empty)) throw FileError(path, "its outputs differ from those of the program");
    checkSamples(path, file.film, start, limits);
  } catch (const FileError& error) {
    if (!request.force) throw FileError(path, error.location(), error.problem(), Remedy::startOver);
    observer.note(fmt::format("{}; starting over", error.what()));
    return std::nullopt;
  } catch (const MemoryError& error) {  // a damaged header can request any size
    if (!request.force) throw;
    observer.note(fmt::format("{}; starting over", error.what()));
    return std::nullopt;
  }
  if (!request.resume) {
    if (request.force) return std::nullopt;
    throw FileError(path,
                    fmt::format("holds {} {} of this render", averageSamples(file.film),
                                nounFor(averageSamples(file.film), "sample")),
                    Remedy::resumeOrStartOver);
  }
  if (file.film.counts.ranges.empty()) return std::nullopt;
  return stored;
}

Checkpoint::Checkpoint(CheckpointRequest request, Observer& observer)
    : request_(std::move(request)),
      lock_(request_.file, request_.waitSeconds, [&](const std::string& text) { observer.note(text); }) {}

std::optional<StoredFilm> Checkpoint::load(const Provenance& expected, const render::FilmState& empty,
                                           const StartPoint& start, const RenderLimits& limits, Observer& observer,
                                           std::size_t maxMemory) {
  removeLeftovers(request_.file);
  std::optional<StoredFilm> stored = loadCheckpoint(request_, expected, empty, start, limits, observer, maxMemory);
  if (stored) {
    savedCounts_ = stored->file.film.counts;
    savedSamples_ = averageSamples(stored->file.film);
  }
  return stored;
}

void Checkpoint::save(const RenderResult& result, Observer& observer) {
  const std::string name = request_.file.string();
  std::string failure;
  observer.stage("writing " + name);
  try {
    const render::FilmFile file = filmFileOf(result);
    observer.write(request_.file, render::encodeFilm(file));
    savedSamples_ = result.provenance.samples;
    savedCounts_ = file.film.counts;
  } catch (const FileError& error) {
    failure = error.what();
  } catch (const DeviceLostError&) {  // the film is lost
    throw;
  } catch (const std::exception& error) {
    failure = fmt::format("{}: cannot be written: {}", name, error.what());
  }
  lastSave_ = clock_.seconds();
  if (failure.empty() || warned_) return;
  warned_ = true;
  observer.warning(failure);
}

void Checkpoint::saveIfChanged(const RenderResult& result, Observer& observer) {
  if (savedCounts_ != result.film->counts()) save(result, observer);
}

void Checkpoint::remove(Observer& observer) {
  std::error_code failed;
  std::filesystem::remove(request_.file, failed);
  if (failed) observer.warning(fmt::format("{}: cannot be removed: {}", request_.file.string(), failed.message()));
}

StartPoint resumePoint(const StoredFilm& film, const Provenance& current, const std::filesystem::path& file,
                       const StartPoint& start, Observer& observer) {
  const Provenance& earlier = film.provenance;
  const auto text = [](const std::optional<double>& error) {
    return error ? fmt::format("a target error of {:.3g} %", 100.0 * *error) : std::string("no target error");
  };
  if (!earlier.device.empty() && earlier.device != current.device)
    observer.note(fmt::format("{}: started on {}, resuming on {}", file.string(), earlier.device, current.device));
  StartPoint point = start;
  point.done = film.file.film.counts.ranges.back().end;
  point.seconds = earlier.seconds;
  point.batchSeconds = earlier.batchSeconds;
  if (!current.adaptive || earlier.targetError == current.targetError)
    point.plan = film.file.plan;
  else
    observer.note(
        fmt::format("{}: started with {}, resuming with {}; a render from the start would distribute its samples "
                    "differently",
                    file.string(), text(earlier.targetError), text(current.targetError)));
  observer.note(fmt::format("{}: resuming after {} {}", file.string(), averageSamples(film.file.film),
                            nounFor(averageSamples(film.file.film), "sample")));
  return point;
}

}  // namespace quintet::job

#include "checkpoint.h"

#include <algorithm>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "film_facts.h"
#include "film_guard.h"
#include "gpu/error.h"
#include "output.h"
#include "standard_error.h"
#include "values.h"

namespace quintet::app {

using render::FilmFile;
using render::kBatchSamples;
using render::SampleRange;

namespace {

std::string errorText(const std::optional<double>& error) {
  return error ? fmt::format("an error of {:.3g} %", 100.0 * *error) : "no error to reach";
}

}  // namespace

Checkpoint::Checkpoint(Session& session, const RenderOptions& options) : session_(session), options_(options) {}

RenderLimits Checkpoint::begin() {
  RenderLimits limits{options_.samples, options_.seconds, options_.error, options_.adaptive};
  const FarmOptions& farm = options_.farm;
  if (farm.batches) {
    limits.begin = limits.done = farm.batches->first * kBatchSamples;
    limits.samples = std::min(*options_.samples, (farm.batches->last + 1) * kBatchSamples);
    session_.renderer().startAt(farm.batches->first);
  }
  const bool film = outputKind(options_.output) == OutputKind::film;
  if (!active() && !film) return limits;
  if (session_.program().accumulation == program::Accumulation::program)
    throw UsageError(
        fmt::format("the program '{}' averages its samples itself: there are no checkpoints and films of it",
                    session_.program().name));
  if (active()) {
    checkOutput(farm.checkpointFile);
    removeLeftovers(farm.checkpointFile);
    resume(limits);
  }
  // As far as it is known now how many there will be: those that are planned, or are there.
  const auto begin = static_cast<std::uint32_t>(limits.begin),
             end = static_cast<std::uint32_t>(std::max(limits.samples.value_or(0), limits.done));
  if (film && !farm.force)
    refuseLoss(options_.output, session_.identity(), {{{begin, end}}, session_.renderer().film().counts().cellBatches});
  return limits;
}

void Checkpoint::resume(RenderLimits& limits) {
  const FarmOptions& farm = options_.farm;
  const std::filesystem::path& path = farm.checkpointFile;
  if (!std::filesystem::exists(path)) {
    if (farm.resume) session_.progress().note(fmt::format("{}: there is no checkpoint, beginning", path.string()));
    return;
  }
  FilmFile file;
  try {
    file = render::readFilm(path);
    refuseOther(file.identity, session_.identity(),
                {path, "in the checkpoint", "here", "is of another rendering; --force begins anew"});
    checkPlace(file, limits);
  } catch (const FileError& error) {
    if (!farm.force) throw;
    session_.progress().note(fmt::format("{}; beginning anew", error.what()));
    return;
  }
  if (!farm.resume) {
    if (farm.force) return;
    throw FileError(
        path, fmt::format("holds {} samples of this rendering; --resume goes on from them, --force begins anew",
                          static_cast<std::uint64_t>(render::averageSamples(file.film.region, file.film.counts))));
  }
  if (file.film.counts.ranges.empty()) return;
  try {
    goOn(file, limits);
  } catch (const UsageError& error) {  // of a note, which is the file's
    throw FileError(path, "header", error.what());
  }
}

void Checkpoint::goOn(const FilmFile& file, RenderLimits& limits) {
  const std::string name = options_.farm.checkpointFile.string();
  const std::string* device = render::findFact(file.notes, "device");
  if (device && *device != session_.deviceName())
    session_.progress().note(fmt::format("{}: was begun on {}, goes on on {}", name, *device, session_.deviceName()));
  session_.renderer().restoreFilm(file.film);
  limits.done = file.film.counts.ranges.back().end;
  const auto secondsOf = [&](const char* note) {
    const std::string text = factText(file.notes, note);
    return text.empty() ? 0.0 : parseNumber(note, text, 0.0, 1e12);
  };
  limits.secondsBefore = secondsOf("seconds");
  limits.batchSecondsBefore = secondsOf("batch seconds");
  if (options_.adaptive && wantedErrorOf(file) != options_.error) {
    session_.progress().note(
        fmt::format("{}: was planned for {}, goes on for {}; a rendering from the beginning would give other samples",
                    name, errorText(wantedErrorOf(file)), errorText(options_.error)));
  } else {
    limits.plan = file.plan;
  }
  savedCounts_ = file.film.counts;
  savedSamples_ = static_cast<std::uint64_t>(render::averageSamples(file.film.region, file.film.counts));
  session_.progress().note(fmt::format("{}: going on after {} samples", name, savedSamples_));
}

void Checkpoint::checkPlace(const FilmFile& file, const RenderLimits& limits) const {
  const std::filesystem::path& path = options_.farm.checkpointFile;
  if (!render::sameArrays(file.film, session_.renderer().saveFilm()))
    throw FileError(path, "its outputs are not those of the program");
  const std::vector<SampleRange>& ranges = file.film.counts.ranges;
  if (ranges.empty()) return;
  const SampleRange range = ranges.front();
  if (ranges.size() > 1 || range.begin != limits.begin)
    throw FileError(path,
                    fmt::format("holds samples {}; those from {} on are wanted", rangesText(ranges), limits.begin));
  if (limits.samples && range.end > *limits.samples)
    throw FileError(
        path, fmt::format("holds samples {}; only those up to {} are wanted", rangesText(ranges), *limits.samples - 1));
}

void Checkpoint::save(const RenderOutcome& outcome) {
  session_.progress().stage("writing " + options_.farm.checkpointFile.string());
  try {
    writeBytes(options_.farm.checkpointFile, render::encodeFilm(session_.film(outcome)));
    savedSamples_ = outcome.samples;
    savedCounts_ = session_.renderer().film().counts();
  } catch (const FileError& error) {  // the one before is still there: rendering goes on
    warn(error.what());
  } catch (const gpu::DeviceLostError&) {  // there will be no film any more
    throw;
  } catch (const std::exception& error) {
    warn(fmt::format("{}: cannot be written: {}", options_.farm.checkpointFile.string(), error.what()));
  }
  lastWritten_ = clock_.seconds();
}

// Now, as somebody may still make room, and in the report.
void Checkpoint::warn(const std::string& text) {
  if (warned_) return;
  warned_ = true;
  session_.warnings().add(text);
  session_.progress().clear();
  if (!options_.farm.jsonProgress) return printError("quintet: warning: {}\n", text);
  const nlohmann::ordered_json line{{"warning", text}};
  printError("{}\n", line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

void Checkpoint::afterBatch(const RenderOutcome& outcome) {
  if (active() && clock_.seconds() - lastWritten_ >= *options_.farm.checkpointSeconds) save(outcome);
  if (!options_.farm.jsonProgress) return;
  nlohmann::ordered_json line{{"samples", outcome.samples}, {"seconds", outcome.seconds}};
  if (active()) line["checkpoint"] = savedSamples_;
  printError("{}\n", line.dump());
}

// Somebody may want to go on.
bool Checkpoint::isKept(const RenderOutcome& outcome) const {
  return outcome.interrupted || outcome.missed || options_.farm.keepCheckpoint;
}

void Checkpoint::afterRendering(const RenderOutcome& outcome) {
  if (isKept(outcome)) keep(outcome);
}

void Checkpoint::keep(const RenderOutcome& outcome) {
  if (active() && savedCounts_ != session_.renderer().film().counts()) save(outcome);
}

void Checkpoint::afterPicture(const RenderOutcome& outcome) {
  if (!active() || isKept(outcome)) return;
  std::error_code failed;
  std::filesystem::remove(options_.farm.checkpointFile, failed);
  if (failed)
    session_.warnings().add(
        fmt::format("{}: cannot be removed: {}", options_.farm.checkpointFile.string(), failed.message()));
}

}  // namespace quintet::app

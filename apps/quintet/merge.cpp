// `quintet merge`: parts of a rendering become the picture, or the film, that one rendering would have given.
#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "aov_notes.h"
#include "base/error.h"
#include "base/file.h"
#include "commands.h"
#include "exr_camera.h"
#include "film_facts.h"
#include "film_guard.h"
#include "film_pictures.h"
#include "merge_options.h"
#include "metadata.h"
#include "output.h"
#include "progress.h"
#include "schedule.h"
#include "values.h"

namespace quintet::app {
namespace {

using render::FilmFile;
using render::SampleRange;

constexpr std::string_view kBetween = "; ";  // devices

// "a; b": a, b
std::vector<std::string> entriesOf(const FilmFile& file, const std::string& name) {
  const std::string text = factText(file.notes, name);
  std::vector<std::string> entries;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(kBetween, at), text.size());
    entries.push_back(text.substr(at, end - at));
    at = end + kBetween.size();
  }
  return entries;
}

// Parts joined one after the other, so that only two of them are in memory.
class Merger {
 public:
  explicit Merger(Progress& progress) : progress_(progress) {}

  void add(const std::string& path) {
    FilmFile part = render::readFilm(path);
    try {
      RenderRecord unused;
      fillRecord(unused, part);
      checkShown(part);
    } catch (const UsageError& error) {
      throw FileError(path, "header", error.what());
    }
    parts_.push_back({path, part.film.counts.ranges});
    if (parts_.size() == 1) {
      whole_ = std::move(part);
      return;
    }
    refuseDifferences(part);
    if (isAdaptive(part))
      throw FileError(path, fmt::format("is of an adaptive rendering, as {}: all its samples so far decide which come "
                                        "next, so it has no parts; one "
                                        "such film alone becomes a picture",
                                        first()));
    refuseOverlap();
    if (!render::sameArrays(whole_.film, part.film)) throw FileError(path, "its outputs are not those of " + first());
    try {
      render::mergeFilm(whole_.film, part.film);
    } catch (const UsageError& error) {
      throw FileError(path, error.what());
    }
    joinNotes(part);
  }

  FilmFile& whole() { return whole_; }

 private:
  struct Part {
    std::string path;
    std::vector<SampleRange> ranges;
  };
  const std::string& first() const { return parts_.front().path; }
  const std::string& last() const { return parts_.back().path; }

  void refuseDifferences(const FilmFile& part) const {
    refuseOther(whole_.identity, part.identity,
                {last(), "in " + first(), "in " + last(), fmt::format("is of another rendering than {}", first())});
  }

  void refuseOverlap() const {
    for (std::size_t i = 0; i + 1 < parts_.size(); ++i)
      for (const SampleRange& a : parts_[i].ranges)
        for (const SampleRange& b : parts_.back().ranges)
          if (a.begin < b.end && b.begin < a.end)
            throw FileError(last(), fmt::format("samples {} to {} are in {}, too", std::max(a.begin, b.begin),
                                                std::min(a.end, b.end) - 1, parts_[i].path));
  }

  void joinNotes(const FilmFile& part) {
    for (const char* name : {"device", "driver"}) {
      const std::vector<std::string> mine = entriesOf(whole_, name);
      std::vector<std::string> joined = mine;
      for (const std::string& entry : entriesOf(part, name))
        if (std::ranges::find(joined, entry) == joined.end()) joined.push_back(entry);
      if (joined == mine) continue;
      progress_.note(fmt::format("{}: {} {}, other parts: {}", last(), name, factText(part.notes, name),
                                 factText(whole_.notes, name)));
      setFact(whole_.notes, name, fmt::format("{}", fmt::join(joined, kBetween)));
    }
    joinShown(part);
    joinAovNotes(whole_.notes, part.notes, whole_.film);
    joinCameraNotes(whole_.notes, part.notes);
    const auto seconds = [](const FilmFile& file) {
      return parseNumber("seconds", factText(file.notes, "seconds"), 0.0, 1e12);
    };
    setFact(whole_.notes, "seconds", fmt::format("{:.3f}", seconds(whole_) + seconds(part)));
  }

  // How the picture is shown is as for the part with the first samples, so that the order of the parts changes nothing.
  void joinShown(const FilmFile& part) {
    const bool isFirst = std::ranges::min(parts_, {}, firstSample).path == last();
    for (const char* name : {kExposureFact, kToneMapFact, kAllOutputsFact, "error wanted"}) {
      const std::string mine = factText(whole_.notes, name), other = factText(part.notes, name);
      if (mine == other) continue;
      const auto shown = [](const std::string& text) { return text.empty() ? "not given" : text; };
      progress_.note(fmt::format("{}: {} {}, other parts: {}; {} is taken, as for the first samples", last(), name,
                                 shown(other), shown(mine), shown(isFirst ? other : mine)));
      if (isFirst) setFact(whole_.notes, name, other);
    }
  }

  static std::uint64_t firstSample(const Part& part) {
    return part.ranges.empty() ? std::numeric_limits<std::uint64_t>::max() : part.ranges.front().begin;
  }

  Progress& progress_;
  FilmFile whole_;
  std::vector<Part> parts_;
};

// Samples that the rendering was to have, and has not.
std::vector<SampleRange> missingSamples(const FilmFile& file) {
  std::vector<SampleRange> missing;
  std::uint32_t next = 0;
  for (const SampleRange& range : file.film.counts.ranges) {
    if (range.begin > next) missing.push_back({next, range.begin});
    next = range.end;
  }
  const auto planned = static_cast<std::uint32_t>(plannedSamples(file).value_or(next));
  if (planned > next) missing.push_back({next, planned});
  return missing;
}

// Why the rendering is not complete; empty: it is.
std::string missingText(const FilmFile& file, const render::ErrorEstimate& error) {
  const std::optional<double> wanted = wantedErrorOf(file);
  const std::vector<SampleRange>& ranges = file.film.counts.ranges;
  if (wanted && error.reaches(*wanted) && ranges.size() == 1 && ranges[0].begin == 0) return "";
  const std::optional<std::uint64_t> planned = plannedSamples(file);
  if (isAdaptive(file)) {
    if (isFinished(file, error, {planned, std::nullopt, wanted, true})) return "";
    if (planned)
      return fmt::format("{:.1f} of {} samples per pixel are there",
                         render::averageSamples(file.film.region, file.film.counts), *planned);
  } else if (const std::vector<SampleRange> missing = missingSamples(file); !missing.empty())
    return fmt::format("samples {} are missing", rangesText(missing));
  if (!wanted || planned) return "";
  return fmt::format("the error of {:.2g} % that was wanted is not reached", 100.0 * *wanted);
}

void tellMissing(const FilmFile& file, const render::ErrorEstimate& error, const MergeOptions& options,
                 Progress& progress) {
  if (file.film.counts.ranges.empty()) throw Error("there are no samples in these films");
  const std::string text = missingText(file, error);
  if (text.empty()) return;
  if (outputKind(options.render.output) != OutputKind::film && !options.partial)
    throw Error(text + "; --partial makes the picture all the same");
  progress.note(text);
}

}  // namespace

int mergeCommand(Arguments arguments) {
  const std::optional<MergeOptions> options = parseMergeOptions(arguments);
  if (!options) return 0;
  const Stopwatch clock;
  Progress progress(options->render.quiet);
  Merger merger(progress);
  for (const std::string& part : options->parts) {
    progress.stage("reading " + part);
    merger.add(part);
  }
  FilmFile& whole = merger.whole();
  if (showsAllOutputs(whole, *options) && options->render.output == "-")
    throw UsageError("the parts were rendered with --all-outputs, several files: -o - takes one picture");
  RenderRecord record;
  record.commandLine = options->render.commandLine;
  fillRecord(record, whole);
  record.error = render::estimateError(whole.film);
  tellMissing(whole, record.error, *options, progress);
  const std::string unshown =
      unshownText(options->render.output, options->render.toneMap || options->render.exposure != 0);
  if (!unshown.empty()) progress.note(unshown);
  progress.stage("writing " + options->render.output.string());
  if (outputKind(options->render.output) == OutputKind::film) {
    if (!options->render.farm.force) refuseLoss(options->render.output, whole.identity, whole.film.counts);
    keepShown(whole, *options);
    record.exposure = exposureOf(whole);
    writeBytes(options->render.output, render::encodeFilm(whole));
    record.files.push_back(options->render.output.string());
  } else {
    writePictures(whole, *options, record);
  }
  record.totalSeconds = clock.seconds();
  progress.clear();
  if (options->render.json) writeFile("-", toJson(record));
  progress.note(summary(record));
  return 0;
}

}  // namespace quintet::app

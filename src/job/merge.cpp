// SPDX-License-Identifier: Apache-2.0
#include "job/merge.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/plural.h"
#include "job/film_store.h"
#include "job/sampling_schedule.h"
#include "render/film/film_reader.h"

namespace quintet::job {
namespace {

using render::FilmFile;
using render::SampleRange;

std::vector<std::string> splitList(const std::string& text) {
  std::vector<std::string> entries;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(kDeviceSeparator, at), text.size());
    entries.push_back(text.substr(at, end - at));
    at = end + kDeviceSeparator.size();
  }
  return entries;
}

// Both lists of layers (JSON, output/layers.h) as one: each name once, in the program's order.
std::string joinLayers(const std::string& a, const std::string& b) {
  using Json = nlohmann::json;
  if (a == b || b.empty()) return a;
  Json layers = Json::array();
  try {
    for (const std::string& text : {a, b}) {
      const Json list = text.empty() ? Json::array() : parseJson(text);
      for (const Json& layer : list) {
        const auto isSame = [&](const Json& known) { return known.at("name") == layer.at("name"); };
        if (std::ranges::none_of(layers, isSame)) layers.push_back(layer);
      }
    }
    std::stable_sort(layers.begin(), layers.end(),
                     [](const Json& x, const Json& y) { return x.at("order") < y.at("order"); });
  } catch (const Json::exception&) {
    throw UsageError("the layers of the film cannot be read");
  }
  return layers.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// Returns read(). What is wrong with the file itself is gone when the part is rendered again.
template <class Read>
auto readPart(const Read& read) {
  try {
    return read();
  } catch (const FileError& error) {
    throw FileError(error.file(), error.location(), error.problem() + "; render this part again");
  }
}

class Merger {
 public:
  Merger(Observer& observer, std::size_t maxMemory) : observer_(observer), maxMemory_(maxMemory) {}

  void add(const std::filesystem::path& path) {
    observer_.stage("reading " + path.string());
    render::FilmReader reader = readPart([&] { return render::FilmReader(path); });
    const FilmFile& part = reader.header();
    const Provenance provenance = provenanceOf(part, path);
    const std::vector<SampleRange> ranges = part.film.counts.ranges;
    const std::uint64_t firstSample =
        ranges.empty() ? std::numeric_limits<std::uint64_t>::max() : std::uint64_t{ranges.front().begin};
    if (first_.empty()) {
      whole_ = readPart([&] { return reader.read(maxMemory_); });
      provenance_ = provenance;
      first_ = path;
      firstSample_ = firstSample;
      addRanges(path, ranges);
      return;
    }
    requireSameIdentity(part.identity, whole_.identity, path,
                        fmt::format("a different render than {}", first_.string()), "", Remedy::none);
    if (provenance.adaptive)
      throw FileError(path,
                      fmt::format("is a film of an adaptive render, like {}: such a render has no parts, because all "
                                  "samples so far decide where the next ones are taken",
                                  first_.string()));
    addRanges(path, ranges);
    if (!reader.hasArraysOf(whole_.film))
      throw FileError(path, fmt::format("its outputs differ from those of {}", first_.string()));
    try {
      readPart([&] { reader.addTo(whole_.film); });
      join(path, provenance, firstSample < firstSample_);
    } catch (const UsageError& error) {
      throw FileError(path, error.what());
    }
    firstSample_ = std::min(firstSample_, firstSample);
  }

  FilmFile& film() { return whole_; }
  Provenance& provenance() { return provenance_; }

 private:
  struct Owner {
    std::uint32_t end = 0;
    std::filesystem::path path;
  };

  // Throws FileError if an earlier part has some of the samples.
  void addRanges(const std::filesystem::path& path, const std::vector<SampleRange>& ranges) {
    for (const SampleRange& range : ranges) {
      auto other = owners_.upper_bound(range.begin);  // the first that begins later, or else the last one before
      if (other != owners_.begin() && std::prev(other)->second.end > range.begin) --other;
      if (other != owners_.end() && other->first < range.end)
        throw FileError(
            path,
            fmt::format("shares {} with {}",
                        rangesText({{std::max(other->first, range.begin), std::min(other->second.end, range.end)}}),
                        other->second.path.string()));
      owners_[range.begin] = {range.end, path};
    }
  }

  // `isFirst`: the part has the first samples so far.
  void join(const std::filesystem::path& path, const Provenance& part, bool isFirst) {
    joinList(path, "device", provenance_.device, part.device);
    joinList(path, "driver", provenance_.driver, part.driver);
    // Display settings follow the part with the first samples, so that the order of the parts does not matter.
    for (const char* name : {"exposure", "tone map", "all outputs", "target error"})
      takeFirst(path, name, isFirst, part);
    provenance_.deviceCount = std::max(provenance_.deviceCount, part.deviceCount);  // an unset one is the smallest
    if (provenance_.farmPlan != part.farmPlan) provenance_.farmPlan.clear();
    for (const auto member : {&Provenance::instanceNames, &Provenance::materialNames})
      if ((provenance_.*member).empty()) provenance_.*member = part.*member;
    for (const auto member : {&Provenance::worldToCamera, &Provenance::worldToNdc})
      if (!(provenance_.*member)) provenance_.*member = part.*member;
    provenance_.layers = joinLayers(provenance_.layers, part.layers);
    provenance_.seconds += part.seconds;
  }

  void joinList(const std::filesystem::path& path, const char* name, std::string& whole, const std::string& part) {
    const std::vector<std::string> known = splitList(whole);
    std::vector<std::string> joined = known;
    for (const std::string& entry : splitList(part))
      if (std::ranges::find(joined, entry) == joined.end()) joined.push_back(entry);
    if (joined == known) return;
    observer_.note(fmt::format("{}: {} {}, other parts: {}", path.string(), name, part, whole));
    whole = fmt::format("{}", fmt::join(joined, kDeviceSeparator));
  }

  void takeFirst(const std::filesystem::path& path, std::string_view name, bool isFirst, const Provenance& part) {
    const auto field = std::ranges::find_if(provenanceFields(), [&](const ProvenanceField& f) {
      return f.role == ProvenanceField::Role::note && f.name == name;
    });
    const std::string ours = toText(field->get(provenance_)), theirs = toText(field->get(part));
    if (ours == theirs) return;
    const auto shown = [](const std::string& text) { return text.empty() ? "none" : text; };
    observer_.note(fmt::format("{}: {} {}, other parts: {}; using {}, the setting of the first samples", path.string(),
                               name, shown(theirs), shown(ours), shown(isFirst ? theirs : ours)));
    if (isFirst) field->set(provenance_, theirs);
  }

  Observer& observer_;
  const std::size_t maxMemory_;
  FilmFile whole_;
  Provenance provenance_;
  std::filesystem::path first_;            // part; empty before it
  std::uint64_t firstSample_ = 0;          // of all parts so far
  std::map<std::uint32_t, Owner> owners_;  // ranges of samples by their begin
};

// Samples that the render was to have and that the film lacks.
std::vector<SampleRange> missingSamples(const render::SampleCounts& counts, std::optional<std::uint64_t> planned) {
  std::vector<SampleRange> missing;
  std::uint32_t next = 0;
  for (const SampleRange& range : counts.ranges) {
    if (range.begin > next) missing.push_back({next, range.begin});
    next = range.end;
  }
  const auto end = static_cast<std::uint32_t>(planned.value_or(next));
  if (end > next) missing.push_back({next, end});
  return missing;
}

}  // namespace

RenderResult merge(const std::vector<std::filesystem::path>& parts, Observer& observer, const std::string& commandLine,
                   std::size_t maxMemory) {
  if (parts.empty()) throw UsageError("a merge requires at least one film");
  Merger merger(observer, maxMemory);
  for (const std::filesystem::path& part : parts) merger.add(part);
  FilmFile& film = merger.film();
  if (film.film.counts.ranges.empty()) throw FileError(parts.front(), "contains no samples");
  RenderResult result;
  result.error = render::estimateError(film.film);
  result.plan = std::move(film.plan);
  Provenance& p = result.provenance = std::move(merger.provenance());
  p.samples = static_cast<std::uint64_t>(render::averageSamples(film.film.region, film.film.counts));
  setCounts(result, render::countRays(film.film.statistics, film.film.region), render::findNotFinite(film.film));
  if (!commandLine.empty()) p.commandLine = commandLine;
  if (result.error.known()) {
    p.error = result.error.upper;
    p.tileError = result.error.tiles;
  }
  result.targetMissed = p.targetError && !result.error.reaches(*p.targetError);
  result.seconds.render = p.seconds;
  result.film = viewOf(std::move(film.film), p.transparent);
  return result;
}

std::string missingText(const RenderResult& merged) {
  const Provenance& p = merged.provenance;
  const render::SampleCounts counts = merged.film->counts();
  const bool fromStart = counts.ranges.size() == 1 && counts.ranges[0].begin == 0;
  if (p.targetError && !merged.targetMissed && fromStart) return "";
  if (p.adaptive) {
    render::FilmState film;
    film.region = p.region;
    film.counts = counts;
    if (isComplete(film, merged.plan, merged.error, {p.plannedSamples, std::nullopt, p.targetError, true})) return "";
    if (p.plannedSamples)
      return fmt::format("{:.1f} of {} per pixel are rendered", render::averageSamples(p.region, counts),
                         counted(*p.plannedSamples, "sample"));
  } else if (const std::vector<SampleRange> missing = missingSamples(counts, p.plannedSamples); !missing.empty()) {
    return "missing: " + rangesText(missing);
  }
  if (!p.targetError || p.plannedSamples) return "";
  return fmt::format("the target error of {:.2g} % is not reached", 100.0 * *p.targetError);
}

}  // namespace quintet::job

#include "compare_films.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "film_facts.h"
#include "film_guard.h"
#include "io/codec.h"
#include "io/compare.h"
#include "output.h"
#include "signals.h"
#include "values.h"

namespace quintet::app {
namespace {

using render::FilmFacts;
using render::FilmFile;
using render::ZTest;
using render::ZTestMeans;
using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 4> kChannels{"red", "green", "blue", "alpha"};

FilmFile readFilmToTest(const std::string& path) {
  const std::vector<std::byte> bytes = readFile(path);
  if (!bytes.empty() && !render::isFilmFile(bytes))
    throw FileError(path, "is not a film (.qfilm); --z-test needs films, because a picture does not tell its noise");
  return render::decodeFilm(bytes, path);
}

bool matches(const std::string& fact, const std::string& name) { return fact == name || fact.starts_with(name + " "); }

// Both must agree in what remains.
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
      throw UsageError(fmt::format("--may-differ: films have no '{}'{}; 'quintet info FILM' lists what they have",
                                   plain(name), suggestion(name, known)));
}

bool shareSamples(const FilmFile& a, const FilmFile& b) {
  for (const render::SampleRange& r : a.film.counts.ranges)
    for (const render::SampleRange& s : b.film.counts.ranges)
      if (r.begin < s.end && s.begin < r.end) return true;
  return false;
}

std::uint64_t droppedSamples(const FilmFile& file) {
  std::uint64_t sum = 0;
  for (const uvec2& pixel : file.film.statistics) sum += pixel.y;
  return sum;
}

// Per pixel; of an adaptive film on average.
std::uint64_t samplesOf(const FilmFile& file) {
  return static_cast<std::uint64_t>(render::averageSamples(file.film.region, file.film.counts));
}

// What a reader of the verdict should know.
std::vector<std::string> notesOn(const FilmFile& a, const FilmFile& b) {
  std::vector<std::string> notes;
  const std::string seed = factText(a.identity, "seed");
  if (seed == factText(b.identity, "seed") && shareSamples(a, b))
    notes.push_back(
        fmt::format("both films have the same samples of seed {}: their difference is rounding, not noise, "
                    "and the test says little; render one with another --seed",
                    plain(seed)));
  if (samplesOf(a) != samplesOf(b))
    notes.push_back(
        "the films have different numbers of samples: rare bright samples make the difference lopsided, "
        "and p less exact");
  for (const FilmFile* film : {&a, &b})
    if (const std::uint64_t dropped = droppedSamples(*film); dropped > 0)
      notes.push_back(
          fmt::format("{} samples of {} were not finite and are left out", dropped, film == &a ? "A" : "B"));
  return notes;
}

double relative(const ZTestMeans& m, double value) {
  const double mean = 0.5 * (std::abs(m.mean[0]) + std::abs(m.mean[1]));
  return mean > 0.0 ? value / mean : 0.0;
}

Json meansJson(const ZTestMeans& m) {
  return {{"channel", kChannels[m.channel]},
          {"p", m.p},
          {"region", {m.region.x, m.region.y, m.region.width, m.region.height}},
          {"means", m.mean},
          {"errors", m.error},
          {"freedom", m.freedom},
          {"difference", relative(m, m.difference())},
          {"differenceError", relative(m, m.differenceError())}};
}

std::string jsonReport(const FilmComparison& comparison, const std::array<FilmFile, 2>& films, const ZTest& test,
                       const std::vector<std::string>& notes) {
  const auto both = [&](const auto& get) { return Json::array({get(films[0]), get(films[1])}); };
  const auto note = [&](const char* name) { return both([&](const FilmFile& f) { return factText(f.notes, name); }); };
  const render::Region& region = films[0].film.region;
  Json image = Json::array();
  for (const ZTestMeans& m : test.image) image.push_back(meansJson(m));
  const Json json{{"a", comparison.a},
                  {"b", comparison.b},
                  {"same", !test.rejected},
                  {"level", comparison.test.level},
                  {"size", {region.width, region.height}},
                  {"samples", both(samplesOf)},
                  {"batches", both([](const FilmFile& f) {
                     return (samplesOf(f) + render::kBatchSamples - 1) / render::kBatchSamples;
                   })},
                  {"seeds", both([](const FilmFile& f) { return factText(f.identity, "seed"); })},
                  {"devices", note("device")},
                  {"drivers", note("driver")},
                  {"block", comparison.test.block},
                  {"blocks", test.blocks.size() / test.image.size()},
                  {"tests", test.blocks.size()},
                  {"blockLevel", test.blockLevel},
                  {"smallest", meansJson(test.blocks[test.smallest])},
                  {"imageLevel", test.imageLevel},
                  {"image", image},
                  {"distribution",
                   {{"noisyTests", test.noisy},
                    {"rms", test.rms},
                    {"beyond1.96", test.beyond[0]},
                    {"beyond2.58", test.beyond[1]},
                    {"beyond3.29", test.beyond[2]}}},
                  {"nonFinitePixels", test.nonFinitePixels},
                  {"unknownPixels", test.unknownPixels},
                  {"notes", notes}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string filmLine(const std::string& path, const FilmFile& file) {
  return fmt::format("{}: {}, seed {}, {}\n", plain(path), samplesText(file), plain(factText(file.identity, "seed")),
                     plain(factText(file.notes, "device")));
}

std::string place(const ZTestMeans& m) {
  return fmt::format("x {} to {}, y {} to {}, {}", m.region.x, m.region.x + m.region.width - 1, m.region.y,
                     m.region.y + m.region.height - 1, kChannels[m.channel]);
}

std::string meansText(const ZTestMeans& m) {
  return fmt::format("{:.6g} ± {:.2g} against {:.6g} ± {:.2g}", m.mean[0], m.error[0], m.mean[1], m.error[1]);
}

std::string textReport(const FilmComparison& comparison, const std::array<FilmFile, 2>& films, const ZTest& test,
                       const std::vector<std::string>& notes) {
  std::string text = filmLine(comparison.a, films[0]) + filmLine(comparison.b, films[1]);
  const ZTestMeans& smallest = test.blocks[test.smallest];
  text += fmt::format("blocks: {} of {}x{} pixels, {} channels; p below {:.3g} rejects\n",
                      test.blocks.size() / test.image.size(), comparison.test.block, comparison.test.block,
                      test.image.size(), test.blockLevel);
  text += fmt::format("   smallest p {:.3g} at {}: {}\n", smallest.p, place(smallest), meansText(smallest));
  text += fmt::format("   |t| of {} with noise: root mean square {:.2f}", test.noisy, test.rms);
  constexpr std::array<double, 3> kExpected{5, 1, 0.1};
  for (std::size_t i = 0; i < kExpected.size(); ++i)
    text += fmt::format("{} {:.2f} in {:.2f} % (normal: {} %)", i == 0 ? "; beyond" : ",", ZTest::kZ[i],
                        100.0 * test.beyond[i], kExpected[i]);
  text += fmt::format("\nwhole image: p below {:.3g} rejects\n", test.imageLevel);
  for (const ZTestMeans& m : test.image)
    text += fmt::format("   {:<5} p {:<8.3g} {:+.4f} % ± {:.4f} %   {}\n", kChannels[m.channel], m.p,
                        100.0 * relative(m, m.difference()), 100.0 * relative(m, m.differenceError()), meansText(m));
  if (test.nonFinitePixels > 0) text += fmt::format("{} pixels are not finite\n", test.nonFinitePixels);
  if (test.unknownPixels > 0)
    text += fmt::format("{} pixels are too bright to know their noise and were not tested\n", test.unknownPixels);
  for (const std::string& note : notes) text += "note: " + note + "\n";
  return text + fmt::format("{} at level {}\n", test.rejected ? "not the same picture" : "the same picture",
                            comparison.test.level);
}

// Why the test rejects, in a line.
std::string reason(const ZTest& test) {
  if (test.nonFinitePixels > 0) return fmt::format("{} pixels are not finite", test.nonFinitePixels);
  const auto worst = std::ranges::min_element(test.image, {}, &ZTestMeans::p);
  if (worst->p < test.imageLevel)
    return fmt::format("the whole image, {}, p {:.3g}: {}", kChannels[worst->channel], worst->p, meansText(*worst));
  const ZTestMeans& block = test.blocks[test.smallest];
  return fmt::format("{}, p {:.3g}: {}", place(block), block.p, meansText(block));
}

void writeMap(const std::string& file, const ZTest& test, const render::Region& region) {
  if (file.empty()) return;
  const std::vector<std::byte> bytes = io::encodePng(io::colorMap(render::zTestMap(test, region)));
  const ProtectedWrite protect;
  writeFile(file, bytes);
}

}  // namespace

void compareFilms(const FilmComparison& comparison) {
  const std::array<FilmFile, 2> films{readFilmToTest(comparison.a), readFilmToTest(comparison.b)};
  checkNames(films[0].identity, comparison.mayDiffer);
  std::vector<std::string> mayDiffer = comparison.mayDiffer;
  mayDiffer.insert(mayDiffer.end(), {"seed", "samples planned"});
  refuseOther(without(films[0].identity, mayDiffer), without(films[1].identity, mayDiffer),
              {comparison.b, "in " + comparison.a, "in " + comparison.b,
               fmt::format("is of another rendering than {}; --may-differ NAME allows a difference", comparison.a)});
  render::ZTestOptions options = comparison.test;
  const auto transparent = [](const FilmFile& file) { return factText(file.identity, "transparent") == "yes"; };
  options.channels = std::ranges::all_of(films, transparent) ? 4 : 3;
  const auto tested = [&] {
    try {
      return render::zTest(films[0].film, films[1].film, options);
    } catch (const UsageError& error) {
      throw Error(fmt::format("{} and {}: {}", comparison.a, comparison.b, error.what()));
    }
  };
  const ZTest test = tested();
  const std::vector<std::string> notes = notesOn(films[0], films[1]);
  writeMap(comparison.output, test, films[0].film.region);
  writeFile("-",
            comparison.json ? jsonReport(comparison, films, test, notes) : textReport(comparison, films, test, notes));
  if (test.rejected)
    throw Error(fmt::format("{} and {}: not the same picture at level {}: {}", comparison.a, comparison.b,
                            options.level, reason(test)));
}

}  // namespace quintet::app

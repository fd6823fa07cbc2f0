// SPDX-License-Identifier: Apache-2.0
#include "output/comparison_report.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/plural.h"
#include "base/text.h"
#include "job/film_store.h"
#include "output/json_line.h"

namespace quintet::output {
namespace {

using Json = nlohmann::ordered_json;
using render::ZTest;
using render::ZTestMeans;

constexpr std::array<const char*, 4> kChannels{"red", "green", "blue", "alpha"};

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

std::string regionText(const ZTestMeans& m) {
  return fmt::format("x {}–{}, y {}–{}, {}", m.region.x, m.region.x + m.region.width - 1, m.region.y,
                     m.region.y + m.region.height - 1, kChannels[m.channel]);
}

std::string meansText(const ZTestMeans& m) {
  return fmt::format("{:.6g} ± {:.2g} against {:.6g} ± {:.2g}", m.mean[0], m.error[0], m.mean[1], m.error[1]);
}

std::string nonFiniteText(const ZTest& test) {
  return fmt::format("{} {} not finite", counted(test.nonFinitePixels, "pixel"),
                     nounFor(test.nonFinitePixels, "is", "are"));
}

}  // namespace

std::vector<Measure> measures(const io::Comparison& c) {
  return {{"mae8", "mean absolute difference, in steps of 1/255", c.mae8},
          {"max8", "largest difference, in steps of 1/255", c.max8},
          {"psnr", "peak signal to noise ratio, dB", c.psnr, true},
          {"rmse", "root mean square difference, linear light", c.rmse},
          {"relmse", "relative mean square error, linear light", c.relMse},
          {"flip", "mean FLIP error, 0 to 1", c.flip},
          {"alpha8", "mean absolute difference of alpha, in steps of 1/255", c.alphaMae8}};
}

std::string comparisonText(const io::Comparison& comparison) {
  std::string text;
  for (const Measure& m : measures(comparison)) text += fmt::format("{:<8}{:<12.6g}{}\n", m.name, m.value, m.meaning);
  if (comparison.nonFinitePixels > 0)
    text += fmt::format("{} NaN or infinity\n", comparison.nonFinitePixels == 1
                                                    ? "1 pixel contains"
                                                    : fmt::format("{} pixels contain", comparison.nonFinitePixels));
  return text;
}

std::string comparisonJson(const io::Comparison& comparison, const std::string& a, const std::string& b, uvec2 size) {
  Json json{{"a", a}, {"b", b}, {"size", {size.x, size.y}}};
  for (const Measure& m : measures(comparison)) json[m.name] = std::isfinite(m.value) ? Json(m.value) : Json();
  json["nonFinitePixels"] = comparison.nonFinitePixels;
  return jsonLine(json);
}

std::string comparisonJson(const job::FilmComparison& c) {
  const auto both = [&](const auto& get) { return Json::array({get(0), get(1)}); };
  const ZTest& test = c.test;
  const render::Region& region = c.films[0].film.region;
  Json image = Json::array();
  for (const ZTestMeans& m : test.image) image.push_back(meansJson(m));
  return jsonLine({{"a", c.files[0].string()},
                   {"b", c.files[1].string()},
                   {"same", !test.rejected},
                   {"level", c.options.level},
                   {"size", {region.width, region.height}},
                   {"samples", both([&](std::size_t i) { return c.samples(i); })},
                   {"batches", both([&](std::size_t i) {
                      return (c.samples(i) + render::kBatchSamples - 1) / render::kBatchSamples;
                    })},
                   {"seeds", both([&](std::size_t i) { return fmt::format("{}", c.provenance[i].seed); })},
                   {"devices", both([&](std::size_t i) { return c.provenance[i].device; })},
                   {"drivers", both([&](std::size_t i) { return c.provenance[i].driver; })},
                   {"block", c.options.block},
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
                   {"notes", c.notes}});
}

std::string comparisonText(const job::FilmComparison& c) {
  const ZTest& test = c.test;
  std::string text;
  for (std::size_t i = 0; i < 2; ++i)
    text += fmt::format("{}: {}, seed {}, {}\n", printable(c.files[i].string()), job::samplesText(c.films[i].film),
                        c.provenance[i].seed, printable(c.provenance[i].device));
  const ZTestMeans& smallest = test.blocks[test.smallest];
  text += fmt::format("blocks: {} of {}x{} pixels, {}; rejected if p is below {:.3g}\n",
                      test.blocks.size() / test.image.size(), c.options.block, c.options.block,
                      counted(test.image.size(), "channel"), test.blockLevel);
  text += fmt::format("   smallest p {:.3g} at {}: {}\n", smallest.p, regionText(smallest), meansText(smallest));
  text += fmt::format("   |t| of {}: root mean square {:.2f}", counted(test.noisy, "noisy block"), test.rms);
  constexpr std::array<double, 3> kExpected{5, 1, 0.1};
  for (std::size_t i = 0; i < kExpected.size(); ++i)
    text += fmt::format("{} {:.2f} in {:.2f} % (normal: {} %)", i == 0 ? "; above" : ",", ZTest::kZ[i],
                        100.0 * test.beyond[i], kExpected[i]);
  text += fmt::format("\nwhole image: rejected if p is below {:.3g}\n", test.imageLevel);
  for (const ZTestMeans& m : test.image)
    text += fmt::format("   {:<5} p {:<8.3g} {:+.4f} % ± {:.4f} %   {}\n", kChannels[m.channel], m.p,
                        100.0 * relative(m, m.difference()), 100.0 * relative(m, m.differenceError()), meansText(m));
  if (test.nonFinitePixels > 0) text += nonFiniteText(test) + "\n";
  if (test.unknownPixels > 0)
    text += test.unknownPixels == 1
                ? "1 pixel is too bright for its noise to be known and was not tested\n"
                : fmt::format("{} pixels are too bright for their noise to be known and were not tested\n",
                              test.unknownPixels);
  for (const std::string& note : c.notes) text += "note: " + note + "\n";
  return text + fmt::format("{} at level {}\n", test.rejected ? "different images" : "the same image", c.options.level);
}

std::string rejectionText(const job::FilmComparison& c) {
  const ZTest& test = c.test;
  if (test.nonFinitePixels > 0) return nonFiniteText(test);
  const auto worst = std::ranges::min_element(test.image, {}, &ZTestMeans::p);
  if (worst->p < test.imageLevel)
    return fmt::format("the whole image, {}, p {:.3g}: {}", kChannels[worst->channel], worst->p, meansText(*worst));
  const ZTestMeans& block = test.blocks[test.smallest];
  return fmt::format("{}, p {:.3g}: {}", regionText(block), block.p, meansText(block));
}

}  // namespace quintet::output

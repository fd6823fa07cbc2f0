// SPDX-License-Identifier: Apache-2.0
#include "job/result.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "base/luminance.h"
#include "base/plural.h"
#include "render/tone_map/tone_map.h"

namespace quintet::job {
namespace {

class HostFilm : public FilmView {
 public:
  HostFilm(render::FilmState film, bool transparent) : film_(std::move(film)), transparent_(transparent) {}

  const std::vector<render::FilmPlane>& planes() const override { return film_.planes; }
  bool stores(std::size_t output) const override { return film_.planes.at(output).stored(); }
  render::SampleCounts counts() const override { return film_.counts; }
  io::Image image(std::size_t output) const override {
    io::Image image = render::planeImage(film_, output);
    if (film_.planes[output].kind == program::OutputKind::display) render::decodeDisplay(image, transparent_);
    return image;
  }
  render::FilmPlane plane(std::size_t output) const override { return film_.planes.at(output); }
  io::Image variance() const override { return render::varianceImage(film_); }
  render::FilmState state() const override { return film_; }

 private:
  render::FilmState film_;
  bool transparent_;
};

// Why the target error was not reached.
std::string targetMissedText(const RenderResult& result) {
  const std::string missed =
      fmt::format("the target error of {:.2g} % was not reached", 100.0 * *result.provenance.targetError);
  if (result.provenance.samples <= render::kBatchSamples) return missed + ": the error is unknown below two batches";
  if (!result.error.known())
    return missed + ": the error is unknown, because some pixels exceed the range of the film's sums";
  return fmt::format("{}: the error is {:.2g} %, and at most {:.2g} % in 95 % of the tiles", missed,
                     100.0 * result.error.upper, 100.0 * result.error.tiles);
}

// Whether the mean of the path tracer's image is 0 in 8 bits. Other programs can be black for a reason.
bool isBlack(const RenderResult& result) {
  constexpr double kBlack = 1e-4;
  if (result.provenance.program != "pathtracer" || !result.film || !result.film->stores(0)) return false;
  const io::Image image = result.film->image(0);
  const auto samples = image.samples<float>();
  double sum = 0.0, alpha = 0.0;
  for (std::size_t i = 0; i + 3 < samples.size(); i += 4) {
    sum += luminance(vec3(samples[i], samples[i + 1], samples[i + 2]));
    alpha += samples[i + 3];
  }
  return alpha > 0.0 && sum <= kBlack * alpha;
}

// "; the first is at pixel (34, 120), counted from the top left corner"
std::string pixelText(std::uint64_t count, const std::optional<PixelPosition>& first) {
  if (!first) return "";
  return fmt::format("; {} at pixel ({}, {}), counted from the top left corner", count == 1 ? "it is" : "the first is",
                     first->x, first->y);
}

void describeNotFinite(RenderResult& result) {
  Provenance& p = result.provenance;
  p.notFinitePixels = 0;
  p.firstNotFinitePixel.reset();
  for (const render::NotFinitePixels& pixels : result.notFinite) {
    if (!p.firstNotFinitePixel) p.firstNotFinitePixel = PixelPosition{pixels.first.x, pixels.first.y};
    p.notFinitePixels += pixels.count;
  }
}

// The one that comes first row by row.
std::optional<PixelPosition> firstOf(const std::optional<PixelPosition>& a, const std::optional<PixelPosition>& b) {
  if (!a || !b) return a ? a : b;
  return std::tie(a->y, a->x) <= std::tie(b->y, b->x) ? a : b;
}

}  // namespace

std::shared_ptr<const FilmView> viewOf(render::FilmState film, bool transparent) {
  return std::make_shared<HostFilm>(std::move(film), transparent);
}

double MemoryUse::ratio() const {
  const std::uint64_t needed = geometry + textures + acceleration + primitiveMaps;
  const std::uint64_t peak = deviceIsHost ? peakHost : std::max(peakHost, peakDevice);
  return needed > 0 ? static_cast<double>(peak) / static_cast<double>(needed) : 0.0;
}

double RenderResult::raysPerSecond() const {
  return provenance.seconds > 0 ? static_cast<double>(provenance.rays) / provenance.seconds : 0;
}

std::vector<std::string> resultWarnings(const RenderResult& result) {
  std::vector<std::string> warnings;
  if (result.targetMissed && !result.interrupted) warnings.push_back(targetMissedText(result));
  if (isBlack(result))
    warnings.push_back(
        "the image is black, or nearly so, because hardly any light reaches the camera; a closed surface around the "
        "camera keeps the environment and the sun out");
  for (const Diagnostic& finding : runFindings(result))
    warnings.push_back(finding.text +
                       (finding.id.empty() ? "" : fmt::format("; see 'quintet explain {}'", finding.id)));
  return warnings;
}

std::vector<Diagnostic> runFindings(const RenderResult& result) {
  std::vector<Diagnostic> findings;
  if (const std::uint64_t count = result.provenance.droppedSamples; count > 0)
    findings.push_back({Severity::warning, "", 0, 0, "",
                        fmt::format("{} {} not finite and {} omitted", counted(count, "sample"),
                                    nounFor(count, "was", "were"), nounFor(count, "is", "are")) +
                            pixelText(count, result.provenance.firstDroppedSample)});
  for (const render::NotFinitePixels& pixels : result.notFinite)
    findings.push_back({Severity::warning, "", 0, 0, "Q002",
                        fmt::format("{} of the output '{}' {}", counted(pixels.count, "pixel"), pixels.output,
                                    result.accumulatesFrames
                                        ? nounFor(pixels.count, "was", "were") + " not finite in at least one frame"
                                        : nounFor(pixels.count, "is", "are") + " not finite") +
                            pixelText(pixels.count, PixelPosition{pixels.first.x, pixels.first.y})});
  if (result.skippedTraces > 0) {
    const std::string were = nounFor(result.skippedTraces, "was", "were");
    findings.push_back({Severity::warning, "", 0, 0, "Q003",
                        fmt::format("{} {} deeper than the recursion depth {} of the pipeline and {} not executed",
                                    counted(result.skippedTraces, "trace"), were, result.recursionDepth, were)});
  }
  return findings;
}

void setCounts(RenderResult& result, const render::RayCount& rays, std::vector<render::NotFinitePixels> notFinite) {
  Provenance& p = result.provenance;
  p.rays = rays.rays;
  p.droppedSamples = rays.droppedSamples;
  p.firstDroppedSample.reset();
  if (rays.droppedSamples > 0) p.firstDroppedSample = PixelPosition{rays.firstDropped.x, rays.firstDropped.y};
  result.notFinite = std::move(notFinite);
  describeNotFinite(result);
}

void addFrame(RenderResult& result, const RenderResult& frame) {
  Provenance& p = result.provenance;
  p.rays += frame.provenance.rays;
  p.droppedSamples += frame.provenance.droppedSamples;
  result.skippedTraces += frame.skippedTraces;
  p.firstDroppedSample = firstOf(p.firstDroppedSample, frame.provenance.firstDroppedSample);
  for (const render::NotFinitePixels& pixels : frame.notFinite) {
    const auto known = std::ranges::find(result.notFinite, pixels.output, &render::NotFinitePixels::output);
    if (known == result.notFinite.end()) {
      result.notFinite.push_back(pixels);
      continue;
    }
    known->count += pixels.count;
    if (std::tie(pixels.first.y, pixels.first.x) < std::tie(known->first.y, known->first.x))
      known->first = pixels.first;
  }
  describeNotFinite(result);
}

render::FilmFile filmFileOf(const RenderResult& result) {
  return {toFacts(result.provenance, ProvenanceField::Role::identity),
          toFacts(result.provenance, ProvenanceField::Role::note), result.film->state(), result.plan};
}

}  // namespace quintet::job

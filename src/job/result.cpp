// SPDX-License-Identifier: Apache-2.0
#include "job/result.h"

#include <algorithm>

#include <fmt/format.h>

#include "render/tone_map/tone_map.h"

namespace quintet::job {
namespace {

class StoredFilm : public FilmView {
 public:
  StoredFilm(render::FilmState film, bool transparent) : film_(std::move(film)), transparent_(transparent) {}

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

}  // namespace

std::shared_ptr<const FilmView> viewOf(render::FilmState film, bool transparent) {
  return std::make_shared<StoredFilm>(std::move(film), transparent);
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
  if (const std::uint64_t count = result.provenance.droppedSamples; count > 0)
    warnings.push_back(count == 1 ? "1 sample was not finite and is omitted"
                                  : fmt::format("{} samples were not finite and are omitted", count));
  return warnings;
}

render::FilmFile filmFileOf(const RenderResult& result) {
  using Role = ProvenanceField::Role;
  return {toFacts(result.provenance, Role::identity), toFacts(result.provenance, Role::note), result.film->state(),
          result.plan};
}

}  // namespace quintet::job

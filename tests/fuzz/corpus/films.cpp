// SPDX-License-Identifier: Apache-2.0
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "job/provenance.h"
#include "render/film/fixed_sum.h"
#include "seeds.h"

namespace quintet::fuzz {
namespace {

using Role = job::ProvenanceField::Role;

job::Provenance provenance() {
  job::Provenance p;
  p.version = "1.2.3";
  p.sceneHash = p.environmentHash = p.programHash = p.libraryHash = std::string(32, 'a');
  p.program = "pathtracer";
  p.parameterValues = {{"bounces", "12"}, {"tint", "[1,0.5,0]"}};
  p.projection = "perspective, 0.7854 rad";
  p.size = {8, 6};
  p.region = {2, 1, 4, 3};
  p.seed = 3;
  p.plannedSamples = 16;
  p.targetError = 0.02;
  p.exposure = -0.5;
  p.instanceNames = {"a", ""};
  p.worldToCamera = mat4(0.5f);
  return p;
}

render::FilmState film(const job::Provenance& p) {
  render::FilmState film;
  film.region = p.region;
  film.counts.ranges = {{0, 16}};
  film.statistics.assign(film.pixelCount(), uvec2(7, 1));
  std::vector<shared::FixedSum> sums(4 * film.pixelCount());
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = render::fixedFromFloat(0.25f * static_cast<float>(i));
  film.planes.push_back({.name = "color", .sums = sums, .squares = sums});
  film.planes.push_back({.name = "albedo", .sums = sums});
  render::FilmPlane depth{.name = "depth", .pixel = program::OutputPixel::center, .kind = program::OutputKind::depth};
  depth.values.assign(film.pixelCount(), vec4(2.0f));
  render::FilmPlane id{.name = "id", .pixel = program::OutputPixel::coverage, .kind = program::OutputKind::id};
  id.coverage.resize(film.pixelCount() * shared::kCoverageSlots);
  film.planes.push_back(std::move(depth));
  film.planes.push_back(std::move(id));
  return film;
}

}  // namespace

void addFilmSeeds(Corpora& corpora) {
  job::Provenance p = provenance();
  render::FilmFile file{toFacts(p, Role::identity), toFacts(p, Role::note), film(p), {}};
  corpora["film"].push_back({"outputs.qfilm", render::encodeFilm(file)});
  p.adaptive = true;
  file.identity = toFacts(p, Role::identity);
  file.film.counts.cellBatches = {4, 5};
  file.plan = {6, 5};
  file.film.planes.resize(1);
  corpora["film"].push_back({"adaptive.qfilm", render::encodeFilm(file)});
}

}  // namespace quintet::fuzz

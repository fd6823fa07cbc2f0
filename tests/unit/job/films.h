// SPDX-License-Identifier: Apache-2.0
// Small films for tests: their sums are arbitrary, their facts are those of a render.
#ifndef QUINTET_TESTS_UNIT_JOB_FILMS_H
#define QUINTET_TESTS_UNIT_JOB_FILMS_H

#include <algorithm>
#include <string>
#include <vector>

#include "job/observer.h"
#include "job/provenance.h"
#include "job/result.h"
#include "render/film/fixed_sum.h"

namespace quintet::job::test {

inline bool equalSums(const std::vector<shared::FixedSum>& a, const std::vector<shared::FixedSum>& b) {
  return std::ranges::equal(
      a, b, [](const shared::FixedSum& x, const shared::FixedSum& y) { return std::ranges::equal(x.word, y.word); });
}

// Every field has a value, so that a forgotten one is noticed.
inline Provenance makeProvenance() {
  Provenance p;
  p.version = "1.2.3";
  p.sceneHash = std::string(32, 'a');
  p.environmentHash = std::string(32, 'b');
  p.program = "pathtracer";
  p.programHash = std::string(32, 'c');
  p.libraryHash = std::string(32, 'd');
  p.parameterValues = {{"bounces", "12"}, {"tint", "[1,0.5,0]"}};
  p.projection = "perspective, 0.7854 rad";
  p.cameraPosition = "0 1 5";
  p.cameraAxes = "1 0 0, 0 1 0, 0 0 1";
  p.lens = "0.01, 4";
  p.size = {8, 6};
  p.region = {2, 1, 4, 3};
  p.seed = 4'000'000'000;
  p.plannedSamples = 16;
  p.adaptive = false;
  p.transparent = true;
  p.shutter = "-0.25,0.25";
  p.outputs = "color, albedo";
  p.commandLine = "quintet render 'a b.glb' --spp 16";
  p.scene = "a b.glb";
  p.environment = "sky.hdr";
  p.camera = "camera 0 'Main'";
  p.parameters = "bounces=12 tint=1,0.5,0";
  p.device = "lavapipe";
  p.driver = "lavapipe 25.0.7";
  p.seconds = 1.0 / 3.0;
  p.batchSeconds = 0.1;
  p.targetError = 0.02;
  p.exposure = -0.5;
  p.toneMap = "aces";
  p.allOutputs = true;
  p.instanceNames = {"a \"quoted\" name", "", "ü"};
  p.materialNames = {"m"};
  p.worldToCamera = mat4(1.0f / 3.0f);
  p.worldToNdc = mat4(-2.5e-7f);
  return p;
}

inline render::FilmState makeFilm(const Provenance& p, std::vector<render::SampleRange> ranges) {
  render::FilmState film;
  film.region = p.region;
  film.counts.ranges = std::move(ranges);
  std::vector<shared::FixedSum> sums(4 * film.pixelCount());
  for (std::size_t i = 0; i < sums.size(); ++i)
    sums[i] =
        render::fixedFromFloat(static_cast<float>(film.counts.samples()) * (0.5f + 0.01f * static_cast<float>(i)));
  film.planes.push_back({.name = "color", .sums = sums, .squares = sums});
  film.planes.push_back({.name = "albedo"});
  film.statistics.assign(film.pixelCount(), uvec2(7, 1));
  return film;
}

inline render::FilmFile makeFilmFile(const Provenance& p, std::vector<render::SampleRange> ranges) {
  using Role = ProvenanceField::Role;
  return {toFacts(p, Role::identity), toFacts(p, Role::note), makeFilm(p, std::move(ranges)), {}};
}

// Collects what a job reports.
struct RecordingObserver : Observer {
  void note(const std::string& text) override { notes.push_back(text); }
  void warning(const std::string& text) override { warnings.push_back(text); }
  std::vector<std::string> notes, warnings;
};

}  // namespace quintet::job::test
#endif

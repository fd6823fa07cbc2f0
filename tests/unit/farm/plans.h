// SPDX-License-Identifier: Apache-2.0
// A small plan and its parts for tests: films as 'farm run' writes them, without rendering.
#ifndef QUINTET_TESTS_UNIT_FARM_PLANS_H
#define QUINTET_TESTS_UNIT_FARM_PLANS_H

#include <filesystem>
#include <vector>

#include "farm/plan.h"
#include "job/films.h"
#include "render/film/film_file.h"

namespace quintet::farm::test {

// Of an image with 4 batches: 16 samples.
inline Plan makePlan(const std::filesystem::path& folder, std::uint64_t parts) {
  const job::Provenance p = job::test::makeProvenance();
  Plan plan;
  plan.version = p.version;
  plan.libraryHash = p.libraryHash;
  plan.scene = "/scenes/a b.glb";
  plan.sceneHash = p.sceneHash;
  plan.environmentHash = p.environmentHash;
  plan.programHash = p.programHash;
  plan.options = {"--spp", "16", "--env", "ü \"quoted\".hdr"};
  plan.workingFolder = "/scenes";
  plan.image = folder / "a b.png";
  plan.samples = 16;
  plan.parts = splitWork(0, 3, parts, "batch", "batches");
  plan.folder = folder;
  for (const std::filesystem::path& path : planFolders(plan)) std::filesystem::create_directories(path);
  return plan;
}

// The film of a part. `change` may change its provenance.
template <class Change>
void writePart(const Plan& plan, std::size_t part, const Change& change) {
  job::Provenance p = job::test::makeProvenance();
  p.targetError.reset();
  p.farmPlan = planId(plan);
  change(p);
  render::writeFilm(partFile(plan, part), job::test::makeFilmFile(p, {samplesOf(plan, part)}));
}
inline void writePart(const Plan& plan, std::size_t part) {
  writePart(plan, part, [](job::Provenance&) {});
}

}  // namespace quintet::farm::test
#endif

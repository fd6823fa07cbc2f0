// SPDX-License-Identifier: Apache-2.0
// quintet_farm_parts FOLDER: fills the plan in FOLDER with copies of its first part, whose samples become those of the
// other parts. So merging and checking thousands of parts can be measured without rendering them. The image is meaningless.
#include <cstdio>
#include <exception>

#include "base/file.h"
#include "base/parallel.h"
#include "farm/plan.h"
#include "render/film/film_file.h"

int main(int argc, char** argv) {
  using namespace quintet;
  if (argc != 2) {
    std::fputs("usage: quintet_farm_parts FOLDER\n", stderr);
    return 2;
  }
  try {
    const farm::Plan plan = farm::readPlan(argv[1]);
    const render::FilmFile first = render::readFilm(farm::partFile(plan, 0));
    parallelFor(plan.parts.size() - 1, [&](std::size_t i) {
      render::FilmFile part = first;
      part.film.counts.ranges = {farm::samplesOf(plan, i + 1)};
      render::writeFilm(farm::partFile(plan, i + 1), part);
    });
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "quintet_farm_parts: %s\n", error.what());
    return 1;
  }
}

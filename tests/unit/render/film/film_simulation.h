// SPDX-License-Identifier: Apache-2.0
// Films whose samples are known: renders gray pixels on the host, batch by batch.
#ifndef QUINTET_TESTS_UNIT_RENDER_FILM_FILM_SIMULATION_H
#define QUINTET_TESTS_UNIT_RENDER_FILM_FILM_SIMULATION_H

#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "render/film/film_state.h"
#include "render/film/fixed_sum.h"

namespace quintet::render {

using Draw = std::function<double(std::uint32_t x, std::uint32_t y)>;  // one sample of a gray pixel

struct FilmSimulation {
  FilmState film;
  explicit FilmSimulation(std::uint32_t width, std::uint32_t height) {
    film.region = {0, 0, width, height};
    const std::size_t words = 4 * film.pixelCount();
    film.planes = {{.name = "color",
                    .sums = std::vector<shared::FixedSum>(words),
                    .squares = std::vector<shared::FixedSum>(words)}};
  }
  void addBatch(const Draw& draw, std::uint32_t x, std::uint32_t y) {
    double sum = 0;
    for (std::uint32_t s = 0; s < kBatchSamples; ++s) sum += draw(x, y);
    const auto value = static_cast<float>(sum);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t i = 4 * (std::size_t{y} * film.region.width + x) + c;
      film.planes[0].sums[i] = addFixed(film.planes[0].sums[i], fixedFromFloat(value));
      film.planes[0].squares[i] = addFixed(film.planes[0].squares[i], fixedFromFloat(value * value / kBatchSamples));
    }
  }
  // Adds the same number of batches to all pixels.
  void render(const Draw& draw, std::uint32_t batches) {
    for (std::uint32_t y = 0; y < film.region.height; ++y)
      for (std::uint32_t x = 0; x < film.region.width; ++x)
        for (std::uint32_t b = 0; b < batches; ++b) addBatch(draw, x, y);
    film.counts.add({0, batches * kBatchSamples});
  }
  // Adds the batches that each cell lacks in `plan`.
  void complete(const Draw& draw, const std::vector<std::uint32_t>& plan) {
    for (std::uint32_t y = 0; y < film.region.height; ++y)
      for (std::uint32_t x = 0; x < film.region.width; ++x) {
        const std::uint32_t cell = film.cellOf(x, y);
        for (std::uint64_t b = film.counts.batchesOf(cell); b < plan[cell]; ++b) addBatch(draw, x, y);
      }
    film.counts.cellBatches = plan;
  }
};

}  // namespace quintet::render
#endif

// SPDX-License-Identifier: Apache-2.0
#include "render/film/film_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "render/film/fixed_sum.h"

namespace quintet::render {
namespace {

template <class Body>
void forPixels(const FilmState& film, const Body& body) {
  parallelFor(film.region.height, [&](std::size_t y) {
    for (std::uint32_t x = 0; x < film.region.width; ++x)
      body(y * film.region.width + x, film.cellOf(x, static_cast<std::uint32_t>(y)));
  });
}

io::Image emptyImage(const FilmState& film) {
  io::Image image =
      io::makeImage(film.region.width, film.region.height, 4, io::PixelType::f32, io::ColorEncoding::linear);
  image.premultiplied = true;
  return image;
}

// Adds everything but counts and values.
void addSums(FilmState& film, const FilmState& part) {
  const auto addFixedSums = [](std::vector<shared::FixedSum>& into, const std::vector<shared::FixedSum>& from) {
    parallelRanges(into.size(), [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) into[i] = addFixed(into[i], from[i]);
    });
  };
  for (std::size_t p = 0; p < film.planes.size(); ++p) {
    FilmPlane& into = film.planes[p];
    const FilmPlane& from = part.planes[p];
    addFixedSums(into.sums, from.sums);
    addFixedSums(into.squares, from.squares);
    parallelRanges(into.coverage.size() / shared::kCoverageSlots, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i)
        mergeCoverage(&into.coverage[i * shared::kCoverageSlots], &from.coverage[i * shared::kCoverageSlots]);
    });
  }
  for (std::size_t i = 0; i < film.statistics.size(); ++i) film.statistics[i] += part.statistics[i];
}

bool hasSampleZero(const SampleCounts& counts) { return !counts.ranges.empty() && counts.ranges.front().begin == 0; }

}  // namespace

void SampleCounts::add(SampleRange range) {
  if (range.begin >= range.end) return;
  const auto after = std::ranges::lower_bound(ranges, range.begin, {}, &SampleRange::begin);
  const bool overlapsBefore = after != ranges.begin() && std::prev(after)->end > range.begin;
  const bool overlapsAfter = after != ranges.end() && after->begin < range.end;
  if (overlapsBefore || overlapsAfter) {
    const SampleRange& other = overlapsBefore ? *std::prev(after) : *after;
    throw UsageError(fmt::format("samples {}–{} are present twice", std::max(range.begin, other.begin),
                                 std::min(range.end, other.end) - 1));
  }
  ranges.insert(after, range);
  for (std::size_t i = 1; i < ranges.size();) {
    if (ranges[i - 1].end != ranges[i].begin) {
      ++i;
      continue;
    }
    ranges[i - 1].end = ranges[i].end;
    ranges.erase(ranges.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

std::uint64_t SampleCounts::samples() const {
  std::uint64_t sum = 0;
  for (const SampleRange& range : ranges) sum += range.end - range.begin;
  return sum;
}

std::uint64_t SampleCounts::batches() const {
  std::uint64_t sum = 0;
  for (const SampleRange& range : ranges) sum += (range.end - range.begin + kBatchSamples - 1) / kBatchSamples;
  return sum;
}

std::uint32_t launchEnd(std::uint32_t row, std::uint32_t rows, std::uint32_t height) {
  if (rows >= height - row) return height;
  const std::uint32_t aligned = (row + rows) / kLaunchRows * kLaunchRows;
  return aligned > row ? aligned : row + rows;
}

std::uint32_t tileColumns(std::uint32_t width) { return (width + shared::kTileSize - 1) / shared::kTileSize; }
std::uint32_t tileCount(const Region& region) { return tileColumns(region.width) * tileColumns(region.height); }

std::uint32_t FilmState::cellOf(std::uint32_t x, std::uint32_t y) const {
  return 2 * (y / shared::kTileSize * tileColumns(region.width) + x / shared::kTileSize) + ((x + y) & 1u);
}

std::size_t endOfBatch(std::span<const shared::FilmTile> tiles, std::size_t first) {
  std::size_t end = first;
  while (end < tiles.size() && tiles[end].batch == tiles[first].batch) ++end;
  return end;
}

uvec2 pixelAt(const Region& region, std::uint64_t index) {
  return {region.x + static_cast<std::uint32_t>(index % region.width),
          region.y + static_cast<std::uint32_t>(index / region.width)};
}

RayCount countRays(std::span<const uvec2> statistics, const Region& region) {
  RayCount count;
  for (std::size_t i = 0; i < statistics.size(); ++i) {
    if (statistics[i].y > 0 && count.droppedSamples == 0) count.firstDropped = pixelAt(region, i);
    count.rays += statistics[i].x;
    count.droppedSamples += statistics[i].y;
  }
  return count;
}

std::vector<NotFinitePixels> findNotFinite(const FilmState& film) {
  std::vector<NotFinitePixels> found;
  for (const FilmPlane& plane : film.planes) {
    NotFinitePixels pixels{plane.name, 0, {0, 0}};
    for (std::size_t i = 0; i < std::max(plane.sums.size() / 4, plane.values.size()); ++i) {
      bool bad = false;
      for (int c = 0; c < 4; ++c)
        bad = bad || (plane.sums.empty() ? !std::isfinite(plane.values[i][c])
                                         : isNotFinite(plane.sums[4 * i + static_cast<std::size_t>(c)]));
      if (bad && pixels.count++ == 0) pixels.first = pixelAt(film.region, i);
    }
    if (pixels.count > 0) found.push_back(std::move(pixels));
  }
  return found;
}

bool areConsistent(const SampleCounts& counts, const std::vector<std::uint32_t>& plan) {
  if (counts.cellBatches.empty() && plan.empty()) return true;
  const std::vector<SampleRange>& ranges = counts.ranges;
  if (ranges.size() != 1 || ranges[0].begin != 0 || ranges[0].end % kBatchSamples != 0) return false;
  // Sample indices have 32 bits.
  constexpr std::uint32_t kMostBatches = std::numeric_limits<std::uint32_t>::max() / kBatchSamples;
  const auto atLeast = [&](std::uint64_t least) {
    return [=](std::uint32_t batches) { return batches >= least && batches <= kMostBatches; };
  };
  return std::ranges::all_of(counts.cellBatches, atLeast(counts.batches())) && std::ranges::all_of(plan, atLeast(0));
}

std::vector<std::uint32_t> cellPixels(const Region& region) {
  std::vector<std::uint32_t> pixels;
  for (std::uint32_t y = 0; y < region.height; y += shared::kTileSize)
    for (std::uint32_t x = 0; x < region.width; x += shared::kTileSize) {
      const std::uint32_t all =
          std::min(shared::kTileSize, region.width - x) * std::min(shared::kTileSize, region.height - y);
      pixels.push_back((all + 1) / 2);
      pixels.push_back(all / 2);
    }
  return pixels;
}

double averageSamples(const Region& region, const SampleCounts& counts) {
  if (counts.cellBatches.empty()) return static_cast<double>(counts.samples());
  double sum = 0, all = 0;
  const std::vector<std::uint32_t> pixels = cellPixels(region);
  for (std::uint32_t c = 0; c < pixels.size(); ++c) {
    all += pixels[c];
    sum += static_cast<double>(pixels[c]) * static_cast<double>(counts.samplesOf(c));
  }
  return sum / all;
}

SampleCounts countsOfRows(const SampleCounts& counts, std::uint32_t width, std::uint32_t first, std::uint32_t rows) {
  assert(first % shared::kTileSize == 0);
  SampleCounts part = counts;
  if (counts.cellBatches.empty()) return part;
  const std::size_t cells = 2 * std::size_t{tileColumns(width)};
  const std::size_t begin = first / shared::kTileSize * cells;
  const auto from = counts.cellBatches.begin() + static_cast<std::ptrdiff_t>(begin);
  part.cellBatches.assign(from, from + static_cast<std::ptrdiff_t>(cells * tileColumns(rows)));
  return part;
}

io::Image planeImage(const FilmState& film, std::size_t output) {
  const FilmPlane& plane = film.planes.at(output);
  if (!plane.stored() || plane.pixel == program::OutputPixel::coverage)
    throw UsageError(
        fmt::format("output '{}' {}", plane.name, plane.stored() ? "holds ids, not an image" : "was not requested"));
  io::Image image = emptyImage(film);
  const std::span<float> values = image.samples<float>();
  forPixels(film, [&](std::size_t pixel, std::uint32_t cell) {
    const auto samples = static_cast<double>(std::max<std::uint64_t>(1, film.counts.samplesOf(cell)));
    for (int c = 0; c < 4; ++c) {
      const std::size_t i = 4 * pixel + static_cast<std::size_t>(c);
      values[i] =
          plane.sums.empty() ? plane.values[pixel][c] : static_cast<float>(fixedToDouble(plane.sums[i]) / samples);
    }
  });
  return image;
}

double varianceOfMean(const FilmPlane& plane, std::size_t i, double samples, double batches) {
  const double sum = fixedToDouble(plane.sums[i]);
  const double spread = fixedToDouble(plane.squares[i]) - sum * sum / samples;
  return std::isnan(spread) ? spread : std::max(0.0, spread) / ((batches - 1) * samples);
}

io::Image varianceImage(const FilmState& film, std::size_t output) {
  const FilmPlane& plane = film.planes.at(output);
  if (plane.squares.empty())
    throw UsageError(fmt::format("output '{}': the film stores no squares for its variance", plane.name));
  io::Image image = emptyImage(film);
  const std::span<float> values = image.samples<float>();
  forPixels(film, [&](std::size_t pixel, std::uint32_t cell) {
    const auto samples = static_cast<double>(film.counts.samplesOf(cell));
    const auto batches = static_cast<double>(film.counts.batchesOf(cell));
    for (std::size_t i = 4 * pixel; i < 4 * pixel + 4; ++i)
      values[i] = batches < 2 ? std::numeric_limits<float>::infinity()
                              : static_cast<float>(varianceOfMean(plane, i, samples, batches));
  });
  return image;
}

void mergeCoverage(shared::CoverageSlot* into, const shared::CoverageSlot* from) {
  std::array<shared::CoverageSlot, 2 * shared::kCoverageSlots> merged{};
  std::size_t count = 0;
  for (std::size_t a = 0, b = 0; a < shared::kCoverageSlots || b < shared::kCoverageSlots;) {
    const bool hasA = a < shared::kCoverageSlots && into[a].samples > 0;
    const bool hasB = b < shared::kCoverageSlots && from[b].samples > 0;
    if (!hasA && !hasB) break;
    if (hasA && hasB && into[a].id == from[b].id)
      merged[count++] = {into[a].id, into[a++].samples + from[b++].samples};
    else if (hasA && (!hasB || into[a].id < from[b].id))
      merged[count++] = into[a++];
    else
      merged[count++] = from[b++];
  }
  std::copy_n(merged.begin(), shared::kCoverageSlots, into);
}

bool sameArrays(const FilmState& a, const FilmState& b) {
  const auto same = [](const FilmPlane& p, const FilmPlane& q) {
    return p.name == q.name && p.pixel == q.pixel && p.sums.size() == q.sums.size() &&
           p.squares.size() == q.squares.size() && p.values.size() == q.values.size() &&
           p.coverage.size() == q.coverage.size();
  };
  return a.region == b.region && a.statistics.size() == b.statistics.size() &&
         std::ranges::equal(a.planes, b.planes, same);
}

void mergeFilm(FilmState& film, const FilmState& part) {
  assert(sameArrays(film, part));
  if (!film.counts.cellBatches.empty() || !part.counts.cellBatches.empty())
    throw UsageError("films of adaptive sampling, whose pixels have different numbers of samples, cannot be merged");
  SampleCounts counts = film.counts;
  for (const SampleRange& range : part.counts.ranges) counts.add(range);
  const bool takesCenters = hasSampleZero(part.counts);
  film.counts = counts;
  addSums(film, part);
  if (takesCenters)
    for (std::size_t p = 0; p < film.planes.size(); ++p) film.planes[p].values = part.planes[p].values;
}

void addFilm(FilmState& film, const FilmState& part) {
  assert(sameArrays(film, part));
  addSums(film, part);
  constexpr std::array<std::byte, sizeof(vec4)> kUnset{};
  for (std::size_t p = 0; p < film.planes.size(); ++p) {
    std::vector<vec4>& values = film.planes[p].values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const vec4& value = part.planes[p].values[i];
      if (std::memcmp(&value, kUnset.data(), sizeof value) != 0) values[i] = value;
    }
  }
}

}  // namespace quintet::render

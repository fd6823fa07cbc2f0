// SPDX-License-Identifier: Apache-2.0
#include "render/film/film.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>

#include "base/error.h"
#include "program/description/limits.h"
#include "render/compute_pass.h"

namespace quintet::render {
namespace {

static_assert(shared::kMaxOutputs == program::kMaxOutputs);
constexpr std::uint64_t kTilePixels = std::uint64_t{shared::kTileSize} * shared::kTileSize;

using program::Accumulation;
using program::OutputPixel;

bool isStored(const program::Output& output, const std::vector<std::string>& wanted) {
  return !output.optional || std::ranges::find(wanted, output.name) != wanted.end();
}

std::uint64_t totalBytes(OutputPixel pixel, Accumulation accumulation) {
  if (accumulation == Accumulation::program || pixel == OutputPixel::center) return sizeof(vec4);
  return pixel == OutputPixel::mean ? 4 * sizeof(shared::FixedSum)
                                    : shared::kCoverageSlots * sizeof(shared::CoverageSlot);
}

// The values of a batch: one per pixel, and enough for all tiles, which can extend beyond the film.
std::uint64_t batchValues(const Region& region, bool adaptive) {
  const std::uint64_t pixels = std::uint64_t{region.width} * region.height;
  return adaptive ? std::max(pixels, tileCount(region) * kTilePixels) : pixels;
}

bool storesSquares(std::size_t output, Accumulation accumulation) {
  return output == 0 && accumulation == Accumulation::film;
}

}  // namespace

Film::Film(gpu::Context& context, const gpu::BindlessSet& set, const shader::Compiler& compiler, Region region,
           const program::Program& program, const std::vector<std::string>& wanted)
    : context_(context),
      region_(region),
      accumulation_(program.accumulation),
      adaptive_(program.adaptive),
      check_(makePass(context, set, compiler, "film_check")) {
  const std::vector<std::string> names = program::outputNames(program);
  for (const std::string& name : wanted)
    if (std::ranges::find(names, name) == names.end())
      throw UsageError(fmt::format("the program '{}' has no output '{}'; available: {}", program.name, name,
                                   fmt::join(names, ", ")));
  for (const program::Output& output : program.outputs) {
    Output& entry = outputs_.emplace_back();
    entry.facts.name = output.name;
    entry.facts.pixel = output.pixel;
    entry.facts.kind = output.kind;
    entry.facts.color = program::holdsColor(output);
    entry.stored = isStored(output, wanted);
    if (entry.stored && output.pixel == OutputPixel::coverage && !coverage_)
      coverage_ = makePass(context, set, compiler, "film_coverage");
  }
  if (accumulation_ == Accumulation::program) {
    frame_ = makePass(context, set, compiler, "film_frame");
  } else {
    add_ = makePass(context, set, compiler, "film_add");
    mean_ = makePass(context, set, compiler, "film_mean");
  }
  resize(region);
}

void Film::resize(Region region) {
  const std::uint64_t pixels = std::uint64_t{region.width} * region.height;
  const std::uint64_t values = batchValues(region, adaptive_);
  const auto makeBuffer = [&](std::uint64_t size, const std::string& name) {
    return gpu::Buffer(context_, {.size = size, .name = name, .purpose = gpu::Purpose::film});
  };
  const auto buffer = [&](std::uint64_t bytesPerPixel, const std::string& name) {
    return makeBuffer(pixels * bytesPerPixel, name);
  };
  std::vector<Output> outputs;
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    Output& entry = outputs.emplace_back();
    entry.facts = outputs_[i].facts;
    entry.stored = outputs_[i].stored;
    if (!entry.stored) continue;
    entry.batch = makeBuffer(values * sizeof(vec4), "film batch " + entry.facts.name);
    entry.total = buffer(totalBytes(entry.facts.pixel, accumulation_), "film total " + entry.facts.name);
    if (storesSquares(i, accumulation_))
      entry.squares = buffer(4 * sizeof(shared::FixedSum), "film squares " + entry.facts.name);
  }
  gpu::Buffer statistics = buffer(sizeof(uvec2), "film statistics"), marks;
  if (accumulation_ == Accumulation::program) marks = buffer(sizeof(std::uint32_t), "film marks");
  outputs_ = std::move(outputs);
  statistics_ = std::move(statistics);
  marks_ = std::move(marks);
  means_ = {};
  staging_ = {};
  region_ = region;
  clear();
}

void Film::clear() {
  counts_ = {};
  context_.submit([&](gpu::Commands& commands) {
    for (const Output& output : outputs_) {
      if (output.total) commands.fill(output.total, 0);
      if (output.squares) commands.fill(output.squares, 0);
    }
    commands.fill(statistics_, 0);
    if (marks_) commands.fill(marks_, 0);
  });
}

std::uint64_t Film::bytes() const {
  std::uint64_t sum = statistics_.size() + (marks_ ? marks_.size() : 0);
  for (const Output& output : outputs_)
    if (output.total) sum += output.batch.size() + output.total.size() + (output.squares ? output.squares.size() : 0);
  return sum;
}

std::uint64_t Film::bytesFor(const Region& region, const program::Program& program,
                             const std::vector<std::string>& wanted) {
  const std::uint64_t values = batchValues(region, program.adaptive);
  std::uint64_t perPixel = sizeof(uvec2) + (program.accumulation == Accumulation::program ? sizeof(std::uint32_t) : 0);
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < program.outputs.size(); ++i) {
    if (!isStored(program.outputs[i], wanted)) continue;
    sum += values * sizeof(vec4);
    perPixel += totalBytes(program.outputs[i].pixel, program.accumulation);
    if (storesSquares(i, program.accumulation)) perPixel += 4 * sizeof(shared::FixedSum);
  }
  return sum + perPixel * region.width * region.height;
}

void Film::describe(shared::Frame& frame) const {
  frame.filmOffset = {region_.x, region_.y};
  frame.filmWidth = region_.width;
  frame.filmHeight = region_.height;
  frame.statistics = statistics_.address();
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    if (!outputs_[i].total) continue;
    frame.outputs[i] = outputs_[i].batch.address();
    if (accumulation_ == Accumulation::program) frame.previousOutputs[i] = outputs_[i].total.address();
  }
}

void Film::beginBatch(gpu::Commands& commands) { beginRows(commands, 0, region_.height); }

void Film::endBatch(gpu::Commands& commands, SampleRange samples) {
  endRows(commands, samples, 0, region_.height);
  if (accumulation_ == Accumulation::film) counts_.add(samples);
}

void Film::beginRows(gpu::Commands& commands, std::uint32_t first, std::uint32_t count) {
  clearValues(commands, std::uint64_t{first} * region_.width, std::uint64_t{count} * region_.width);
}

void Film::endRows(gpu::Commands& commands, SampleRange samples, std::uint32_t first, std::uint32_t count) {
  assert(first + count <= region_.height && (accumulation_ == Accumulation::film || count == region_.height));
  commands.barrier(gpu::Stage::rayTracing, gpu::Stage::all);
  const std::uint64_t pixel = std::uint64_t{first} * region_.width;
  addPart(commands, samples, {pixel, pixel, count * region_.width, 0});
}

void Film::beginTiles(gpu::Commands& commands, std::size_t count) {
  assert(adaptive_ && count <= tileCount(region_));
  clearValues(commands, 0, count * kTilePixels);
}

void Film::endTiles(gpu::Commands& commands, shared::Address address, std::span<const shared::FilmTile> tiles) {
  assert(accumulation_ == Accumulation::film);
  commands.barrier(gpu::Stage::rayTracing, gpu::Stage::all);
  // A tile can have several batches, which are added one after another.
  for (std::size_t first = 0; first < tiles.size();) {
    const std::size_t end = endOfBatch(tiles, first);
    const std::uint32_t sample = tiles[first].batch * kBatchSamples;
    assert(sample > 0);
    const auto count = static_cast<std::uint32_t>((end - first) * kTilePixels);
    addPart(commands, {sample, sample + kBatchSamples},
            {first * kTilePixels, 0, count, address + first * sizeof(shared::FilmTile)});
    first = end;
  }
}

void Film::setCellBatches(std::vector<std::uint32_t> batches) {
  assert(batches.size() == 2 * std::size_t{tileCount(region_)});
  counts_.cellBatches = std::move(batches);
}

void Film::clearValues(gpu::Commands& commands, std::uint64_t first, std::uint64_t count) {
  commands.barrier(gpu::Stage::all, gpu::Stage::transfer);
  for (const Output& output : outputs_)
    if (output.total) commands.fill(output.batch, 0, first * sizeof(vec4), count * sizeof(vec4));
  commands.barrier(gpu::Stage::transfer, gpu::Stage::rayTracing);
}

void Film::addPart(gpu::Commands& commands, SampleRange samples, const Part& part) {
  const shared::FilmBatch batch{part.tiles, part.count, region_.width, region_.height,
                                1.0f / static_cast<float>(samples.end - samples.begin)};
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    const Output& output = outputs_[i];
    if (!output.total) continue;
    const shared::Address values = output.batch.address() + part.value * sizeof(vec4);
    const shared::Address total = output.total.address() + part.pixel * totalBytes(output.facts.pixel, accumulation_);
    if (accumulation_ == Accumulation::program) {
      const shared::FilmFrame pass{total, values, marks_.address(), part.count, 1u << i};
      dispatchPass(*frame_, commands, std::as_bytes(std::span(&pass, 1)), part.count);
    } else if (output.facts.pixel == OutputPixel::center) {
      const VkDeviceSize offset = part.pixel * sizeof(vec4);
      if (samples.begin == 0) commands.copy(output.batch, output.total, part.count * sizeof(vec4), offset, offset);
    } else if (output.facts.pixel == OutputPixel::coverage) {
      const shared::FilmCoverage pass{total, values, batch};
      dispatchPass(*coverage_, commands, std::as_bytes(std::span(&pass, 1)), part.count);
    } else {
      const shared::Address squares =
          output.squares ? output.squares.address() + part.pixel * 4 * sizeof(shared::FixedSum) : 0;
      const shared::FilmAdd pass{total, squares, values, batch};
      dispatchPass(*add_, commands, std::as_bytes(std::span(&pass, 1)), part.count);
    }
  }
  commands.barrier(gpu::Stage::all, gpu::Stage::all);
}

FilmPlane Film::plane(const Output& output) const {
  FilmPlane plane = output.facts;
  readRows(output, {0, region_.height, true}, nullptr, plane);
  return plane;
}

void Film::readRows(const Output& output, const Rows& rows, const gpu::Buffer* staging, FilmPlane& plane) const {
  if (!output.total) return;
  const auto read = [&](const gpu::Buffer& buffer, auto& values, std::size_t perPixel) {
    const std::size_t row = perPixel * region_.width;
    values.resize(row * rows.count);
    const std::span<std::byte> bytes = std::as_writable_bytes(std::span(values));
    const VkDeviceSize offset = rows.first * row * sizeof(values[0]);
    if (staging)
      buffer.download(bytes, offset, *staging);
    else
      buffer.download(bytes, offset);
  };
  if (accumulation_ == Accumulation::program || output.facts.pixel == OutputPixel::center)
    read(output.total, plane.values, 1);
  else if (output.facts.pixel == OutputPixel::mean)
    read(output.total, plane.sums, 4);
  else
    read(output.total, plane.coverage, shared::kCoverageSlots);
  if (output.squares && rows.squares) read(output.squares, plane.squares, 4);
}

template <class Use>
void Film::forStrips(const Output& output, bool squares, const Use& use) const {
  // All strips share one staging buffer and one state: allocation and the first access to new pages dominate the cost.
  const std::uint64_t bytes = output.total ? output.total.size() / region_.height * shared::kTileSize : 1;
  const gpu::Buffer staging = gpu::Buffer::makeReadback(context_, bytes);
  FilmState strip;
  strip.planes = {output.facts};
  for (std::uint32_t first = 0; first < region_.height; first += shared::kTileSize) {
    const std::uint32_t rows = std::min(shared::kTileSize, region_.height - first);
    strip.region = {region_.x, region_.y + first, region_.width, rows};
    strip.counts = countsOfRows(counts_, region_.width, first, rows);
    readRows(output, {first, rows, squares}, &staging, strip.planes[0]);
    use(strip, first);
  }
}

FilmState Film::save() const {
  FilmState state{region_, counts_, {}, downloadStatistics()};
  for (const Output& output : outputs_) state.planes.push_back(plane(output));
  return state;
}

ErrorEstimate Film::estimateError() const {
  ErrorEstimator estimator(region_, counts_);
  forStrips(outputs_[0], true, [&](const FilmState& strip, std::uint32_t first) { estimator.add(strip, first); });
  return estimator.estimate();
}

FilmState Film::saveFirst() const {
  FilmState state{region_, counts_, {}, {}};
  state.planes.push_back(plane(outputs_[0]));
  return state;
}

void Film::restore(const FilmState& state) {
  assert(state.region == region_ && state.planes.size() == outputs_.size());
  counts_ = state.counts;
  statistics_.uploadAs(std::span<const uvec2>(state.statistics));
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    Output& output = outputs_[i];
    const FilmPlane& plane = state.planes[i];
    if (!plane.sums.empty()) output.total.uploadAs(std::span<const shared::FixedSum>(plane.sums));
    if (!plane.values.empty()) output.total.uploadAs(std::span<const vec4>(plane.values));
    if (!plane.coverage.empty()) output.total.uploadAs(std::span<const shared::CoverageSlot>(plane.coverage));
    if (!plane.squares.empty()) output.squares.uploadAs(std::span<const shared::FixedSum>(plane.squares));
  }
}

io::Image Film::download(std::size_t output) const {
  io::Image image;
  forStrips(outputs_.at(output), false, [&](const FilmState& strip, std::uint32_t first) {
    const io::Image part = planeImage(strip, 0);
    if (first == 0) {
      image = io::makeImage(region_.width, region_.height, 4, io::PixelType::f32, io::ColorEncoding::linear);
      image.premultiplied = part.premultiplied;
    }
    std::ranges::copy(part.samples<float>(),
                      image.samples<float>().begin() + std::ptrdiff_t{4} * first * region_.width);
  });
  return image;
}

io::Image Film::downloadMean(std::size_t output) const {
  const Output& source = outputs_.at(output);
  assert(source.total && source.facts.pixel != OutputPixel::coverage && counts_.cellBatches.empty());
  const std::uint32_t pixels = region_.width * region_.height;
  const VkDeviceSize bytes = VkDeviceSize{pixels} * sizeof(vec4);
  const gpu::Buffer* values = &source.total;
  if (!staging_) staging_ = gpu::Buffer::makeReadback(context_, bytes);
  if (mean_ && source.facts.pixel == OutputPixel::mean) {
    if (!means_) means_ = gpu::Buffer(context_, {.size = bytes, .name = "film means", .purpose = gpu::Purpose::film});
    const auto samples = static_cast<float>(std::max<std::uint64_t>(1, counts_.samples()));
    const shared::FilmMean pass{source.total.address(), means_.address(), pixels, 1.0f / samples};
    context_.submitAndWait([&](gpu::Commands& commands) {
      commands.barrier(gpu::Stage::all, gpu::Stage::all);
      dispatchPass(*mean_, commands, std::as_bytes(std::span(&pass, 1)), pixels);
      commands.barrier(gpu::Stage::all, gpu::Stage::all);
    });
    values = &means_;
  }
  io::Image image = io::makeImage(region_.width, region_.height, 4, io::PixelType::f32, io::ColorEncoding::linear);
  image.premultiplied = true;
  values->download(std::as_writable_bytes(image.samples<float>()), 0, staging_);
  return image;
}

std::vector<vec4> Film::downloadBatch(std::size_t output) const {
  return outputs_.at(output).batch.downloadAs<vec4>(std::size_t{region_.width} * region_.height);
}

RayCount Film::countRays() const { return render::countRays(downloadStatistics(), region_); }

std::vector<uvec2> Film::downloadStatistics() const {
  return statistics_.downloadAs<uvec2>(std::size_t{region_.width} * region_.height);
}

std::vector<NotFinitePixels> Film::notFinitePixels() const {
  std::vector<shared::NotFinite> results(outputs_.size(), {0, ~0u});
  gpu::Buffer buffer = gpu::makeBuffer(context_, std::as_bytes(std::span(results)), 0, "not finite");
  const std::uint32_t pixels = region_.width * region_.height;
  context_.submitAndWait([&](gpu::Commands& commands) {
    commands.barrier(gpu::Stage::all, gpu::Stage::all);
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
      const OutputPixel pixel = outputs_[i].facts.pixel;
      if (!outputs_[i].total || pixel == OutputPixel::coverage) continue;
      const bool marks = accumulation_ == Accumulation::program;
      const shared::FilmCheck pass{marks ? marks_.address() : outputs_[i].total.address(),
                                   buffer.address() + i * sizeof(shared::NotFinite),
                                   pixels,
                                   !marks && pixel == OutputPixel::mean ? 1u : 0u,
                                   marks ? 1u << i : 0u,
                                   0};
      dispatchPass(*check_, commands, std::as_bytes(std::span(&pass, 1)), pixels);
    }
  });
  results = buffer.downloadAs<shared::NotFinite>(results.size());
  std::vector<NotFinitePixels> found;
  for (std::size_t i = 0; i < outputs_.size(); ++i)
    if (results[i].count > 0)
      found.push_back({outputs_[i].facts.name, results[i].count, pixelAt(region_, results[i].first)});
  return found;
}

}  // namespace quintet::render

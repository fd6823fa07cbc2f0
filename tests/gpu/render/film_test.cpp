// SPDX-License-Identifier: Apache-2.0
// The film on the device: sums, optional outputs, center values, coverage ids, adaptive cells, and merged parts.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <span>

#include "../program/run_program.h"
#include "harness.h"
#include "program/description/parser.h"
#include "quintet/shared/pass.h"
#include "render/compute_pass.h"
#include "render/film/adaptive_plan.h"
#include "render/film/film_error.h"
#include "render/film/film_file.h"
#include "render/film/fixed_sum.h"

namespace quintet::test {
namespace {

TEST(FilmPasses, MatchesHostFixedPointSums) {
  struct In {
    float a, b;
  };
  std::mt19937 random(5);
  std::vector<In> inputs;
  for (int i = 0; i < 4000; ++i) {
    const auto draw = [&]() -> float {
      const auto word = static_cast<std::uint32_t>(random());
      const auto exponent = static_cast<std::uint32_t>(60 + random() % 70);
      return std::bit_cast<float>(i % 4 ? (word & 0x807FFFFFu) | exponent << 23 : word);
    };
    inputs.push_back({draw(), i % 5 ? draw() : 0.0f});
    if (i % 7 == 0) inputs.back().b = -inputs.back().a;
  }
  for (const float a : {3e38f, -3e38f, 4.5e18f, -4.5e18f})
    for (const float b : {3e38f, -3e38f, 1e18f, -1e18f}) inputs.push_back({a, b});
  const auto seen = runCompute<std::array<std::uint32_t, 4>>(R"(
    #include <quintet/passes/fixed_sum.glsl>
    struct In { float a; float b; };
    struct Out { FixedSum sum; };
    Out run(uint index, In value) { return Out(addFixed(fixedFromFloat(value.a), fixedFromFloat(value.b))); }
  )",
                                                             inputs, inputs.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const shared::FixedSum expected =
        render::addFixed(render::fixedFromFloat(inputs[i].a), render::fixedFromFloat(inputs[i].b));
    ASSERT_EQ(std::memcmp(&expected, seen[i].data(), 16), 0) << inputs[i].a << " + " << inputs[i].b;
  }
}

TEST(FilmPasses, ConvertsFixedPointSumsToFloats) {
  std::vector<shared::FixedSum> inputs;
  std::mt19937 random(7);
  for (int i = 0; i < 4000; ++i) {  // the highest words are small, so that all magnitudes occur
    shared::FixedSum sum{};
    const auto words = static_cast<std::size_t>(i % 4 + 1);
    for (std::size_t w = 0; w < words; ++w) sum.word[w] = static_cast<std::uint32_t>(random());
    sum.word[words - 1] >>= random() % 32;
    inputs.push_back(sum);
    shared::FixedSum negative = sum;
    std::uint64_t carry = 1;
    for (std::uint32_t& word : negative.word) {
      carry += static_cast<std::uint32_t>(~word);
      word = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
    inputs.push_back(negative);
  }
  inputs.push_back(render::fixedFromFloat(std::numeric_limits<float>::infinity()));
  const auto seen = runCompute<float>(R"(
    #include <quintet/passes/fixed_sum.glsl>
    struct In { FixedSum sum; };
    struct Out { float value; };
    Out run(uint index, In value) { return Out(floatFromFixed(value.sum)); }
  )",
                                      inputs, inputs.size());
  for (std::size_t i = 0; i + 1 < inputs.size(); ++i) {
    const double expected = render::fixedToDouble(inputs[i]);
    ASSERT_LE(std::abs(seen[i] - expected), 5e-7 * std::abs(expected)) << i;
  }
  EXPECT_TRUE(std::isnan(seen.back()));
}

// More elements than a row of workgroups has: the rows of the dispatch and the index in the shader agree.
TEST(FilmPasses, IndexEachElementOfLargeArrays) {
  const std::string glsl = R"(#version 460
    #extension GL_EXT_scalar_block_layout : require
    #extension GL_EXT_buffer_reference : require
    #extension GL_EXT_buffer_reference2 : require
    #extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
    #extension GL_GOOGLE_include_directive : require
    #include <quintet/passes/pass_index.glsl>
    layout(local_size_x = kPassGroupSize) in;
    layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Marks { uint at[]; };
    layout(push_constant, scalar) uniform Block { uint64_t marks; uint count; };
    void main() {
      const uint i = passIndex();
      if (i < count) Marks(marks).at[i] = i + 1u;
    }
  )";
  struct Constants {
    VkDeviceAddress marks;
    std::uint32_t count;
    std::uint32_t unused = 0;
  };
  const std::uint32_t count = shared::kPassColumns * shared::kPassGroupSize + 5000;
  gpu::Context& context = testContext();
  const gpu::Buffer marks(context, {.size = std::uint64_t{count} * 4, .name = "marks"});
  const gpu::ComputePipeline pass(context, testSet(), compileCompute(glsl), VK_NULL_HANDLE, "index");
  const Constants constants{marks.address(), count};
  context.submitAndWait([&](gpu::Commands& commands) {
    commands.fill(marks, 0);
    commands.barrier(gpu::Stage::transfer, gpu::Stage::compute);
    render::dispatchPass(pass, commands, std::as_bytes(std::span(&constants, 1)), count);
    commands.toHost(gpu::Stage::compute);
  });
  const std::vector<std::uint32_t> seen = marks.downloadAs<std::uint32_t>(count);
  for (std::uint32_t i = 0; i < count; ++i) ASSERT_EQ(seen[i], i + 1);
}

// A program whose samples store known values: a term of the mean, the center value, and an id.
const Files kFilmFiles = {{"m.rmiss", "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() {}\n"},
                          {"main.rgen", R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
#ifndef SCALE
#define SCALE 1.0
#endif
void main() {
  const uvec2 pixel = launchPixel();
  if (!launchActive(pixel)) return;
  vec4 sum = loadOutput(kOutput_color, pixel);
#ifdef QUINTET_OUTPUT_ids
  vec4 ids = loadOutput(kOutput_ids, pixel);
#endif
  for (uint i = 0u; i < launch.sampleCount; ++i) {
    const uint s = launch.firstSample + i;
    sum += vec4(0.1 * float(s) + float(pixel.x), SCALE * float(s * s), -1.0, 1.0);
#ifdef QUINTET_OUTPUT_depth
    if (s == 0u) storeOutput(kOutput_depth, pixel, vec4(7.0 + float(pixel.y)));
#endif
#ifdef QUINTET_OUTPUT_ids
    ids[s % kBatchSamples] = uintBitsToFloat(s < 2u ? 0u : 0x3F800000u + s % 3u);
#endif
  }
  storeOutput(kOutput_color, pixel, sum);
#ifdef QUINTET_OUTPUT_ids
  storeOutput(kOutput_ids, pixel, ids);
#endif
  countRays(pixel, launch.sampleCount, 0u);
}
)"}};

constexpr const char* kFilmToml = R"([program]
ray_generation = "main.rgen"
samples_per_launch = 4
adaptive = true
[[ray]]
name = "r"
miss = "m.rmiss"
[[output]]
name = "color"
[[output]]
name = "depth"
pixel = "center"
optional = true
[[output]]
name = "ids"
kind = "id"
pixel = "coverage"
optional = true
)";

struct FilmTest : testing::Test {
  ImageOptions options;
  SceneBuilder scene = namedSquares({"a"});
  render::DeviceScene device{testContext(), scene::Scene(scene.scene), scene.environment};

  FilmTest() {
    options.program = program::parseProgram(kFilmToml, "test", "<test>", kFilmFiles);
    options.width = 37;
    options.height = 5;
  }
  render::Renderer renderer(const std::vector<std::string>& outputs, const char* scale = "1.0") {
    render::RenderSettings settings = settingsFor(scene.scene.cameras[0], options);
    settings.outputs = outputs;
    return makeRenderer(device, options.program, settings, {{"SCALE", scale}});
  }
};

double meanOf(std::uint32_t samples, const auto& value) {
  double sum = 0;
  for (std::uint32_t s = 0; s < samples; ++s) sum += value(s);
  return sum / samples;
}

TEST_F(FilmTest, StoresRequestedOutputsOnly) {
  render::Renderer plain = renderer({});
  EXPECT_TRUE(plain.film().stores(0));
  EXPECT_FALSE(plain.film().stores(1));
  plain.renderBatch();
  EXPECT_THROW(plain.image(1), UsageError);
  EXPECT_THROW(renderer({"colr"}), UsageError);
  EXPECT_GT(renderer({"depth"}).film().bytes(), plain.film().bytes());
  EXPECT_EQ(plain.film().bytes(), render::Film::bytesFor(plain.film().region(), options.program, {}));
}

TEST_F(FilmTest, DescribesItsPlanes) {
  const render::FilmState film = renderer({"ids"}).saveFilm();
  ASSERT_EQ(film.planes.size(), 3u);
  EXPECT_EQ(film.planes[0].name, "color");
  EXPECT_EQ(film.planes[0].kind, program::OutputKind::color);
  EXPECT_TRUE(film.planes[0].color);
  EXPECT_FALSE(film.planes[1].stored());
  EXPECT_EQ(film.planes[1].pixel, program::OutputPixel::center);
  EXPECT_EQ(film.planes[2].kind, program::OutputKind::id);
  EXPECT_EQ(film.planes[2].pixel, program::OutputPixel::coverage);
  EXPECT_FALSE(film.planes[2].color);
}

TEST_F(FilmTest, StoresMeansCentersAndIds) {
  render::Renderer r = renderer({"depth", "ids"});
  for (const std::uint32_t count : {4u, 4u, 3u}) r.renderBatch(count);
  const io::Image color = r.image(0), depth = r.image(1);
  EXPECT_NEAR(color.pixel<float>(36, 4)[0], meanOf(11, [](double s) { return 0.1 * s + 36; }), 1e-5);
  EXPECT_NEAR(color.pixel<float>(0, 0)[1], meanOf(11, [](double s) { return s * s; }), 1e-4);
  EXPECT_EQ(color.pixel<float>(3, 3)[2], -1.0f);
  EXPECT_EQ(color.pixel<float>(3, 3)[3], 1.0f);
  EXPECT_EQ(depth.pixel<float>(3, 2)[0], 9.0f) << "the value of sample 0, not a mean";
  const std::vector<shared::CoverageSlot> slots = r.saveFilm().planes[2].coverage;
  std::vector<std::uint32_t> counts(3);
  for (std::uint32_t s = 2; s < 11; ++s) ++counts[s % 3];
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(slots[i].id, 0x3F800000u + i);
    EXPECT_EQ(slots[i].samples, counts[i]);
  }
  EXPECT_EQ(slots[3].samples, 0u);
}

TEST_F(FilmTest, ReadsImagesForDisplay) {
  render::Renderer r = renderer({"depth"});
  for (const std::uint32_t count : {4u, 3u}) r.renderBatch(count);
  for (const std::size_t output : {0u, 1u}) {
    const io::Image exact = r.image(output), fast = r.displayImage(output);
    ASSERT_EQ(fast.data.size(), exact.data.size());
    EXPECT_EQ(fast.premultiplied, exact.premultiplied);
    const std::span<const float> a = exact.samples<float>(), b = fast.samples<float>();
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(b[i], a[i], 1e-6f * std::abs(a[i])) << output << " " << i;
  }
}

TEST_F(FilmTest, ChangesItsSize) {
  render::Renderer r = renderer({"depth", "ids"});
  r.renderBatch();
  r.displayImage(0);
  for (const uvec2 size : {uvec2(64, 31), uvec2(3, 2)}) {
    r.setSize(size);
    EXPECT_EQ(r.film().counts().samples(), 0u);
    r.renderBatch(3);
    options.width = size.x;
    options.height = size.y;
    render::Renderer fresh = renderer({"depth", "ids"});
    fresh.renderBatch(3);
    EXPECT_EQ(r.film().bytes(), fresh.film().bytes());
    EXPECT_EQ(r.displayImage(0).data, fresh.displayImage(0).data);
    for (const std::size_t output : {0u, 1u}) EXPECT_EQ(r.image(output).data, fresh.image(output).data);
    EXPECT_EQ(r.rays().rays, std::uint64_t{3} * size.x * size.y);
  }
  EXPECT_THROW(r.setSize({0, 4}), UsageError);
  EXPECT_EQ(r.film().counts().samples(), 3u);
}

TEST_F(FilmTest, ComputesVarianceFromBatches) {
  render::Renderer r = renderer({});
  for (int b = 0; b < 6; ++b) r.renderBatch();
  const io::Image variance = render::varianceImage(r.saveFilm());
  double mean = 0, spread = 0;
  const auto batchMean = [](int b) { return meanOf(4, [&](double s) { return (4 * b + s) * (4 * b + s); }); };
  for (int b = 0; b < 6; ++b) mean += batchMean(b) / 6;
  for (int b = 0; b < 6; ++b) spread += (batchMean(b) - mean) * (batchMean(b) - mean);
  EXPECT_NEAR(variance.pixel<float>(5, 1)[1] / (spread / 5 / 6), 1.0, 1e-5);
  EXPECT_EQ(variance.pixel<float>(5, 1)[2], 0.0f);
}

// If the squares of batches exceed the film's range, the variance is unknown, not 0. The mean is unaffected.
TEST_F(FilmTest, ReportsUnknownVarianceBeyondItsRange) {
  // The largest square is 33,489 scale²: just below 2^62, just above it, and far above it.
  for (const char* scale : {"1e7", "1.2e7", "1e9"}) {
    const double value = std::stod(scale);
    const bool beyond = value > 1e7;
    render::Renderer r = renderer({}, scale);
    for (int b = 0; b < 3; ++b) r.renderBatch();
    const render::FilmState film = r.saveFilm();
    EXPECT_EQ(render::estimateError(film).known(), !beyond);
    EXPECT_EQ(std::isnan(render::varianceImage(film).pixel<float>(5, 1)[1]), beyond);
    EXPECT_NEAR(r.image().pixel<float>(5, 1)[1] / (value * meanOf(12, [](double s) { return s * s; })), 1.0, 1e-6);
  }
}

// Compares all contents, which a film file stores without loss.
bool sameBytes(const render::FilmState& a, const render::FilmState& b) {
  return render::encodeFilm({{}, {}, a}) == render::encodeFilm({{}, {}, b});
}

TEST_F(FilmTest, MergesAndResumesToTheSameBytes) {
  const std::vector<std::string> outputs{"depth", "ids"};
  render::Renderer whole = renderer(outputs);
  for (const std::uint32_t count : {4u, 4u, 4u, 2u}) whole.renderBatch(count);

  render::Renderer second = renderer(outputs), first = renderer(outputs);
  second.startAt(2);
  second.renderBatch(4);
  second.renderBatch(2);
  first.renderBatch();
  first.renderBatch();
  render::FilmState joined = second.saveFilm();
  render::mergeFilm(joined, first.saveFilm());
  EXPECT_TRUE(sameBytes(joined, whole.saveFilm()));

  render::Renderer resumed = renderer(outputs);
  resumed.renderBatch();
  resumed.restoreFilm(first.saveFilm());
  resumed.renderBatch(4);
  resumed.renderBatch(2);
  EXPECT_TRUE(sameBytes(resumed.saveFilm(), whole.saveFilm()));
  EXPECT_EQ(resumed.statistics().samples, 14u);
}

// Two renderers share batches: rows of the first three, then tiles of adaptive ones.
TEST_F(FilmTest, PartsOfBatchesAddUpToTheSameBytes) {
  options.width = 90, options.height = 64;  // 3 x 2 tiles
  const std::vector<std::string> outputs{"depth", "ids"};
  render::Renderer whole = renderer(outputs), first = renderer(outputs), second = renderer(outputs);
  for (const std::uint32_t count : {4u, 4u, 4u}) whole.renderBatch(count);
  const std::vector<std::uint32_t> limits{3, 4, 6, 3, 3, 3, 5, 5, 3, 3, 3, 3};
  const render::AdaptiveBatches adaptive =
      render::nextAdaptiveBatches(whole.film().region(), whole.film().counts(), limits);
  ASSERT_EQ(adaptive.tiles.size(), 6u);
  ASSERT_EQ(adaptive.tiles[3].batch, 4u) << "the second batch of a tile";
  ASSERT_TRUE(whole.renderCells(limits));

  const std::uint32_t rows = whole.film().region().height;
  for (std::uint32_t batch = 0; batch < 3; ++batch) {
    const render::SampleRange samples{4 * batch, 4 * batch + 4};
    const std::uint32_t cut = 1 + batch % 2;
    ASSERT_TRUE(second.renderPart({samples, {}, 0, cut}));
    ASSERT_TRUE(first.renderPart({samples, {}, cut, 2}));
    ASSERT_TRUE(second.renderPart({samples, {}, cut + 2, rows - cut - 2}));
  }
  ASSERT_TRUE(first.renderPart({{}, adaptive.tiles, 1, 3}));
  ASSERT_TRUE(second.renderPart({{}, adaptive.tiles, 0, 1}));
  ASSERT_TRUE(second.renderPart({{}, adaptive.tiles, 4, 2}));
  render::FilmState joined = second.takeFilm();
  render::addFilm(joined, first.takeFilm());
  joined.counts = whole.film().counts();
  EXPECT_TRUE(sameBytes(joined, whole.saveFilm()));
  EXPECT_TRUE(first.film().counts().ranges.empty());

  render::FilmState again = first.takeFilm();
  render::addFilm(joined, again);
  joined.counts = whole.film().counts();
  EXPECT_TRUE(sameBytes(joined, whole.saveFilm())) << "takeFilm() discards the samples";
}

// Two tiles, which extend beyond the image, side by side and one above the other.
TEST_F(FilmTest, CountsBatchesPerCell) {
  for (const uvec2 size : {uvec2(37, 5), uvec2(5, 37)}) {
    options.width = size.x, options.height = size.y;
    render::Renderer r = renderer({});
    r.renderBatch();
    ASSERT_EQ(render::tileCount(r.film().region()), 2u);
    const std::vector<std::uint32_t> limits{1, 3, 2, 0};
    while (r.film().counts().cellBatches != std::vector<std::uint32_t>{1, 3, 2, 1}) ASSERT_TRUE(r.renderCells(limits));
    const io::Image color = r.image();
    std::uint64_t rays = 0;
    for (std::uint32_t y = 0; y < size.y; ++y)
      for (std::uint32_t x = 0; x < size.x; ++x) {
        const std::uint32_t batches = std::array{1u, 3u, 2u, 1u}[2 * (std::max(x, y) / 32) + (x + y) % 2];
        ASSERT_NEAR(color.pixel<float>(x, y)[1], meanOf(4 * batches, [](double s) { return s * s; }), 1e-4)
            << x << ", " << y;
        rays += 4 * batches;
      }
    EXPECT_EQ(r.rays().rays, rays);
  }
}

// The same plan gives the same bytes for all launch sizes and orders of cells.
TEST(AdaptiveFilm, IsIndependentOfLaunchesAndCellOrder) {
  using Limits = std::vector<std::uint32_t>;
  SceneBuilder scene;
  scene.add(quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), lambert(vec3(0.5f)))
      .add(box({-0.5f, 0, -0.5f}, {0.5f, 0.8f, 0.5f}), lambert({0.7f, 0.2f, 0.2f}));
  scene.sky(vec3(0.7f)).camera(perspective({1.5f, 1.5f, 3.0f}, {0, 0.4f, 0}, 50.0f));
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  ImageOptions options;
  options.width = 70;
  options.height = 40;  // 3 x 2 tiles
  const Limits plan{1, 3, 2, 1, 4, 2, 1, 1, 3, 3, 2, 5};
  const auto film = [&](double launchSeconds, std::uint32_t inFlight, const std::vector<Limits>& steps) {
    render::RenderSettings settings = settingsFor(scene.scene.cameras[0], options);
    settings.outputs = {"depth", "cryptomatte_object"};
    settings.launchSeconds = launchSeconds;
    settings.launchesInFlight = inFlight;
    render::Renderer renderer = makeRenderer(device, options.program, settings);
    renderer.renderBatch();
    Limits reached(plan.size(), 1);
    for (const Limits& limits : steps) {
      for (std::size_t c = 0; c < plan.size(); ++c) reached[c] = std::max(reached[c], limits[c]);
      while (renderer.film().counts().cellBatches != reached) EXPECT_TRUE(renderer.renderCells(limits));
    }
    return renderer.saveFilm();
  };
  const auto cells = [&](const auto& chosen) {
    Limits limits(plan.size(), 0);
    for (std::size_t c = 0; c < plan.size(); ++c) limits[c] = chosen(c) ? plan[c] : 0;
    return limits;
  };
  const render::FilmState whole = film(1e9, 1, {plan});
  EXPECT_TRUE(sameBytes(film(1e-9, 2, {cells([](std::size_t c) { return c % 2 == 1; }), plan}), whole))
      << "many launches, odd cells first";
  std::vector<Limits> backwards;
  for (std::size_t c = plan.size(); c-- > 0;)
    if (plan[c] > 1) backwards.push_back(cells([&](std::size_t other) { return other == c; }));
  EXPECT_TRUE(sameBytes(film(1e9, 2, backwards), whole)) << "cell by cell, starting at the last one";
  std::vector<Limits> forwards;
  for (std::uint32_t batches = 2; batches <= 5; ++batches) {
    Limits& limits = forwards.emplace_back(plan);
    for (std::uint32_t& limit : limits) limit = std::min(limit, batches);
  }
  EXPECT_TRUE(sameBytes(film(1e9, 1, forwards), whole)) << "one batch at a time";
}

}  // namespace
}  // namespace quintet::test

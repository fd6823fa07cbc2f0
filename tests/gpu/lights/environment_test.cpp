// SPDX-License-Identifier: Apache-2.0
// The environment: orientation, sampling against the table, densities, irradiance.
#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "lights/light_scene.h"

namespace quintet::test {
namespace {

using glm::dvec2;
using glm::dvec3;
constexpr std::size_t kEnvironmentSamples = 400'000;
const Defines kWrongMap{{"QUINTET_WRONG_ENVIRONMENT_PDF", "1"}};

scene::Environment mapOf(std::uint32_t width, std::uint32_t height, auto value) {
  scene::Environment environment;
  environment.present = true;
  environment.image = io::makeImage(width, height, 3, io::PixelType::f32, io::ColorEncoding::linear);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      for (float& c : environment.image.pixel<float>(x, y)) c = value(x, y);
  return environment;
}

float hashedNoise(std::uint32_t x, std::uint32_t y) {
  std::uint32_t h = x * 0x9E3779B9u ^ y * 0x85EBCA6Bu;
  h = (h ^ h >> 15) * 0x2C1B3C6Du;
  return static_cast<float>((h ^ h >> 13) >> 8) * 0x1p-24f;
}

// Six decades of noise, a black patch, a sun, a bright texel at a pole and one at the seam; 31 x 16 texels.
scene::Environment nastyMap() {
  scene::Environment environment = mapOf(31, 16, [](std::uint32_t x, std::uint32_t y) {
    if (x > 10 && x < 20 && y > 5 && y < 11) return 0.0f;
    if (x == 3 && y == 4) return 1e4f;
    if ((x == 17 && y == 0) || (x == 30 && y == 9)) return 1e3f;
    return std::pow(10.0f, 6.0f * hashedNoise(x, y) - 4.0f);
  });
  environment.rotation = 1.1f;
  environment.intensity = 0.5f;
  return environment;
}

// The convention of scene::Environment in double precision.
dvec3 worldDirection(const scene::Environment& environment, double u, double cosTheta) {
  const double phi = 2.0 * kPiDouble * (u - 0.5), r = std::sqrt(1.0 - cosTheta * cosTheta);
  const dvec3 local(r * std::cos(phi), cosTheta, r * std::sin(phi));
  const auto turn = glm::rotate(glm::dmat4(1.0), static_cast<double>(environment.rotation), dvec3(0, 1, 0));
  return dvec3(turn * glm::dvec4(local, 1.0));
}
dvec2 mapPosition(const scene::Environment& environment, const dvec3& world) {
  const auto back = glm::rotate(glm::dmat4(1.0), -static_cast<double>(environment.rotation), dvec3(0, 1, 0));
  const dvec3 d(back * glm::dvec4(world, 1.0));
  return {std::atan2(d.z, d.x) / (2.0 * kPiDouble) + 0.5, std::atan2(std::hypot(d.x, d.z), d.y) / kPiDouble};
}
double rowCosine(const render::EnvironmentTable& table, std::size_t row) {
  return std::cos(kPiDouble * static_cast<double>(row) / table.height);
}
double cellAngle(const render::EnvironmentTable& table, std::size_t row) {
  return 2.0 * kPiDouble / table.width * (rowCosine(table, row) - rowCosine(table, row + 1));
}

struct MapQuery {
  vec3 radiance;
  float pdf;
};
std::vector<MapQuery> query(const LightScene& scene, const std::vector<vec3>& directions, const Defines& defines = {}) {
  return runCompute<MapQuery>(R"(
    #include <quintet/lights/lights.glsl>
    struct Query { vec3 radiance; float pdf; };
    #define In vec3
    #define Out Query
    Query run(uint i, vec3 d) { return Query(environmentRadiance(d), pdfLightEnvironment(d, lightSampleContext(vec3(0.0)))); }
  )",
                              directions, directions.size(), scene.options(defines));
}

// Directions: +x is u = 0.5, +z is u = 0.75, +y is the top row; a rotation turns the whole towards -z.
TEST(EnvironmentLight, Orientation) {
  const auto gradient = [](std::uint32_t x, std::uint32_t y) { return static_cast<float>(x + 64 * y); };
  scene::Environment environment = mapOf(64, 32, gradient);
  const auto at = [](double u, double v) { return static_cast<float>(64.0 * u - 0.5 + 64.0 * (32.0 * v - 0.5)); };
  for (const float rotation : {0.0f, 0.7f, kPi / 2.0f}) {
    environment.rotation = rotation;
    const LightScene scene(scene::Scene{}, environment);
    std::vector<vec3> directions;
    std::vector<float> wanted;
    for (const dvec2 uv : {dvec2(0.5, 0.5), {0.75, 0.5}, {0.25, 0.4}, {0.1, 0.9}, {0.9, 0.1}, {0.6, 0.04}}) {
      directions.emplace_back(worldDirection(environment, uv.x, std::cos(kPiDouble * uv.y)));
      wanted.push_back(at(uv.x, uv.y));
    }
    const std::vector<MapQuery> found = query(scene, directions);
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i].radiance.x, wanted[i], 0.3f) << i;
  }
  environment.rotation = kPi / 2.0f;
  const LightScene turned(scene::Scene{}, environment);
  EXPECT_NEAR(query(turned, {vec3(0, 0, -1)})[0].radiance.x, at(0.5, 0.5), 0.3f);  // what was at +x
}

// The density at points inside every cell equals the table's probability over the cell's solid angle.
TEST(EnvironmentLight, DensityEqualsTheTable) {
  const scene::Environment environment = nastyMap();
  const LightScene scene(scene::Scene{}, environment);
  const render::EnvironmentTable& table = scene.table.environment;
  std::vector<vec3> directions;
  std::vector<double> wanted;
  for (std::size_t cell = 0; cell < table.entries.size(); ++cell)
    for (int k = 0; k < 16; ++k) {
      const double x = 0.002 + 0.996 * (k % 4) / 3.0, y = 0.002 + 0.996 * (k / 4) / 3.0;
      const std::size_t row = cell / table.width;
      const double u = (static_cast<double>(cell % table.width) + x) / table.width;
      const double cosine = glm::mix(rowCosine(table, row), rowCosine(table, row + 1), y);
      directions.emplace_back(worldDirection(environment, u, cosine));
      wanted.push_back(table.entries[cell].probability / cellAngle(table, row));
    }
  const std::vector<MapQuery> found = query(scene, directions), wrong = query(scene, directions, kWrongMap);
  std::size_t mistakes = 0;
  double integral = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_NEAR(found[i].pdf, wanted[i], 1e-5 * wanted[i]) << i;
    ASSERT_TRUE(found[i].radiance.x == 0.0f || found[i].pdf > 0.0f) << i;
    mistakes += std::abs(wrong[i].pdf - wanted[i]) > 1e-5 * wanted[i] ? 1 : 0;
    integral += found[i].pdf * cellAngle(table, i / 16 / table.width) / 16.0;
  }
  EXPECT_NEAR(integral, 1.0, 1e-5);
  EXPECT_GT(mistakes, found.size() / 2);
}

// Chi-square over quarters of cells (in u and cos θ), found again from the directions in double precision.
void expectSamplesOf(const std::vector<shared::AliasEntry>& entries, const scene::Environment& environment,
                     const LightScene& scene, const Defines& defines) {
  const render::EnvironmentTable& table = scene.table.environment;
  ASSERT_EQ(entries.size(), table.entries.size());
  const auto samples = runCompute<vec4>(R"(
    #include <quintet/lights/lights.glsl>
    #include <quintet/sampling/pcg.glsl>
    #define Out vec4
    vec4 run(uint i) {
      Sampler rng = makeSampler(uvec2(3u), i, 7u);
      float pdf;
      const vec3 wi = environmentSample(next2D(rng), nextBits(rng), pdf);
      return vec4(wi, pdf);
    }
  )",
                                        kEnvironmentSamples, scene.options(defines));
  std::vector<double> observed(table.entries.size() * 4, 0.0), expected(observed.size()), byAngle(observed.size());
  std::size_t mismatches = 0;
  for (const vec4& s : samples) {
    const dvec3 wi(s);
    ASSERT_NEAR(glm::length(wi), 1.0, 1e-6);
    const dvec2 p = mapPosition(environment, wi) * dvec2(table.width, table.height);
    const std::size_t row = std::min<std::size_t>(static_cast<std::size_t>(p.y), table.height - 1);
    const std::size_t column = std::min<std::size_t>(static_cast<std::size_t>(p.x), table.width - 1);
    const double y = (rowCosine(table, row) - wi.y) / (rowCosine(table, row) - rowCosine(table, row + 1));
    const std::size_t quarter = (p.x - static_cast<double>(column) < 0.5 ? 0 : 1) + (y < 0.5 ? 0 : 2);
    observed[(row * table.width + column) * 4 + quarter] += 1.0;
    const double wanted = entries[row * table.width + column].probability / cellAngle(table, row);
    mismatches += std::abs(s.w - wanted) > 1e-4 * wanted ? 1 : 0;
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    expected[i] = static_cast<double>(kEnvironmentSamples) * entries[i / 4].probability / 4.0;
    byAngle[i] = static_cast<double>(kEnvironmentSamples) * cellAngle(table, i / 4 / table.width) / (16.0 * kPiDouble);
  }
  EXPECT_LT(mismatches, 20u);  // rounding moves a few directions over the border of their cell
  EXPECT_GT(chiSquareTest(observed, expected).pValue, 0.01);
  EXPECT_LT(chiSquareTest(observed, byAngle).pValue, 1e-9);
  // In cells of probability 0 only what rounding moves over their border.
  for (std::size_t i = 0; i < observed.size(); ++i) EXPECT_TRUE(expected[i] > 0.0 || observed[i] < 3.0) << i;
}

TEST(EnvironmentLight, SamplesFollowTheDensity) {
  const scene::Environment environment = nastyMap();
  const LightScene scene(scene::Scene{}, environment);
  expectSamplesOf(scene.table.environment.entries, environment, scene, {});
}

TEST(EnvironmentLight, BalancedSamplesFollowTheirDensity) {
  const scene::Environment environment = nastyMap();
  const LightScene scene(scene::Scene{}, environment);
  expectSamplesOf(scene.table.environment.balanced, environment, scene, {{"QUINTET_BALANCED_ENVIRONMENT", "1"}});
}

// A constant sky gives pi, as a constant and as a map.
TEST(EnvironmentLight, ConstantSkyGivesPi) {
  scene::Environment constant;
  constant.constant = vec3(1.0f);
  for (const scene::Environment& environment : {constant, mapOf(9, 5, [](auto, auto) { return 1.0f; })}) {
    const LightScene scene(scene::Scene{}, environment);
    for (const vec3& normal : {vec3(0, 1, 0), glm::normalize(vec3(1, -0.3f, 0.6f))})
      EXPECT_GT(pValue(irradiance(sampleLights(scene, vec3(0.0f), kEnvironmentSamples), normal), kPiDouble),
                sidak(0.01, 4));
  }
  const LightScene scene(scene::Scene{}, mapOf(9, 5, [](auto, auto) { return 1.0f; }));
  EXPECT_LT(
      pValue(irradiance(sampleLights(scene, vec3(0.0f), kEnvironmentSamples, kWrongMap), vec3(0, 1, 0)), kPiDouble),
      1e-9);
}

// Importance sampling against a brute-force quadrature of environmentRadiance itself.
TEST(EnvironmentLight, IrradianceOfANastyMap) {
  const scene::Environment environment = nastyMap();
  const LightScene scene(scene::Scene{}, environment);
  constexpr int kWidth = 31 * 32, kHeight = 16 * 32;
  std::vector<vec3> directions;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const double theta = kPiDouble * (i / kWidth + 0.5) / kHeight;
    directions.emplace_back(worldDirection(environment, (i % kWidth + 0.5) / kWidth, std::cos(theta)));
  }
  const std::vector<MapQuery> values = query(scene, directions);
  const std::vector<LightOut> samples = sampleLights(scene, vec3(0.0f), kEnvironmentSamples);
  const std::vector<LightOut> wrong = sampleLights(scene, vec3(0.0f), kEnvironmentSamples, kWrongMap);
  for (const vec3& normal : {vec3(0, 1, 0), vec3(-1, 0, 0), glm::normalize(vec3(0.2f, -0.3f, 0.9f))}) {
    double exact = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double theta = kPiDouble * (static_cast<double>(i / kWidth) + 0.5) / kHeight;
      exact += values[i].radiance.x * std::max(0.0f, glm::dot(directions[i], normal)) * std::sin(theta);
    }
    exact *= 2.0 * kPiDouble * kPiDouble / (static_cast<double>(kWidth) * kHeight);
    EXPECT_GT(pValue(irradiance(samples, normal), exact), sidak(0.01, 3));
    EXPECT_LT(pValue(irradiance(wrong, normal), exact), 1e-9);
  }
}

// All kinds of light at once: the sum of their closed forms, and delta flags and densities that add up.
TEST(Lights, AllKindsTogether) {
  const mat4 above = glm::rotate(glm::translate(mat4(1.0f), vec3(0, 0.5f, 0)), glm::radians(90.0f), vec3(1, 0, 0));
  scene::Scene source = emissiveRectangle(vec3(1.0f), above);
  source.lights.resize(3);
  source.lights[0].position = {0, 3, 4};
  source.lights[0].intensity = vec3(20.0f);
  source.lights[1].type = scene::LightType::directional;
  source.lights[1].direction = glm::normalize(vec3(1, -1, 0));
  source.lights[2].type = scene::LightType::spot;
  source.lights[2].position = {0, 2, 0};
  source.lights[2].direction = {0, -1, 0};
  source.lights[2].intensity = vec3(3.0f);
  scene::Environment sky;
  sky.constant = vec3(0.25f);
  const double r = 1.0 / std::sqrt(2.0);
  const double square = 4.0 * r * std::atan(r);  // triangle_test.cpp, ParallelSquareTextbook
  const double exact = square + 20.0 / 25.0 * 0.6 + r + 3.0 / 4.0 + 0.25 * kPiDouble;
  const LightScene scene(source, sky);
  EXPECT_GT(pValue(irradiance(sampleLights(scene, vec3(0.0f), 2'000'000), vec3(0, 1, 0)), exact), 0.01);
  EXPECT_NEAR(query(scene, {vec3(0, 1, 0)})[0].pdf, scene.probabilities(vec3(0.0f)).back() / (4.0 * kPiDouble), 1e-6);
}

TEST(Lights, None) {
  const LightScene scene(scene::Scene{}, {});
  for (const LightOut& s : sampleLights(scene, vec3(0.0f), 100)) EXPECT_FALSE(s.valid);
  const MapQuery q = query(scene, {vec3(0, 1, 0)})[0];
  EXPECT_EQ(q.pdf, 0.0f);
  EXPECT_EQ(q.radiance, vec3(0.0f));
}

}  // namespace
}  // namespace quintet::test

// SPDX-License-Identifier: Apache-2.0
// Maps from the unit square: a chi-square test of the density, on cells of equal measure.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/math.h"
#include "bsdf/chi_square.h"
#include "harness.h"

namespace quintet::test {
namespace {

constexpr std::size_t kWarpSamples = 200'000;
constexpr int kCells = 24;

// `inverse` maps the point back to the unit square, area-preserving, by a formula independent of the map. WRONG uses a
// non-uniform input, which the test must detect.
struct Warp {
  const char* name;
  const char* map;      // GLSL, of vec2 u
  const char* inverse;  // GLSL, of vec3 p
};

const std::vector<Warp> kWarps{
    {"disk", "vec3(sampleDisk(u), 0.0)", "vec2(dot(p.xy, p.xy), turn(p.xy))"},
    {"cosine hemisphere", "sampleCosineHemisphere(u)", "vec2(p.z * p.z, turn(p.xy))"},
    {"sphere", "sampleSphere(u)", "vec2(0.5 - 0.5 * p.z, turn(p.xy))"},
    {"wide cone", "sampleCone(u, 0.3)", "vec2((1.0 - p.z) / 0.7, turn(p.xy))"},
    {"narrow cone", "sampleCone(u, 0.99999)", "vec2(dot(p.xy, p.xy) / (1.0 + p.z) / (1.0 - 0.99999), turn(p.xy))"},
    {"triangle", "vec3(sampleTriangle(u), 0.0)", "vec2((p.x + p.y) * (p.x + p.y), p.y / max(1e-30, p.x + p.y))"},
};

std::vector<vec3> run(const Warp& warp, bool wrong, bool raw) {
  ComputeOptions options;
  if (wrong) options.defines.emplace_back("WRONG", "1");
  const std::string body = R"(
    #include <quintet/sampling/pcg.glsl>
    #include <quintet/sampling/warp.glsl>
    #define Out vec3
    float turn(vec2 d) { return fract(atan(d.y, d.x) / (2.0 * kPi) + 1.0); }
    vec3 run(uint i) {
      Sampler s = makeSampler(uvec2(i, 0u), 0u, 1u);
      vec2 u = next2D(s);
    #ifdef WRONG
      u.x *= mix(u.x, 1.0, 0.9);
    #endif
      const vec3 p = )" + std::string(warp.map) +
                           R"(;
      return )" + (raw ? "p" : "vec3(" + std::string(warp.inverse) + ", 0.0)") +
                           R"(;
    }
  )";
  return runCompute<vec3>(body, kWarpSamples, options);
}

double sphereUniformity(const std::vector<vec3>& points) {
  std::vector<double> observed(kCells * kCells, 0.0);
  const std::vector<double> expected(kCells * kCells, static_cast<double>(points.size()) / (kCells * kCells));
  for (const vec3& p : points) {
    const glm::ivec2 scaled(p * static_cast<float>(kCells));
    const glm::ivec2 cell = glm::clamp(scaled, glm::ivec2(0), glm::ivec2(kCells - 1));
    observed[cell.y * kCells + cell.x] += 1.0;
  }
  return chiSquareTest(observed, expected).pValue;
}

TEST(Warp, MatchesTheStatedDensity) {
  for (const Warp& warp : kWarps) {
    EXPECT_GT(sphereUniformity(run(warp, false, false)), sidak(0.01, kWarps.size())) << warp.name;
    EXPECT_LT(sphereUniformity(run(warp, true, false)), 1e-9) << warp.name;
  }
}

TEST(Warp, ResultsLieInTheirDomain) {
  for (const Warp& warp : kWarps)
    for (const vec3& p : run(warp, false, true)) {
      if (std::string_view(warp.name) == "disk") {
        ASSERT_LE(glm::length(p), 1.0f + 1e-6f);
      } else if (std::string_view(warp.name) == "triangle") {
        ASSERT_GE(glm::min(p.x, p.y), 0.0f);
        ASSERT_LE(p.x + p.y, 1.0f + 1e-6f);
      } else {
        ASSERT_NEAR(glm::length(p), 1.0f, 1e-6f) << warp.name;
      }
    }
}

// The corners of the square give no NaN and no point outside the domain.
TEST(Warp, CornersAreFinite) {
  const auto values = runCompute<vec3>(R"(
    #include <quintet/sampling/warp.glsl>
    #define Out vec3
    vec3 run(uint i) {
      const float big = 1.0 - 1.0 / 16777216.0;
      const vec2 u = vec2((i & 1u) != 0u ? big : 0.0, (i & 2u) != 0u ? big : 0.0);
      const uint warp = (i >> 2) % 5u;
      const vec2 v = (i >= 20u) ? vec2(0.5) : u;
      if (warp == 0u) return vec3(sampleDisk(v), 0.0);
      if (warp == 1u) return sampleCosineHemisphere(v);
      if (warp == 2u) return sampleSphere(v);
      if (warp == 3u) return sampleCone(v, 0.999999);
      return vec3(sampleTriangle(v), 0.0);
    }
  )",
                                       40);
  for (const vec3& v : values) {
    EXPECT_TRUE(isFinite(v));
    EXPECT_LE(glm::length(v), 1.0f + 1e-6f);
  }
}

}  // namespace
}  // namespace quintet::test

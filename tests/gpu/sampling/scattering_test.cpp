// SPDX-License-Identifier: Apache-2.0
// Phase function and distances in media that scatter.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/math.h"
#include "bsdf/chi_square.h"
#include "harness.h"

namespace quintet::test {
namespace {

constexpr std::size_t kScatterSamples = 200'000;
const std::vector<float> kAnisotropies{-0.9f, -0.3f, 0.0f, 1e-4f, 0.5f, 0.95f};

// The distribution of the cosine, integrated by hand: F(c) = (1-g²)/2g (1/sqrt(1+g²-2gc) - 1/(1+g)).
double phaseDistribution(double cosine, double g) {
  if (std::abs(g) < 1e-2) return 0.5 * (1.0 + cosine) - 0.75 * g * (1.0 - cosine * cosine);  // first order in g
  return (1.0 - g * g) / (2.0 * g) * (1.0 / std::sqrt(1.0 + g * g - 2.0 * g * cosine) - 1.0 / (1.0 + g));
}

TEST(PhaseFunction, SamplesFollowTheDistribution) {
  constexpr int kBins = 40;
  for (const float g : kAnisotropies) {
    SCOPED_TRACE(g);
    const std::vector<vec3> found = runCompute<vec3>(R"(
      #include <quintet/sampling/pcg.glsl>
      #include <quintet/scattering.glsl>
      #define In float
      #define Out vec3
      Out run(uint i, float g) {
        Sampler s = makeSampler(uvec2(i, 0u), 0u, 1u);
        const vec3 d = normalize(vec3(1.0, 2.0, -3.0));
        const vec3 w = samplePhaseFunction(d, g, next2D(s));
        return vec3(dot(d, w), phaseFunction(dot(d, w), g), length(w));
      }
    )",
                                                     std::vector<float>{g}, kScatterSamples);
    std::vector<double> observed(kBins, 0.0), expected(kBins, static_cast<double>(kScatterSamples) / kBins);
    for (const vec3& f : found) {
      const double u = phaseDistribution(static_cast<double>(f.x), static_cast<double>(g));
      ++observed[static_cast<std::size_t>(std::clamp(static_cast<int>(u * kBins), 0, kBins - 1))];
      EXPECT_NEAR(f.z, 1.0f, 1e-5f);
      // The density is the derivative of the distribution over 2π.
      const double c = std::clamp(static_cast<double>(f.x), -0.999, 0.999), h = 1e-4;
      if (std::abs(static_cast<double>(f.x)) < 0.999) {
        const double slope =
            (phaseDistribution(c + h, static_cast<double>(g)) - phaseDistribution(c - h, static_cast<double>(g))) /
            (2 * h);
        ASSERT_NEAR(static_cast<double>(f.y), slope / (2.0 * static_cast<double>(kPi)),
                    2e-3 * static_cast<double>(f.y) + 1e-5);
      }
    }
    EXPECT_GT(chiSquareTest(observed, expected).pValue, 1e-4);
  }
}

// The weights add up to the transmittance and to the fraction that scatters, for each channel.
TEST(MediumStep, WeightsAreUnbiased) {
  const vec3 attenuation(0.5f, 3.0f, 0.0f), albedo(0.9f, 0.3f, 0.5f);
  for (const vec3& throughput : {vec3(1.0f), vec3(0.2f, 0.7f, 2.0f), vec3(0.0f, 1.0f, 0.0f)}) {
    struct Step {
      float distance;
      vec3 weight;
    };
    const std::vector<Step> steps = runCompute<Step>(R"(
      #include <quintet/sampling/pcg.glsl>
      #include <quintet/scattering.glsl>
      #define In vec3
      #define Out MediumStep
      Out run(uint i, vec3 throughput) {
        Sampler s = makeSampler(uvec2(i, 0u), 0u, 1u);
        return sampleMediumStep(vec3(0.5, 3.0, 0.0), vec3(0.9, 0.3, 0.5), throughput, 0.8, next2D(s));
      }
    )",
                                                     std::vector<vec3>{throughput}, kScatterSamples);
    glm::dvec3 passed(0.0), scattered(0.0), distance(0.0);
    for (const Step& s : steps) {
      EXPECT_LT(s.distance, 0.8f);
      (s.distance < 0.0f ? passed : scattered) += glm::dvec3(s.weight);
      if (s.distance >= 0.0f) distance += static_cast<double>(s.distance) * glm::dvec3(s.weight);
    }
    for (glm::length_t c = 0; c < 3; ++c) {
      if (throughput[c] == 0.0f) continue;
      const double n = kScatterSamples, a = static_cast<double>(attenuation[c]), t = std::exp(-0.8 * a);
      EXPECT_NEAR(passed[c] / n, t, 0.01) << c;
      EXPECT_NEAR(scattered[c] / n, static_cast<double>(albedo[c]) * (1.0 - t), 0.01) << c;
      const double mean =
          a > 0.0 ? static_cast<double>(albedo[c]) * (1.0 / a - (0.8 + 1.0 / a) * t) : 0.0;  // ∫ a t exp(-a t) dt
      EXPECT_NEAR(distance[c] / n, mean, 0.01) << c;
    }
  }
}

}  // namespace
}  // namespace quintet::test

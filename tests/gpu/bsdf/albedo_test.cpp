// SPDX-License-Identifier: Apache-2.0
// The albedo tables, as the shader interpolates them, against an oracle in double precision. The oracle shares no code
// with src/render/scene/albedo_tables.cpp. It integrates Walter's BSDF over all micronormals, weighted by D cos theta.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <vector>

#include "bsdf/bsdf_cases.h"

namespace quintet::test {
namespace {

struct AlbedoQuery {
  float cosine;
  float alpha;
  float ior;
  std::uint32_t outside;
};
struct AlbedoAnswer {
  vec2 schlick;
  vec2 glass;
  vec2 average;
};

const std::string kLookUp = kBsdfPrelude + R"(
struct Query { float cosine; float alpha; float ior; uint outside; };
struct Answer { vec2 schlick; vec2 glass; vec2 average; };
#define In Query
#define Out Answer
Out run(uint index, In q) {
  AlbedoCell row = albedoRow(q.alpha);
  return Answer(albedoSchlick(row, q.cosine), albedoGlass(q.cosine, q.alpha, q.ior, q.outside != 0u), albedoAverage(row));
}
)";

double masking(double cosine, double alpha) {
  const double tan2 = 1.0 / (cosine * cosine) - 1.0;
  return 2.0 / (1.0 + std::sqrt(1.0 + alpha * alpha * tan2));
}

// Returns (A, B, glass, glass without Fresnel). With micronormals of density D cos theta, the albedo is the mean of
// F G (wo.m) / (cos_o cos_m).
glm::dvec4 integrate(const AlbedoQuery& q) {
  const double alpha = q.alpha, cosO = q.cosine, sinO = std::sqrt(1.0 - cosO * cosO);
  const double eta = q.outside ? q.ior : 1.0 / q.ior;
  constexpr int kRadii = 3000, kAngles = 256;
  glm::dvec4 sum(0.0);
  for (int i = 0; i < kRadii; ++i) {
    const double t = (i + 0.5) / kRadii;
    const double u = 1.0 - (1.0 - t) * (1.0 - t), density = 2.0 * (1.0 - t);
    const double tangent = alpha * std::sqrt(u / (1.0 - u)), cosM = 1.0 / std::sqrt(1.0 + tangent * tangent);
    for (int j = 0; j < kAngles; ++j) {
      const double phi = 2.0 * std::numbers::pi * (j + 0.5) / kAngles;
      const double c = sinO * tangent * cosM * std::cos(phi) + cosO * cosM;
      if (c <= 0.0) continue;
      const double weight = density * c / (cosO * cosM);
      const double maskO = masking(cosO, alpha);
      const double reflectedZ = 2.0 * c * cosM - cosO;
      double reflected = 0.0;
      if (reflectedZ > 0.0) {
        const double maskI = masking(reflectedZ, alpha);
        reflected = maskO * maskI / (maskO + maskI - maskO * maskI);  // height-correlated
      }
      double fresnel = 1.0, refracted = reflected;
      const double cosT2 = 1.0 - (1.0 - c * c) / (eta * eta);
      if (cosT2 > 0.0) {
        const double cosT = std::sqrt(cosT2);
        const double rs = (c - eta * cosT) / (c + eta * cosT), rp = (eta * c - cosT) / (eta * c + cosT);
        fresnel = 0.5 * (rs * rs + rp * rp);
        const double refractedZ = (c / eta - cosT) * cosM - cosO / eta;
        refracted = refractedZ < 0.0 ? maskO * masking(-refractedZ, alpha) : 0.0;
      }
      const double schlick = std::pow(1.0 - c, 5.0);
      sum += weight * glm::dvec4(reflected * (1.0 - schlick), reflected * schlick,
                                 fresnel * reflected + (1.0 - fresnel) * refracted, refracted);
    }
  }
  return sum / double{kRadii * kAngles};
}

// The albedo of Estevez and Kulla's sheen (2017, eq. 2 and table 1), integrated over the incident directions. Each is
// divided by divisor(its cosine).
template <class Divisor>
double sheenAlbedo(double cosO, double alpha, int radii, const Divisor& divisor) {
  const double t = (1.0 - alpha) * (1.0 - alpha);
  const auto fit = [&](double x) {
    const double a = 21.5473 + 3.7772 * t, b = 3.82987 - 0.50552 * t, c = 0.19823 - 0.03022 * t;
    const double d = -1.97760 + 0.70367 * t, e = -4.32054 - 0.53913 * t;
    return a / (1.0 + b * std::pow(x, c)) + d * x + e;
  };
  const auto lambda = [&](double x) { return std::exp(x < 0.5 ? fit(x) : 2.0 * fit(0.5) - fit(1.0 - x)); };
  constexpr int kAngles = 256;
  const glm::dvec3 wo(std::sqrt(1.0 - cosO * cosO), 0.0, cosO);
  double sum = 0.0;
  for (int i = 0; i < radii; ++i) {
    const double x = (i + 0.5) / radii, cosI = x * x, sinI = std::sqrt(1.0 - cosI * cosI);
    const double lambdas = lambda(cosO) + lambda(cosI), scale = 2.0 * x / divisor(cosI);
    for (int j = 0; j < kAngles; ++j) {
      const double phi = std::numbers::pi * (j + 0.5) / kAngles;
      const glm::dvec3 h = glm::normalize(wo + glm::dvec3(sinI * std::cos(phi), sinI * std::sin(phi), cosI));
      sum += scale * std::pow(1.0 - h.z * h.z, 0.5 / alpha) / (4.0 * cosO * (1.0 + lambdas));
    }
  }
  return sum * (2.0 + 1.0 / alpha) / (radii * kAngles);
}
double sheenAlbedo(double cosO, double alpha, int radii = 1500) {
  return sheenAlbedo(cosO, alpha, radii, [](double) { return 1.0; });
}

// The albedo A of the sheen whose f is divided by max(1, E(o), E(i)) (sheen.glsl).
class LimitedSheen {
 public:
  explicit LimitedSheen(double alpha) : alpha_(alpha) {
    for (int i = 0; i <= kCells; ++i)
      albedos_.push_back(sheenAlbedo(std::pow(std::max(i, 1) / double{kCells}, 2.0), alpha, 300));
  }
  double operator()(double cosO) const {
    const double atO = std::max(1.0, sheenAlbedo(cosO, alpha_));
    return sheenAlbedo(cosO, alpha_, 1500, [&](double cosI) { return std::max(atO, albedo(cosI)); });
  }

 private:
  static constexpr int kCells = 100;
  // E, interpolated along the square root of the cosine.
  double albedo(double cosine) const {
    const double x = std::sqrt(cosine) * kCells;
    const auto cell = static_cast<std::size_t>(std::min(x, kCells - 1.0));
    return std::lerp(albedos_[cell], albedos_[cell + 1], x - static_cast<double>(cell));
  }
  const double alpha_;
  std::vector<double> albedos_;
};

class BsdfAlbedo : public BsdfTest {
 protected:
  static std::vector<AlbedoAnswer> lookUp(const std::vector<AlbedoQuery>& queries) {
    return runQueries<AlbedoAnswer>(kLookUp, queries);
  }
};

TEST_F(BsdfAlbedo, TablesAgreeWithTheOracle) {
  const std::vector<AlbedoQuery> queries = {{1.0f, 1.0f, 1.5f, 1},   {1.0f, 1.0f, 1.5f, 0},  {0.6f, 0.5f, 1.33f, 1},
                                            {0.6f, 0.5f, 1.33f, 0},  {0.15f, 0.8f, 2.0f, 1}, {0.15f, 0.8f, 2.0f, 0},
                                            {0.3f, 0.1f, 1.5f, 1},   {0.3f, 0.1f, 1.5f, 0},  {0.85f, 0.02f, 1.7f, 1},
                                            {0.85f, 0.25f, 1.7f, 0}, {0.05f, 0.3f, 1.2f, 1}, {0.05f, 0.3f, 1.2f, 0},
                                            {1.0f, 0.6f, 1.5f, 0},   {0.1f, 1.0f, 1.15f, 0}, {0.75f, 1.0f, 2.4f, 0}};
  const std::vector<AlbedoAnswer> answers = lookUp(queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const glm::dvec4 expected = integrate(queries[i]);
    EXPECT_NEAR(1.0 - answers[i].schlick.x - answers[i].schlick.y, expected.x, 0.004) << i;
    EXPECT_NEAR(answers[i].schlick.y, expected.y, 0.004) << i;
    EXPECT_NEAR(answers[i].glass.x, expected.z, 0.012) << i;
    EXPECT_NEAR(answers[i].glass.y, expected.w, 0.015) << i;
  }
}

TEST_F(BsdfAlbedo, SheenAgreesWithTheOracle) {
  struct SheenQuery {
    float cosine;
    float alpha;
  };
  const std::string body = kBsdfPrelude + R"(
    struct SheenQuery { float cosine; float alpha; };
    #define In SheenQuery
    #define Out vec2
    Out run(uint index, In q) { return albedoSheen(albedoRow(q.alpha, kSheenRoughnesses), q.cosine); }
  )";
  std::vector<SheenQuery> queries;
  for (const float alpha : {0.003f, 0.02f, 0.05f, 0.1f, 0.3f, 0.7f, 1.0f})
    for (const float cosine : {1.0f, 0.8f, 0.55f, 0.3f, 0.1f, 0.03f, 0.01f}) queries.push_back({cosine, alpha});
  const std::vector<vec2> answers = runQueries<vec2>(body, queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const auto& [cosine, alpha] = queries[i];
    const double expected = sheenAlbedo(cosine, alpha);
    EXPECT_NEAR(answers[i].x, expected, 0.005 + 0.02 * expected) << "cosine " << cosine << ", alpha " << alpha;
    EXPECT_LE(answers[i].y, 1.0 + 1e-5);
    if (alpha >= 0.1f) {  // E is below 1
      EXPECT_NEAR(answers[i].y, answers[i].x, 1e-6);
    }
  }
  for (const float alpha : {0.003f, 0.02f, 0.05f}) {
    const LimitedSheen limited(static_cast<double>(alpha));
    for (std::size_t i = 0; i < queries.size(); ++i) {
      if (queries[i].alpha != alpha) continue;
      EXPECT_NEAR(answers[i].y, limited(static_cast<double>(queries[i].cosine)), 0.02)
          << "cosine " << queries[i].cosine << ", alpha " << alpha;
    }
  }
}

// The average equals that of the interpolated albedo. The coupling of the diffuse base relies on this.
TEST_F(BsdfAlbedo, AverageIsThatOfTheRow) {
  constexpr int kPoints = 4096;
  for (const float alpha : {0.0005f, 0.05f, 0.4f, 1.0f}) {
    std::vector<AlbedoQuery> queries;
    for (int i = 0; i < kPoints; ++i)
      queries.push_back({std::sqrt((static_cast<float>(i) + 0.5f) / kPoints), alpha, 1.5f, 1});
    glm::dvec2 sum(0.0);
    const std::vector<AlbedoAnswer> answers = lookUp(queries);
    for (const AlbedoAnswer& a : answers) sum += glm::dvec2(a.schlick) / double{kPoints};
    EXPECT_NEAR(answers[0].average.x, sum.x, 5e-4) << alpha;
    EXPECT_NEAR(answers[0].average.y, sum.y, 5e-4) << alpha;
  }
}

}  // namespace
}  // namespace quintet::test

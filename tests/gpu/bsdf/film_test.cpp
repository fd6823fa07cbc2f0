// SPDX-License-Identifier: Apache-2.0
// The reflectance of thin films against an oracle: Airy's formula at each wavelength, integrated with the color matching
// functions of the CIE 1931 observer (the fits of Wyman, Sloan and Shirley 2013).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "bsdf/bsdf_cases.h"
#include "bsdf/reference.h"

namespace quintet::test {
namespace {

struct FilmQuery {
  float cosine, ior, thickness;
  vec3 baseF0;
};

const std::string kReflectance = kBsdfPrelude + R"(
struct Query { float cosine; float ior; float thickness; vec3 baseF0; };
#define In Query
#define Out vec3
Out run(uint index, In q) { return filmReflectance(Film(1.0, q.ior, q.thickness), q.cosine, q.baseF0); }
)";

double bell(double x, double center, double low, double high) {
  const double t = (x - center) * (x < center ? low : high);
  return std::exp(-0.5 * t * t);
}

// Wyman, Sloan and Shirley 2013, "Simple Analytic Approximations to the CIE XYZ Color Matching Functions", listing 1.
glm::dvec3 matching(double nm) {
  return {0.362 * bell(nm, 442.0, 0.0624, 0.0374) + 1.056 * bell(nm, 599.8, 0.0264, 0.0323) -
              0.065 * bell(nm, 501.1, 0.0490, 0.0382),
          0.821 * bell(nm, 568.8, 0.0213, 0.0247) + 0.286 * bell(nm, 530.9, 0.0613, 0.0322),
          1.217 * bell(nm, 437.0, 0.0845, 0.0278) + 0.681 * bell(nm, 459.0, 0.0385, 0.0725)};
}

// At normal incidence, for media of the indices 1, `film` and `base`.
glm::dvec3 spectralReflectance(double film, double base, double thickness) {
  const double first = (1.0 - film) / (1.0 + film), second = (film - base) / (film + base);
  glm::dvec3 sum(0.0), white(0.0);
  for (double nm = 360.0; nm <= 830.0; nm += 1.0) {
    const std::complex<double> turn = std::polar(1.0, 4.0 * std::numbers::pi * film * thickness / nm);
    sum += std::norm((first + second * turn) / (1.0 + first * second * turn)) * matching(nm);
    white += matching(nm);
  }
  const glm::dvec3 xyz = sum / white;
  return {glm::dot(glm::dvec3(3.2404542, -1.5371385, -0.4985314), xyz),
          glm::dot(glm::dvec3(-0.9692660, 1.8760108, 0.0415560), xyz),
          glm::dot(glm::dvec3(0.0556434, -0.2040259, 1.0572252), xyz)};
}

using BsdfFilm = BsdfTest;

// The tolerance is that of the Gaussian fits, and of the two orders of interference that are summed.
TEST_F(BsdfFilm, AgreesWithTheSpectrum) {
  std::vector<FilmQuery> queries;
  for (const float base : {1.5f, 2.4f})
    for (const float ior : {1.2f, 1.4f, 1.9f})
      for (const float thickness : {100.0f, 250.0f, 400.0f, 700.0f}) {
        const float r = (base - 1.0f) / (base + 1.0f);
        queries.push_back({1.0f, ior, thickness, vec3(r * r)});
      }
  const auto answers = runQueries<vec3>(kReflectance, queries);
  double largest = 0.0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const FilmQuery& q = queries[i];
    const double root = std::sqrt(double{q.baseF0.x});
    const glm::dvec3 expected =
        glm::clamp(spectralReflectance(q.ior, (1.0 + root) / (1.0 - root), q.thickness), 0.0, 1.0);
    const double difference = glm::length(glm::dvec3(answers[i]) - expected);
    EXPECT_LT(difference, 0.04) << q.ior << " " << q.thickness << " " << q.baseF0.x;
    largest = std::max(largest, difference);
  }
  std::printf("  film against the spectrum: largest difference %.4f\n", largest);
}

// The same formula on the host, from normal incidence to grazing angles.
TEST_F(BsdfFilm, AgreesWithTheReference) {
  std::vector<FilmQuery> queries;
  for (const float cosine : {1.0f, 0.7f, 0.4f, 0.1f, 0.01f})
    for (const float ior : {1.1f, 1.6f, 2.2f})
      for (const float thickness : {0.5f, 80.0f, 300.0f, 1100.0f})
        queries.push_back({cosine, ior, thickness, vec3(0.04f, 0.3f, 0.95f)});
  const auto answers = runQueries<vec3>(kReflectance, queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const FilmQuery& q = queries[i];
    const glm::dvec3 expected = referenceFilm({q.ior, q.thickness}, q.cosine, q.baseF0);
    EXPECT_LT(glm::length(glm::dvec3(answers[i]) - expected), 1e-3) << q.cosine << " " << q.ior << " " << q.thickness;
  }
}

// A film without thickness is none. A base that reflects everything stays white.
TEST_F(BsdfFilm, LimitsAreExact) {
  std::vector<FilmQuery> queries;
  for (const float cosine : {1.0f, 0.6f, 0.2f, 0.0f}) queries.push_back({cosine, 1.4f, 420.0f, vec3(1.0f)});
  for (const vec3& answer : runQueries<vec3>(kReflectance, queries))
    EXPECT_LT(glm::distance(answer, vec3(1.0f)), 1e-3f);
  BsdfCase bare;
  bare.wo = directionAt(0.2f);
  bare.metallic = 0.5f, bare.alpha = 0.3f, bare.baseColor = {0.9f, 0.5f, 0.2f};
  BsdfCase film = bare;
  film.iridescence = 1.0f, film.iridescenceThickness = 0.0f;
  const std::string body = kBsdfPrelude + R"(
    #define In Case
    #define Out vec3
    Out run(uint index, In c) { return bsdfEval(makeBsdfOf(c), c.wo, normalize(vec3(-0.8, 0.3, 0.4))); }
  )";
  const auto values = runCases<vec3>(body, {bare, film}, 2);
  EXPECT_EQ(values[0], values[1]);
}

}  // namespace
}  // namespace quintet::test

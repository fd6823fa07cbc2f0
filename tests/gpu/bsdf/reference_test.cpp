// SPDX-License-Identifier: Apache-2.0
// bsdfEval against a second implementation of the model on the host, for every material, roughness and angle.
#include "bsdf/reference.h"

#include <gtest/gtest.h>

namespace quintet::test {
namespace {

struct Values {
  vec3 wi;
  vec3 value;
};

// Sampled directions, which are in the lobes, and uniform ones.
const std::string kEvaluation = kBsdfPrelude + R"(
  struct Answer { vec3 wi; vec3 value; };
  #define In Case
  #define Out Answer
  Out run(uint index, In c) {
    Bsdf b = makeBsdfOf(c);
    BsdfSample s;
    vec3 u = randomAt(index, 21u);
    bool valid = bsdfSample(b, c.wo, u.z, u.xy, s);
    vec3 wi = valid && randomAt(index, 22u).z < 0.6 ? s.wi : uniformDirection(randomAt(index, 22u).xy);
    return Out(wi, bsdfEval(b, c.wo, wi));
  }
)";

class BsdfReference : public BsdfTest {
 protected:
  // The tolerance covers the rounding errors of half vectors: 1e-7 over the length of their tangential part, relative to
  // alpha. Near the critical angle, 1 - Fresnel has few digits: values below 2e-5 are not compared.
  static void compare(std::vector<NamedCase> cases, double tolerance, int perCase) {
    std::erase_if(cases, [](const NamedCase& named) { return !named.inReference; });
    const ReferenceBsdf reference;
    std::vector<BsdfCase> materials;
    for (const NamedCase& named : cases) materials.push_back(named.material);
    const std::vector<Values> answers =
        runCases<Values>(kEvaluation, materials, materials.size() * static_cast<std::size_t>(perCase));
    std::size_t compared = 0;
    for (std::size_t k = 0; k < answers.size(); ++k) {
      const NamedCase& named = cases[k % cases.size()];
      if (std::abs(answers[k].wi.z) < 1e-3f) continue;
      const glm::dvec3 expected = reference.eval(named.material, glm::normalize(glm::dvec3(answers[k].wi)));
      const glm::dvec3 value = answers[k].value;
      ++compared;
      ASSERT_LE(glm::length(value - expected), tolerance * glm::length(expected) + 2e-5)
          << named.name << ": " << value.x << ", " << value.y << ", " << value.z << " instead of " << expected.x << ", "
          << expected.y << ", " << expected.z << " at wi = " << answers[k].wi.x << ", " << answers[k].wi.y << ", "
          << answers[k].wi.z;
    }
    EXPECT_GT(compared, answers.size() * 9 / 10);
  }
};

TEST_F(BsdfReference, RoughMaterials) {
  std::vector<NamedCase> cases;
  for (const float alpha : {0.1f, 0.4f, 1.0f})
    for (const float cosine : kCosines)
      for (const NamedCase& named : materialsAt(alpha, directionAt(cosine))) cases.push_back(named);
  compare(cases, 2e-3, 200);
}

// KHR_materials_ior with 0: the reflectance is specular · specularColor, in a lobe of the surface's roughness.
// Films with small weights, over metal and dielectric with small weights.
TEST_F(BsdfReference, FaintFilms) {
  NamedCase named{"faint film", {}};
  BsdfCase& c = named.material;
  c.wo = directionAt(0.4f);
  c.alpha = 0.3f;
  c.baseColor = {0.9f, 0.5f, 0.2f};
  c.specular = 0.2f;
  c.iridescence = 0.2f, c.iridescenceThickness = 350.0f;
  NamedCase mixed = named;
  mixed.material.metallic = 0.2f, mixed.material.iridescence = 1.0f;
  compare({named, mixed}, 2e-3, 2000);
}

TEST_F(BsdfReference, FullReflectance) {
  std::vector<NamedCase> cases;
  for (const float alpha : {0.1f, 0.4f, 1.0f})
    for (const float cosine : kCosines)
      for (const bool entering : {true, false}) {
        BsdfCase c;
        c.wo = directionAt(cosine);
        c.alpha = alpha;
        c.entering = entering;
        c.ior = 0.0f;
        c.transmission = 1.0f;
        cases.push_back({"glass of ior 0", c});
        c.specular = 0.7f, c.specularColor = {0.5f, 1.0f, 0.2f}, c.baseColor = {0.9f, 0.5f, 0.2f};
        cases.push_back({"glass of ior 0, colored", c});
        c.transmission = 0.6f, c.metallic = 0.3f, c.clearcoat = 0.5f, c.clearcoatAlpha = 0.2f;
        cases.push_back({"mixture of ior 0", c});
      }
  compare(cases, 2e-3, 200);
}

TEST_F(BsdfReference, NarrowLobes) {
  std::vector<NamedCase> cases;
  for (const float alpha : {0.003f, 0.02f})
    for (const float cosine : {1.0f, 0.75f, 0.3f})
      for (const NamedCase& named : materialsAt(alpha, directionAt(cosine))) cases.push_back(named);
  compare(cases, 0.02, 200);
}

}  // namespace
}  // namespace quintet::test

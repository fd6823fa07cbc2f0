// SPDX-License-Identifier: Apache-2.0
// White furnace: in uniform light of radiance 1 a white surface reflects radiance 1. The mean of the sample weights is the
// albedo. For refraction the factor 1/eta² is divided out, because in equilibrium the radiance inside a solid is eta²
// times that outside.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "bsdf/bsdf_cases.h"

namespace quintet::test {
namespace {

constexpr std::size_t kFurnaceSamples = 1 << 16;
const std::vector<float> kAlphas = {0.0f, 0.0005f, 0.003f, 0.02f, 0.1f, 0.3f, 0.6f, 1.0f};
const std::vector<float> kAngles = {1.0f, 0.75f, 0.3f, 0.1f, 0.03f, 0.01f, 0.001f};

struct Albedo {
  glm::dvec3 mean{0.0};
  double error = 0.0;  // standard error of the largest channel
};

class BsdfFurnace : public BsdfTest {
 protected:
  static Albedo albedoOf(const BsdfCase& material) {
    const auto samples = runCases<BsdfSampleOut>(kBsdfSampling, {material}, kFurnaceSamples);
    const double eta = material.entering ? material.ior : 1.0 / material.ior;
    const bool refracts = !material.thin && material.ior >= 1.0f;
    glm::dvec3 sum(0.0), squares(0.0);
    for (const BsdfSampleOut& s : samples) {
      if (!s.valid) continue;
      const glm::dvec3 weight = glm::dvec3(s.weight) * (s.transmitted && refracts ? eta * eta : 1.0);
      sum += weight;
      squares += weight * weight;
    }
    const double n = kFurnaceSamples;
    const glm::dvec3 variance = glm::max(squares / n - sum * sum / (n * n), 0.0);
    return {sum / n, std::sqrt(std::max({variance.x, variance.y, variance.z}) / n)};
  }

  // Expects albedo 1 within `tolerance` for all roughnesses and angles; prints the largest deviation.
  template <class Change>
  static void expectWhite(const char* name, double tolerance, const Change& change, float azimuth = 0.7f) {
    double worst = 0.0;
    std::string where;
    for (const float alpha : kAlphas) {
      for (const float cosine : kAngles) {
        BsdfCase c;
        c.wo = directionAt(cosine, azimuth);
        c.alpha = alpha;
        change(c);
        const Albedo albedo = albedoOf(c);
        EXPECT_NEAR(albedo.mean.x, 1.0, tolerance + 4.0 * albedo.error)
            << name << ", alpha " << alpha << ", cosine " << cosine;
        if (std::abs(albedo.mean.x - 1.0) <= std::abs(worst)) continue;
        worst = albedo.mean.x - 1.0;
        where = "alpha " + std::to_string(alpha) + ", cosine " + std::to_string(cosine);
      }
    }
    std::printf("  furnace, %s: largest deviation %+.4f (%s)\n", name, worst, where.c_str());
  }
};

TEST_F(BsdfFurnace, WhiteMetal) {
  expectWhite("metal", 0.01, [](BsdfCase& c) { c.metallic = 1.0f; });
}

TEST_F(BsdfFurnace, WhiteDielectric) {
  expectWhite("dielectric", 0.01, [](BsdfCase&) {});
  expectWhite("dielectric, ior 2.4", 0.01, [](BsdfCase& c) { c.ior = 2.4f; });
  expectWhite("dielectric, ior 0", 0.01, [](BsdfCase& c) { c.ior = 0.0f; });
  expectWhite("dielectric, half specular", 0.01, [](BsdfCase& c) { c.specular = 0.5f; });
}

TEST_F(BsdfFurnace, WhiteThinWall) {
  expectWhite("thin wall", 0.01, [](BsdfCase& c) { c.transmission = 1.0f, c.thin = 1; });
}

TEST_F(BsdfFurnace, WhiteGlass) {
  for (const float ior : {1.15f, 1.5f, 2.4f}) {
    for (const bool entering : {true, false}) {
      const std::string name = "glass, ior " + std::to_string(ior) + (entering ? ", outside" : ", inside");
      expectWhite(name.c_str(), entering ? 0.01 : 0.018,
                  [&](BsdfCase& c) { c.transmission = 1.0f, c.ior = ior, c.entering = entering; });
    }
  }
  expectWhite("glass without specular", 0.01, [](BsdfCase& c) { c.transmission = 1.0f, c.specular = 0.0f; });
  for (const float specular : {1.0f, 0.6f}) {
    expectWhite("glass, ior 0", 0.01, [&](BsdfCase& c) { c.transmission = 1.0f, c.ior = 0.0f, c.specular = specular; });
    expectWhite("half glass, ior 0, inside", 0.01,
                [&](BsdfCase& c) { c.transmission = 0.5f, c.ior = 0.0f, c.entering = 0, c.specular = specular; });
  }
  expectWhite("matched glass", 1e-4, [](BsdfCase& c) { c.transmission = 1.0f, c.ior = 1.0f; });
}

TEST_F(BsdfFurnace, DiffuseTransmission) {
  expectWhite("diffuse transmission", 0.01, [](BsdfCase& c) { c.diffuseTransmission = 0.6f, c.thin = 1; });
  expectWhite("diffuse transmission under sheen", 0.022, [](BsdfCase& c) {
    c.diffuseTransmission = 0.6f, c.thin = 1, c.sheenColor = vec3(0.5f), c.sheenAlpha = 0.3f;
  });
}

// The tables of the widths and the azimuth are coarse for the widest ratios, at grazing angles along the narrow width.
TEST_F(BsdfFurnace, Anisotropy) {
  for (const auto& [strength, azimuth] : {std::pair{0.5f, 0.9f}, {1.0f, 0.0f}, {1.0f, 1.5f}})
    expectWhite(
        "anisotropic metal", 0.03,
        [&, strength = strength](BsdfCase& c) { c.metallic = 1.0f, c.anisotropy = strength; }, azimuth);
  const auto anisotropic = [](BsdfCase& c) { c.anisotropy = 0.8f; };
  expectWhite("anisotropic dielectric", 0.03, anisotropic);
  expectWhite("anisotropic thin wall", 0.03, [&](BsdfCase& c) { anisotropic(c), c.transmission = 1.0f, c.thin = 1; });
  for (const bool outside : {true, false})
    expectWhite(outside ? "anisotropic glass, outside" : "anisotropic glass, inside", outside ? 0.03 : 0.1,
                [&](BsdfCase& c) { anisotropic(c), c.transmission = 1.0f, c.entering = outside; });
}

// A film reflects colors. Of these, the largest channel limits the light below, as in KHR_materials_iridescence: the
// largest channel of the albedo is 1, or less where it changes with the angle of rough surfaces.
TEST_F(BsdfFurnace, Iridescence) {
  const auto film = [](BsdfCase& c, float thickness) { c.iridescence = 1.0f, c.iridescenceThickness = thickness; };
  expectWhite("film on metal", 0.01, [&](BsdfCase& c) { film(c, 400.0f), c.metallic = 1.0f; });
  double brightest = 0.0, darkest = 1.0;
  for (const int kind : {0, 1, 2, 3})  // dielectric, thin wall, glass from outside and inside
    for (const float thickness : {150.0f, 400.0f, 900.0f})
      for (const float alpha : {0.0f, 0.02f, 0.3f, 1.0f})
        for (const float cosine : {1.0f, 0.75f, 0.3f, 0.1f, 0.01f}) {
          BsdfCase c;
          c.wo = directionAt(cosine);
          c.alpha = alpha;
          c.transmission = kind == 0 ? 0.0f : 1.0f;
          c.thin = kind == 1;
          c.entering = kind != 3;
          film(c, thickness);
          const Albedo albedo = albedoOf(c);
          const double largest = std::max({albedo.mean.x, albedo.mean.y, albedo.mean.z});
          EXPECT_LE(largest, 1.03 + 4.0 * albedo.error) << kind << " " << thickness << " " << alpha << " " << cosine;
          EXPECT_GE(largest, 0.94 - 4.0 * albedo.error) << kind << " " << thickness << " " << alpha << " " << cosine;
          brightest = std::max(brightest, largest), darkest = std::min(darkest, largest);
        }
  std::printf("  furnace, film: largest channel from %.3f to %.3f\n", darkest, brightest);
}

TEST_F(BsdfFurnace, ClearcoatAndMixture) {
  expectWhite("clearcoat on dielectric", 0.01,
              [](BsdfCase& c) { c.clearcoat = 1.0f, c.clearcoatAlpha = c.alpha, c.alpha = 0.5f; });
  expectWhite("everything", 0.01, [](BsdfCase& c) {
    c.clearcoat = 0.7f, c.clearcoatAlpha = 0.05f, c.transmission = 0.5f, c.metallic = 0.3f, c.entering = 0;
  });
}

// A white dielectric stays white under any sheen: what the sheen does not reflect reaches the diffuse base. At the most
// grazing angles, a narrow specular lobe loses light as the metal below does.
TEST_F(BsdfFurnace, SheenOnDielectric) {
  expectWhite("sheen on dielectric", 0.012,
              [](BsdfCase& c) { c.sheenColor = vec3(1.0f), c.sheenAlpha = c.alpha, c.alpha = 0.25f; });
  expectWhite("half sheen on dielectrics", 0.022, [](BsdfCase& c) { c.sheenColor = vec3(0.5f), c.sheenAlpha = 0.3f; });
  expectWhite("sheen under clearcoat", 0.015, [](BsdfCase& c) {
    c.sheenColor = vec3(1.0f), c.sheenAlpha = c.alpha, c.alpha = 0.5f, c.clearcoat = 1.0f, c.clearcoatAlpha = 0.1f;
  });
  expectWhite("sheen inside a solid", 0.018,
              [](BsdfCase& c) { c.sheenColor = vec3(1.0f), c.transmission = 1.0f, c.entering = 0, c.ior = 0.0f; });
}

// The minimum that keeps f reciprocal loses light where the base scatters from grazing angles toward the normal: rough
// metal and rough thin walls. Smooth ones lose nothing.
TEST_F(BsdfFurnace, SheenOnMetalAndThinWall) {
  for (const bool metal : {true, false}) {
    double darkest = 1.0;
    for (const float alpha : {0.0f, 0.003f, 0.1f, 1.0f})
      for (const float sheenAlpha : {0.02f, 1.0f})
        for (const float cosine : kAngles) {
          BsdfCase c;
          c.wo = directionAt(cosine);
          c.alpha = alpha;
          c.metallic = metal ? 1.0f : 0.0f;
          c.transmission = metal ? 0.0f : 1.0f;
          c.thin = 1;
          c.sheenColor = vec3(1.0f);
          c.sheenAlpha = sheenAlpha;
          const Albedo albedo = albedoOf(c);
          const double least = alpha <= 0.01f * cosine ? 0.988 : 0.85;
          EXPECT_LE(albedo.mean.x, 1.012 + 4.0 * albedo.error) << alpha << " " << sheenAlpha << " " << cosine;
          EXPECT_GE(albedo.mean.x, least - 4.0 * albedo.error) << alpha << " " << sheenAlpha << " " << cosine;
          darkest = std::min(darkest, albedo.mean.x);
        }
    std::printf("  furnace, sheen on %s: smallest albedo %.3f\n", metal ? "metal" : "a thin wall", darkest);
  }
}

TEST_F(BsdfFurnace, NoMaterialGainsEnergy) {
  std::mt19937 generator(11);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  const auto next = [&] { return uniform(generator); };
  for (int i = 0; i < 150; ++i) {
    BsdfCase c;
    c.wo = directionAt(std::max(next() * next(), 0.002f));
    c.alpha = next() * next();
    c.baseColor = {1.0f, next(), 1.0f};
    c.metallic = i % 3 == 0 ? next() : 0.0f;
    c.transmission = i % 2 == 0 ? next() : 0.0f;
    c.ior = 1.0f + 1.5f * next();
    c.entering = next() < 0.5f;
    c.thin = next() < 0.3f;
    c.specular = next() < 0.5f ? next() : 1.0f;
    c.specularColor = {1.0f, next(), 2.0f * next()};
    c.clearcoat = next() < 0.5f ? next() : 0.0f;
    c.clearcoatAlpha = next() * next();
    c.clearcoatNormal = glm::normalize(vec3(next() - 0.5f, next() - 0.5f, 1.0f));
    if (i % 4 == 1) {
      c.sheenColor = {next(), 1.0f, next()};
      c.sheenAlpha = next() * next();
    }
    if (i % 5 == 1) c.diffuseTransmission = next(), c.thin = 1;
    if (i % 5 == 2) c.anisotropy = next();
    if (i % 5 == 3) c.iridescence = next(), c.iridescenceIor = 1.0f + next(), c.iridescenceThickness = 1000.0f * next();
    const Albedo albedo = albedoOf(c);
    EXPECT_LE(std::max({albedo.mean.x, albedo.mean.y, albedo.mean.z}), 1.04 + 4.0 * albedo.error)
        << "case " << i << ": alpha " << c.alpha << ", cosine " << c.wo.z << ", ior " << c.ior << ", transmission "
        << c.transmission << ", metallic " << c.metallic << ", specular " << c.specular << ", entering " << c.entering
        << ", thin " << c.thin;
  }
}

}  // namespace
}  // namespace quintet::test

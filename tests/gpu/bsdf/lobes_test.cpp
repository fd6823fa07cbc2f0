// SPDX-License-Identifier: Apache-2.0
// Properties of the lobes at single pairs of directions: weights, reciprocity, deltas, total reflection, sides. No
// parameters may lead to invalid results.
#include <algorithm>

#include <gtest/gtest.h>

#include "bsdf/bsdf_cases.h"

namespace quintet::test {
namespace {

constexpr std::size_t kLobeSamples = 1 << 14;

double relativeDifference(const vec3& a, const vec3& b) {
  return glm::length(a - b) / std::max(1e-6f, std::max(glm::length(a), glm::length(b)));
}

class BsdfLobes : public BsdfTest {
 protected:
  static std::vector<BsdfSampleOut> sample(const BsdfCase& material, std::size_t count = kLobeSamples) {
    return runCases<BsdfSampleOut>(kBsdfSampling, {material}, count);
  }
};

// bsdfSample, bsdfEval and bsdfPdf agree.
TEST_F(BsdfLobes, WeightIsEvalOverPdf) {
  struct Out {
    vec3 weight;
    float pdf;
    vec3 value;
    float evaluatedPdf;
  };
  const std::string body = kBsdfPrelude + R"(
    struct Out_ { vec3 weight; float pdf; vec3 value; float evaluatedPdf; };
    #define In Case
    #define Out Out_
    Out run(uint index, In c) {
      Bsdf b = makeBsdfOf(c);
      BsdfSample s;
      vec3 u = randomAt(index, 2u);
      if (!bsdfSample(b, c.wo, u.z, u.xy, s) || s.delta) return Out(vec3(0.0), 0.0, vec3(0.0), 0.0);
      return Out(s.weight, s.pdf, bsdfEval(b, c.wo, s.wi), bsdfPdf(b, c.wo, s.wi));
    }
  )";
  std::vector<BsdfCase> cases;
  for (const float alpha : kRoughAlphas)
    for (const float cosine : kCosines)
      for (const NamedCase& named : materialsAt(alpha, directionAt(cosine))) cases.push_back(named.material);
  std::size_t valid = 0;
  for (const Out& out : runCases<Out>(body, cases, cases.size() * 1000)) {
    if (out.pdf == 0.0f) continue;
    ++valid;
    ASSERT_LE(std::abs(out.pdf - out.evaluatedPdf), 1e-3f * out.pdf);
    ASSERT_LE(relativeDifference(out.weight * out.pdf, out.value), 2e-3);
  }
  EXPECT_GT(valid, cases.size() * 850);
}

// f(wo, wi) = f(wi, wo) for all materials, except for two factors that depend on wo alone: that of glass for multiple
// scattering and that of the clearcoat for the lobes below. For refraction f / (index at wo)^2 is compared (Veach 1997,
// eq. 5.14). The clearcoat gets the surface's normal here, because f has the cosine to only one of the normals.
const std::string kBothWays = kBsdfPrelude + R"(
  struct Out_ { vec3 forward; vec3 backward; };
  #define In Case
  #define Out Out_
  vec3 evalOf(Case c, vec3 wo, vec3 wi) {
    c.wo = wo;
    c.clearcoatNormal = vec3(0.0, 0.0, 1.0);
    Bsdf b = makeBsdfOf(c);
  #ifndef AS_IT_IS
    b.underCoat = 1.0;
    b.transmission.dielectric.color /= max(b.transmission.dielectric.compensation, 1e-20);
    b.transmission.dielectric.compensation = 1.0;
  #endif
    return bsdfEval(b, wo, wi) / (abs(wi.z) * (b.transmission.refractive && c.entering == 0u ? c.ior * c.ior : 1.0));
  }
  Out run(uint index, In c) {
    vec3 wo = uniformDirection(randomAt(index, 3u).xy);
    wo.z = max(abs(wo.z), 0.01);
    wo = normalize(wo);
    vec3 wi = uniformDirection(randomAt(index, 4u).xy);
  #ifdef IN_THE_LOBE
    // Directions within the lobe around the mirrored or refracted one: slopes of up to 5 alpha.
    vec3 u = randomAt(index, 5u);
    vec2 width = c.clearcoat > 0.0 && u.z < 0.5 ? vec2(c.clearcoatAlpha) : ggxWidths(c.alpha, c.anisotropy);
    vec3 m = normalize(vec3(width * 5.0 * u.x * vec2(cos(6.2831853 * u.y), sin(6.2831853 * u.y)), 1.0));
    wi = reflect(-wo, m);
    if (c.transmission > 0.0 && index % 2u == 0u)
      wi = c.thin != 0u ? vec3(wi.xy, -wi.z) : refract(-wo, m, c.entering != 0u ? 1.0 / c.ior : c.ior);
    if (dot(wi, wi) == 0.0) return Out(vec3(0.0), vec3(0.0));  // total reflection
    wi = normalize(wi);
  #else
    vec3 m = normalize(wo + (c.entering != 0u ? c.ior : 1.0 / c.ior) * wi);
    m = m.z < 0.0 ? -m : m;
  #endif
    // Skip directions where light leaves the solid near the critical angle: 1 - Fresnel depends on g^2 there, which goes
    // to 0 as dot(wo, m)^2 does and has an absolute error of about 1e-7. Few arbitrary directions of isotropic lobes that
    // are narrow enough for this error are bright enough to be compared.
    bool narrow = c.anisotropy > 0.0;
  #ifdef IN_THE_LOBE
    narrow = true;
  #endif
    if (narrow && wi.z < 0.0 && c.thin == 0u && min(dot(wo, m), -dot(wi, m)) < 0.05) return Out(vec3(0.0), vec3(0.0));
    if (abs(wi.z) < 0.01) wi = vec3(0.0, 0.0, 1.0);
    vec3 forward = evalOf(c, wo, wi);
    if (wi.z > 0.0) return Out(forward, evalOf(c, wi, wo));
    if (c.thin == 0u) c.entering = 1u - c.entering;  // seen from the other side, upside down
    return Out(forward, evalOf(c, wi * vec3(1.0, 1.0, -1.0), wo * vec3(1.0, 1.0, -1.0)));
  }
)";
struct BothWays {
  vec3 forward;
  vec3 backward;
};

// Tested with arbitrary directions and with directions in the lobe: few arbitrary ones are in a narrow lobe.
TEST_F(BsdfLobes, Reciprocity) {
  for (const bool inTheLobe : {false, true}) {
    const Defines defines = inTheLobe ? Defines{{"IN_THE_LOBE", "1"}} : Defines{};
    for (const float alpha : kRoughAlphas) {
      for (NamedCase& named : materialsAt(alpha, vec3(0.0f, 0.0f, 1.0f))) {
        // The clearcoat covers solids on one side only.
        const bool solid = named.material.transmission > 0.0f || named.material.diffuseTransmission > 0.0f;
        if (solid && !named.material.thin) named.material.clearcoat = 0.0f;
        std::size_t compared = 0;
        for (const BothWays& out : runCases<BothWays>(kBothWays, {named.material}, 20'000, defines)) {
          const double size = std::max(glm::length(out.forward), glm::length(out.backward));
          if (size < 1e-3) continue;  // far from the peak of a narrow lobe, float has few significant digits
          ++compared;
          ASSERT_LE(relativeDifference(out.forward, out.backward), 2e-3) << named.name << " " << inTheLobe;
        }
        EXPECT_GT(compared, inTheLobe ? 5000u : alpha < 0.1f ? 5u : 2000u) << named.name;
      }
    }
  }
}

// Limits of the lobes that are not reciprocal. Glass: a factor of wo compensates for multiple scattering (Turquin 2019),
// because a reciprocal lobe would need tables of four dimensions. Clearcoat: the lobes below are scaled on the way out
// only, as KHR_materials_clearcoat specifies.
TEST_F(BsdfLobes, GlassAndCoatAreReciprocalUpToAFactor) {
  struct Limit {
    const char* name;
    double ratio;
    BsdfCase material;
  };
  std::vector<Limit> limits;
  BsdfCase glass, coat;
  glass.transmission = 1.0f;
  for (const auto& [alpha, ratio] : {std::pair{0.02f, 1.3}, {0.1f, 1.6}, {0.4f, 2.0}, {1.0f, 3.0}}) {
    glass.alpha = alpha;
    limits.push_back({"glass", ratio, glass});
  }
  coat.clearcoat = 1.0f;
  limits.push_back({"coat", 10.0, coat});
  for (const Limit& limit : limits) {
    double largest = 1.0;
    for (const BothWays& out : runCases<BothWays>(kBothWays, {limit.material}, 20'000, {{"AS_IT_IS", "1"}})) {
      const double forward = glm::length(out.forward), backward = glm::length(out.backward);
      if (std::max(forward, backward) > 1e-3) largest = std::max({largest, forward / backward, backward / forward});
    }
    EXPECT_LE(largest, limit.ratio) << limit.name << ", alpha " << limit.material.alpha;
    EXPECT_GT(largest, 1.01) << limit.name << " is reciprocal now: update this test and path-tracer.md";
    std::printf("  %s, alpha %g: f(wo, wi) / f(wi, wo) up to %.2f\n", limit.name,
                static_cast<double>(limit.material.alpha), largest);
  }
}

TEST_F(BsdfLobes, MirrorReflectsByFresnel) {
  BsdfCase c;
  c.alpha = 0.0f;
  c.metallic = 1.0f;
  c.baseColor = {0.9f, 0.5f, 0.2f};
  c.wo = directionAt(0.5f);
  const float schlick = std::pow(0.5f, 5.0f);
  const vec3 expected = c.baseColor + (1.0f - c.baseColor) * schlick;
  for (const BsdfSampleOut& s : sample(c, 1000)) {
    ASSERT_TRUE(s.valid && s.delta && !s.transmitted);
    EXPECT_EQ(s.pdf, 0.0f);
    EXPECT_LT(glm::length(s.wi - vec3(-c.wo.x, -c.wo.y, c.wo.z)), 1e-6f);
    EXPECT_LT(relativeDifference(s.weight, expected), 2e-3);
  }
}

// Rough surfaces between nearly equal indices are deltas (NearlyEqualIndicesAreADelta), which need no compensation for multiple
// scattering; for an anisotropic one, the smaller width decides.
TEST_F(BsdfLobes, DeltasOfRoughGlassLoseNoLight) {
  struct Interface {
    float ior, alpha, anisotropy;
  };
  for (const bool entering : {true, false})
    for (const auto& [ior, alpha, anisotropy] : {Interface{1.005f, 1.0f, 0.0f}, Interface{1.011f, 6e-4f, 0.5f}}) {
      BsdfCase c;
      c.transmission = 1.0f;
      c.ior = ior, c.alpha = alpha, c.anisotropy = anisotropy, c.entering = entering;
      c.wo = directionAt(0.3f);
      const float eta = entering ? ior : 1.0f / ior;
      for (const BsdfSampleOut& s : sample(c, 1000)) {
        ASSERT_TRUE(s.valid && s.delta) << ior << " " << alpha;
        EXPECT_LT(relativeDifference(s.weight, vec3(s.transmitted ? 1.0f / (eta * eta) : 1.0f)), 2e-3) << ior;
      }
    }
}

// Reflected and refracted fractions, Snell's direction and the scaling of radiance, from both sides.
TEST_F(BsdfLobes, SmoothGlassFollowsSnellAndFresnel) {
  for (const bool entering : {true, false}) {
    for (const float cosine : {1.0f, 0.9f, 0.8f}) {
      BsdfCase c;
      c.alpha = 0.0f;
      c.transmission = 1.0f;
      c.entering = entering;
      c.wo = directionAt(cosine);
      c.baseColor = {1.0f, 0.5f, 0.25f};
      const double eta = entering ? 1.5 : 1.0 / 1.5;
      const double cosT = std::sqrt(1.0 - (1.0 - double{cosine} * cosine) / (eta * eta));
      const double rs = (cosine - eta * cosT) / (cosine + eta * cosT),
                   rp = (eta * cosine - cosT) / (eta * cosine + cosT);
      const double fresnel = 0.5 * (rs * rs + rp * rp);
      glm::dvec3 reflected(0.0), refracted(0.0);
      for (const BsdfSampleOut& s : sample(c)) {
        ASSERT_TRUE(s.valid && s.delta);
        (s.transmitted ? refracted : reflected) += glm::dvec3(s.weight) / double{kLobeSamples};
        const vec3 snell(-c.wo.x / eta, -c.wo.y / eta, -cosT);
        ASSERT_LT(glm::length(s.wi - (s.transmitted ? snell : vec3(-c.wo.x, -c.wo.y, c.wo.z))), 2e-6f);
      }
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(reflected[i], fresnel, 0.01);
        EXPECT_NEAR(refracted[i] * eta * eta, (1.0 - fresnel) * c.baseColor[i], 0.02);
      }
    }
  }
}

TEST_F(BsdfLobes, TotalReflectionLosesNothing) {
  BsdfCase c;
  c.alpha = 0.0f;
  c.transmission = 1.0f;
  c.entering = 0;
  c.specular = 0.3f;
  c.wo = directionAt(0.5f);  // beyond the critical angle, 48 degrees off the normal
  for (const BsdfSampleOut& s : sample(c, 1000)) {
    ASSERT_TRUE(s.valid && s.delta && !s.transmitted);
    EXPECT_LT(relativeDifference(s.weight, vec3(1.0f)), 2e-3);
  }
}

// KHR_materials_transmission: light passes straight on, tinted, through one interface.
TEST_F(BsdfLobes, SmoothThinWallGoesStraightOn) {
  BsdfCase c;
  c.alpha = 0.0f;
  c.transmission = 1.0f;
  c.thin = 1;
  c.baseColor = {1.0f, 0.5f, 0.25f};
  c.wo = directionAt(0.8f);
  const double fresnel = 0.04 + 0.96 * std::pow(0.2, 5.0);
  glm::dvec3 passed(0.0);
  for (const BsdfSampleOut& s : sample(c)) {
    ASSERT_TRUE(s.valid && s.delta);
    if (!s.transmitted) continue;
    ASSERT_LT(glm::length(s.wi + c.wo), 1e-6f);
    passed += glm::dvec3(s.weight) / double{kLobeSamples};
  }
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(passed[i], (1.0 - fresnel) * c.baseColor[i], 0.01);
}

TEST_F(BsdfLobes, SmoothLobesAreReported) {
  const std::string body = kBsdfPrelude + R"(
    #define In Case
    #define Out uint
    Out run(uint index, In c) { return uint(bsdfHasSmooth(makeBsdfOf(c))); }
  )";
  BsdfCase mirror, glass, diffuse, lacquered;
  mirror.alpha = 0.0f, mirror.metallic = 1.0f;
  glass.alpha = 0.0f, glass.transmission = 1.0f;
  diffuse.alpha = 0.0f;
  lacquered = mirror, lacquered.clearcoat = 1.0f;
  EXPECT_EQ((runCases<std::uint32_t>(body, {mirror, glass, diffuse, lacquered}, 4)),
            (std::vector<std::uint32_t>{0, 0, 1, 1}));
}

// The base color of a dielectric scales its diffuse reflection only, so the diffuse part is what the base color adds.
TEST_F(BsdfLobes, TheDiffusePartIsWhatTheBaseColorAdds) {
  struct Out {
    vec3 diffuse, added;
  };
  const std::string body = kBsdfPrelude + R"(
    struct Out_ { vec3 diffuse; vec3 added; };
    #define In Case
    #define Out Out_
    Out run(uint index, In c) {
      const vec3 wi = normalize(vec3(-0.5, 0.3, 0.6));
      Case black = c;
      black.baseColor = vec3(0.0);
      Bsdf b = makeBsdfOf(c);
      return Out(bsdfEvalDiffuse(b, wi), bsdfEval(b, c.wo, wi) - bsdfEval(makeBsdfOf(black), c.wo, wi));
    }
  )";
  BsdfCase plain;
  plain.wo = directionAt(0.4f);
  plain.alpha = 0.3f;
  plain.baseColor = {0.9f, 0.5f, 0.2f};
  BsdfCase coat = plain, sheen = plain, both = plain;
  for (BsdfCase* c : {&coat, &both}) c->clearcoat = 0.8f, c->clearcoatAlpha = 0.2f;
  for (BsdfCase* c : {&sheen, &both}) c->sheenColor = vec3(0.7f, 0.9f, 0.5f), c->sheenAlpha = 0.3f;
  for (const Out& out : runCases<Out>(body, {plain, coat, sheen, both}, 4)) {
    EXPECT_GT(out.diffuse.x, 0.01f);
    EXPECT_LT(relativeDifference(out.diffuse, out.added), 1e-5);
  }
}

// Refraction between nearly equal indices, and by nearly smooth surfaces, is a delta: its half vector has no digits.
TEST_F(BsdfLobes, NearlyEqualIndicesAreADelta) {
  const auto refractsSharply = [](float ior, float alpha) {
    BsdfCase c;
    c.wo = directionAt(0.7f);
    c.transmission = 1.0f;
    c.ior = ior;
    c.alpha = alpha;
    std::size_t refracted = 0, sharp = 0;
    for (const BsdfSampleOut& s : sample(c, 500))
      if (s.valid && s.transmitted) ++refracted, sharp += s.delta;
    EXPECT_GT(refracted, 300u);
    EXPECT_TRUE(sharp == 0 || sharp == refracted);
    return sharp > 0;
  };
  EXPECT_TRUE(refractsSharply(1.005f, 0.5f));
  EXPECT_TRUE(refractsSharply(1.015f, 6e-4f));  // 9e-6 < 1e-5
  EXPECT_FALSE(refractsSharply(1.02f, 6e-4f));
  EXPECT_FALSE(refractsSharply(1.02f, 0.5f));
}

// The cap of visible normals ends where the reflected direction is at the horizon (Eto and Tokuyoshi 2023, section 3).
TEST_F(BsdfLobes, TheCapOfNormalsEndsAtTheHorizon) {
  struct Query {
    vec3 wo;
    float alpha;
  };
  const std::string body = kBsdfPrelude + R"(
    struct Query { vec3 wo; float alpha; };
    #define In Query
    #define Out vec3
    Out run(uint index, In q) {
      return reflect(-q.wo, ggxSampleVisible(q.wo, vec2(q.alpha), ggxBound(q.wo.z, q.alpha), vec2(1.0, 0.0)));
    }
  )";
  std::vector<Query> queries;
  for (const float cosine : {0.95f, 0.7f, 0.3f})
    for (const float alpha : {0.2f, 0.5f, 0.9f}) queries.push_back({directionAt(cosine, 0.0f), alpha});
  const auto answers = runQueries<vec3>(body, queries);
  for (std::size_t i = 0; i < queries.size(); ++i)
    EXPECT_NEAR(answers[i].z, 0.0f, 2e-5f) << queries[i].wo.z << " " << queries[i].alpha;
}

// Millions of random materials and directions. Parameters are often at the ends of their ranges.
TEST_F(BsdfLobes, NothingIsInvalid) {
  struct Out {
    std::uint32_t faults;
    float weight;
  };
  const std::string body = kBsdfPrelude + R"(
    struct Out_ { uint faults; float weight; };
    #define Out Out_
    // In [0,1], often 0 or 1.
    float corner(uint index, uint dimension) { return clamp(randomAt(index, dimension).x * 1.4 - 0.2, 0.0, 1.0); }
    bool broken(vec3 v) { return !(dot(v, vec3(1.0)) >= 0.0 && dot(v, vec3(1.0)) < 1e30 && min(v.x, min(v.y, v.z)) >= 0.0); }
    Out run(uint index) {
      vec3 a = randomAt(index, 100u);
      Case c;
      float cosine = a.x < 0.1 ? 1e-4 : a.x < 0.2 ? 1e-6 : a.x < 0.3 ? 1.0 : a.y;
      c.wo = vec3(sqrt(1.0 - cosine * cosine) * vec2(cos(6.2831853 * a.z), sin(6.2831853 * a.z)), cosine);
      c.alpha = pow(corner(index, 101u), 4.0);
      c.baseColor = vec3(corner(index, 102u), corner(index, 103u), corner(index, 104u));
      c.metallic = corner(index, 105u);
      c.transmission = corner(index, 106u);
      float ior = randomAt(index, 107u).x;
      c.ior = ior < 0.1 ? 0.0 : ior < 0.2 ? 1.0 : ior < 0.3 ? 1.0 + 1e-3 * randomAt(index, 108u).x : 1.0 + 3.0 * randomAt(index, 108u).x;
      c.entering = uint(randomAt(index, 109u).x < 0.5);
      c.thin = uint(randomAt(index, 110u).x < 0.3);
      c.specular = corner(index, 111u);
      c.specularColor = 2.0 * vec3(corner(index, 112u), corner(index, 113u), corner(index, 114u));
      c.clearcoat = corner(index, 115u);
      c.clearcoatAlpha = pow(corner(index, 116u), 4.0);
      c.clearcoatNormal = a.y < 0.5 ? vec3(0.0, 0.0, 1.0) : uniformDirection(randomAt(index, 117u).xy);
      c.sheenColor = vec3(corner(index, 122u), corner(index, 123u), corner(index, 124u));
      c.sheenAlpha = pow(corner(index, 125u), 4.0);
      c.diffuseTransmission = corner(index, 126u);
      c.diffuseTransmissionColor = vec3(corner(index, 127u), corner(index, 128u), corner(index, 129u));
      c.anisotropy = max(corner(index, 130u), 0.0) * float(randomAt(index, 131u).x < 0.5);
      c.iridescence = corner(index, 132u);
      c.iridescenceIor = 1.0 + 2.0 * corner(index, 133u);
      c.iridescenceThickness = 1000.0 * corner(index, 134u);
      Bsdf b = makeBsdfOf(c);
      uint faults = 0u;
      float sum = 0.0;
      for (int i = 0; i < kLobeCount; ++i) sum += b.lobeProbability[i];
      if (!(abs(sum - 1.0) < 1e-5 || sum == 0.0)) faults |= 1u;
      vec3 wi = uniformDirection(randomAt(index, 118u).xy);
      if (randomAt(index, 119u).x < 0.1) wi = -c.wo;
      if (randomAt(index, 119u).y < 0.1) wi = vec3(wi.xy * inversesqrt(max(dot(wi.xy, wi.xy), 1e-20)), 0.0);
      if (broken(bsdfEval(b, c.wo, wi))) faults |= 2u;
      if (broken(vec3(bsdfPdf(b, c.wo, wi)))) faults |= 4u;
      BsdfSample s;
      vec3 u = randomAt(index, 120u);
      if (u.x < 0.05) u.xy = vec2(0.0);
      if (u.x > 0.95) u.xy = vec2(0.99999994);
      if (randomAt(index, 121u).x < 0.05) u.z = 0.99999994;
      bool valid = bsdfSample(b, c.wo, u.z, u.xy, s);
      if (!valid) return Out(faults, 0.0);
      if (!(abs(length(s.wi) - 1.0) < 1e-4)) faults |= 8u;
      if (broken(s.weight)) faults |= 16u;
      if (s.transmitted != (s.wi.z < 0.0)) faults |= 32u;
      if (s.delta != (s.pdf == 0.0)) faults |= 64u;
      if (s.transmitted && c.metallic == 1.0 || s.transmitted && c.transmission == 0.0 && c.diffuseTransmission == 0.0) faults |= 128u;
      return Out(faults, maxComponent(s.weight));
    }
  )";
  const auto outs = runCases<Out>(body, 4'000'000);
  std::uint32_t faults = 0;
  std::size_t faulty = 0, valid = 0;
  float largest = 0.0f;
  for (const Out& out : outs) {
    faults |= out.faults;
    faulty += out.faults != 0;
    valid += out.weight > 0.0f;
    largest = std::max(largest, out.weight);
  }
  EXPECT_EQ(faulty, 0u) << "bits " << faults;
  EXPECT_GT(valid, outs.size() * 8 / 10);
  std::printf("  %zu of %zu samples valid, largest weight %g\n", valid, outs.size(), static_cast<double>(largest));
}

}  // namespace
}  // namespace quintet::test

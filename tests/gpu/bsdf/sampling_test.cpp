// SPDX-License-Identifier: Apache-2.0
// Each lobe, and the whole BSDF, samples directions with the density of its pdf: a chi-square test of counted against
// integrated density. The integral must equal the fraction of the samples that is not rejected.
//
// The cells of a microfacet lobe are rings and sectors of micronormals, in slopes relative to the lobe's width. They fit
// the narrowest lobe at a grazing angle. The cells of the diffuse lobe and of mixtures are rings and sectors of each
// hemisphere around the direction where the density is narrowest. Their radii grow geometrically up to the horizon. They
// fit mirrors and diffuse lobes, but not grazing angles, where the horizon is near.
#include <gtest/gtest.h>

#include <numbers>

#include "bsdf/bsdf_cases.h"
#include "bsdf/chi_square.h"

namespace quintet::test {
namespace {

constexpr int kRings = 24;
constexpr int kSectors = 16;
constexpr int kPoints = 32;  // per cell and axis of the quadrature
constexpr std::size_t kDraws = 120'000;

// LOBE: 0 diffuse, 1 specular, 2 thin, 3 dielectric, 4 clearcoat, 5 all, 6 sheen. WRONG: a mistake that the test must find.
const std::string kLobes = kBsdfPrelude + R"(
// Single scattering only. MultipleScatteringFollowsItsPdf and the mixtures test multiple scattering.
Bsdf lobesOf(Case c) {
  Bsdf b = makeBsdfOf(c);
  if (LOBE == 1) b.specular.multipleProbability = 0.0;
  if (LOBE == 2) b.transmission.thin.multipleProbability = 0.0;
  return b;
}
float pdfOf(Bsdf b, vec3 wo, vec3 wi) {
#if defined(WRONG) && LOBE == 0
  return wi.z > 0.0 ? 0.5 / kPi : 0.0;
#elif defined(WRONG) && LOBE == 1
  vec3 h = normalize(wo + wi);
  return wi.z > 0.0 ? ggxReflectionPdf(ggxDistribution(h, b.specular.alpha), wo, b.specular.alpha, 1.0) : 0.0;
#elif defined(WRONG) && LOBE == 3
  return dielectricPdf(b.transmission.dielectric, wo, wi) / (wi.z < 0.0 ? b.transmission.dielectric.eta * b.transmission.dielectric.eta : 1.0);
#elif LOBE == 0
  return diffusePdf(wi);
#elif LOBE == 1
  return specularPdf(b.specular, wo, wi);
#elif LOBE == 2
  return thinPdf(b.transmission.thin, wo, wi);
#elif LOBE == 3
  return dielectricPdf(b.transmission.dielectric, wo, wi);
#elif LOBE == 4
  return clearcoatPdf(b.clearcoat, wo, wi);
#elif LOBE == 6
  return sheenPdf(wi);
#elif defined(WRONG)
  float moved = 0.1 * (b.lobeProbability[kLobeDiffuse] - b.lobeProbability[kLobeClearcoat]);
  b.lobeProbability[kLobeClearcoat] += moved;
  b.lobeProbability[kLobeDiffuse] -= moved;
  return bsdfPdf(b, wo, wi);
#else
  return bsdfPdf(b, wo, wi);
#endif
}
vec3 sampleOf(Bsdf b, vec3 wo, vec3 u) {
#if LOBE == 0
  return diffuseSample(u.xy);
#elif LOBE == 1
  return specularSample(b.specular, wo, ggxSample(wo, b.specular.alpha, ggxBound(wo, b.specular.alpha), u.xy), u.z, u.xy);
#elif LOBE == 2
  return thinSample(b.transmission.thin, wo, ggxSample(wo, b.transmission.thin.alpha, ggxBound(wo, b.transmission.thin.alpha), u.xy), u.z, u.xy);
#elif LOBE == 3
  vec3 m = ggxSample(wo, b.transmission.dielectric.alpha, 1.0, u.xy);
  vec3 wi = dielectricSample(b.transmission.dielectric, wo, m, u.z);
  return dot(wi, m) * wi.z > 0.0 ? wi : vec3(0.0);
#elif LOBE == 4
  mat3 basis = localFrame(b.clearcoat.normal);
  vec3 o = wo * basis;
  return clearcoatSample(b.clearcoat, wo, basis * ggxSample(o, b.clearcoat.alpha, ggxBound(o.z, b.clearcoat.alpha), u.xy));
#elif LOBE == 6
  return sheenSample(u.xy);
#else
  BsdfSample s;
  return bsdfSample(b, wo, u.z, u.xy, s) ? s.wi : vec3(0.0);
#endif
}
#if LOBE >= 1 && LOBE <= 4
// The frame of the lobe's micronormals and its widths.
mat3 frameOf(Bsdf b) { return LOBE == 4 ? localFrame(b.clearcoat.normal) : mat3(1.0); }
vec2 widthOf(Bsdf b) { return LOBE == 4 ? vec2(b.clearcoat.alpha) : b.specular.alpha; }
// Rings of equal steps of 1 - 1/sqrt(1 + p^2), p: tangent of the micronormal over the width.
// Near the mirror direction of a grazing wo the spacing of floats is up to a fifth of a cell of the narrowest lobe. Random
// numbers spread wi over the interval that rounding has mapped to one value. (A compiler may do the same by turning
// a + (b - a) into b.)
uint cellOf(Case c, Bsdf b, vec3 wi, vec2 u) {
  bool below = wi.z < 0.0;
  vec3 h = LOBE == 2 ? c.wo + vec3(wi.xy, -wi.z) : LOBE == 3 && below ? c.wo + b.transmission.dielectric.eta * wi : c.wo + wi;
  h.xy += (u - 0.5) * exp2(floor(log2(max(abs(wi.xy), 1e-20))) - 23.0);
  vec3 m = h * frameOf(b);
  if (m.z < 0.0) m = -m;
  vec2 p = m.xy / (m.z * widthOf(b));
  int ring = min(int((1.0 - inversesqrt(1.0 + dot(p, p))) * float(RINGS)), RINGS - 1);
  return uint((int(below) * RINGS + ring) * SECTORS + min(int(fract(atan(p.y, p.x) / 6.2831853) * float(SECTORS)), SECTORS - 1));
}
// Density, per d(t, phi), of the direction for the micronormal at (t, phi).
float densityAt(Case c, Bsdf b, bool below, float t, float phi) {
  float p = sqrt(t * (2.0 - t)) / (1.0 - t);
  vec3 m = normalize(vec3(p * widthOf(b) * vec2(cos(phi), sin(phi)), 1.0));
  float solidAngle = pow(m.z * (1.0 / (1.0 - t)), 3.0) * widthOf(b).x * widthOf(b).y;  // cos^3 of an area of slopes
  m = frameOf(b) * m;
  float cosO = dot(c.wo, m);
  if (cosO <= 0.0) return 0.0;
  vec3 wi = reflect(-c.wo, m);
  float stretch = 4.0 * cosO;
  if (LOBE == 2) wi.z = -wi.z;
  if (LOBE == 3 && below) {
    wi = refract(-c.wo, m, 1.0 / b.transmission.dielectric.eta);
    float cosI = dot(wi, m);
    if (cosI == 0.0) return 0.0;
    float h = cosO + b.transmission.dielectric.eta * cosI;
    stretch = h * h / (b.transmission.dielectric.eta * b.transmission.dielectric.eta * -cosI);  // Walter et al. 2007, eq. 17
  }
  return below == (wi.z < 0.0) ? pdfOf(b, c.wo, wi) * stretch * solidAngle : 0.0;
}
float integralOf(Case c, Bsdf b, int side, int ring, int sector) {
  float sum = 0.0;
  for (int j = 0; j < POINTS; ++j)
    for (int i = 0; i < POINTS; ++i)
      sum += densityAt(c, b, side == 1, (float(ring) + (float(i) + 0.5) / float(POINTS)) / float(RINGS),
                       6.2831853 * (float(sector) + (float(j) + 0.5) / float(POINTS)) / float(SECTORS));
  return sum * 6.2831853 / float(RINGS * SECTORS * POINTS * POINTS);
}
#else
// The direction inside the hemisphere where the density is narrowest.
vec3 poleOf(Case c, Bsdf b, bool below) {
  vec3 pole = reflect(-c.wo, vec3(0.0, 0.0, 1.0));
  if (below) {
    pole = refract(-c.wo, vec3(0.0, 0.0, 1.0), b.transmission.refractive ? 1.0 / b.transmission.dielectric.eta : 1.0);
    if (dot(pole, pole) == 0.0) pole = vec3(pole.xy, -0.05);
  }
  pole.z = below ? min(pole.z, -0.02) : max(pole.z, 0.02);
  return normalize(pole);
}
// The angle from the pole to the horizon, for the azimuth of the unit vector t across the pole.
float horizon(vec3 pole, vec3 t) { return atan(abs(pole.z), pole.z > 0.0 ? -t.z : t.z); }
// Radii are relative to that of the horizon.
uint cellOf(Case c, Bsdf b, vec3 wi, vec2 u) {
  bool below = wi.z < 0.0;
  vec3 pole = poleOf(c, b, below);
  mat3 basis = localFrame(pole);
  vec3 d = wi * basis;
  float across = length(d.xy);
  vec2 t = across > 0.0 ? d.xy / across : vec2(1.0, 0.0);
  float r = atan(across, d.z) / horizon(pole, basis * vec3(t, 0.0));
  float turn = fract(atan(t.y, t.x) / 6.2831853);
  int ring = clamp(int(ceil(log(max(r, 1e-12) / FIRST) / -log(FIRST) * float(RINGS - 1))), 0, RINGS - 1);
  return uint((int(below) * RINGS + ring) * SECTORS + min(int(turn * float(SECTORS)), SECTORS - 1));
}
float integralOf(Case c, Bsdf b, int side, int ring, int sector) {
  vec3 pole = poleOf(c, b, side == 1);
  mat3 basis = localFrame(pole);
  float outer = pow(FIRST, 1.0 - float(ring) / float(RINGS - 1));
  float inner = ring == 0 ? 0.0 : pow(FIRST, 1.0 - float(ring - 1) / float(RINGS - 1));
  float sum = 0.0;
  for (int j = 0; j < POINTS; ++j) {
    float phi = 6.2831853 * (float(sector) + (float(j) + 0.5) / float(POINTS)) / float(SECTORS);
    vec3 t = basis * vec3(cos(phi), sin(phi), 0.0);
    float edge = horizon(pole, t);
    float column = 0.0;
    for (int i = 0; i < POINTS; ++i) {
      float r = edge * mix(inner, outer, (float(i) + 0.5) / float(POINTS));
      column += sin(r) * pdfOf(b, c.wo, cos(r) * pole + sin(r) * t);
    }
    sum += edge * column;
  }
  return sum * (outer - inner) * 6.2831853 / float(SECTORS * POINTS * POINTS);
}
#endif
)";

// A cell: (side · RINGS + ring) · SECTORS + sector; or 2 · RINGS · SECTORS for a sample that is rejected, because it is below
// the horizon; plus 1 for a sample above it whose density is 0.
const std::string kDraw = kLobes + R"(
#define In Case
#define Out uint
Out run(uint index, In c) {
  Bsdf b = lobesOf(c);
  vec3 wi = sampleOf(b, c.wo, randomAt(index, 7u));
  if (pdfOf(b, c.wo, wi) > 0.0) return cellOf(c, b, wi, randomAt(index, 8u).xy);
  float height = LOBE == 4 ? min(wi.z, dot(wi, b.clearcoat.normal)) : LOBE == 3 ? abs(wi.z) : wi.z;
  return uint(2 * RINGS * SECTORS) + uint(LOBE != 2 && height > 1e-3);
}
)";

// The integral of the density over cell `index`.
const std::string kIntegrateCells = kLobes + R"(
#define In Case
#define Out float
Out run(uint index, In c) {
  return integralOf(c, lobesOf(c), int(index) / (RINGS * SECTORS), int(index) / SECTORS % RINGS, int(index) % SECTORS);
}
)";

struct Named {
  std::string name;
  int lobe;
  BsdfCase material;
};

std::string describe(const BsdfCase& c, float alpha) {
  char text[64];
  std::snprintf(text, sizeof text, ", alpha %g, cosine %g", static_cast<double>(alpha), static_cast<double>(c.wo.z));
  return text;
}

// The quadrature must resolve the streak of a narrow anisotropic lobe, and the horizon, which cuts its cells at grazing
// angles.
int pointsFor(const BsdfCase& c) {
  return c.anisotropy > 0.0f && (c.wo.z < 0.3f || c.alpha < 0.02f) ? 4 * kPoints : kPoints;
}

class BsdfSampling : public BsdfTest {
 protected:
  // Compares counted and integrated density in all cells; one more cell counts rejected samples.
  static ChiSquare test(const Named& named, bool wrong = false) {
    const float narrowest = named.lobe == 4 ? named.material.clearcoatAlpha : named.material.alpha;
    Defines defines = {{"LOBE", std::to_string(named.lobe)},
                       {"FIRST", std::to_string(std::max(0.02f * narrowest, 2e-5f))},
                       {"RINGS", std::to_string(kRings)},
                       {"SECTORS", std::to_string(kSectors)},
                       {"POINTS", std::to_string(pointsFor(named.material))}};
    if (wrong) defines.emplace_back("WRONG", "1");
    const auto integrals = runCases<float>(kIntegrateCells, {named.material}, 2 * kRings * kSectors, defines);
    const auto draws = runCases<std::uint32_t>(kDraw, {named.material}, kDraws, defines);

    std::vector<double> observed(integrals.size() + 2, 0.0);
    for (const std::uint32_t cell : draws) observed.at(cell) += 1.0;
    EXPECT_EQ(observed.back(), 0.0) << named.name << ": samples with the density 0";
    observed.pop_back();
    const double integral = std::accumulate(integrals.begin(), integrals.end(), 0.0);
    const double accepted = 1.0 - observed.back() / kDraws;
    EXPECT_LE(integral, 1.0 + 2e-3) << named.name;
    EXPECT_TRUE(wrong || std::abs(integral - accepted) < 5e-3)
        << named.name << ": " << integral << ", accepted " << accepted;

    std::vector<double> expected(integrals.begin(), integrals.end());
    // If no sample was rejected, the quadrature's error must not count as an expectation.
    expected.push_back(observed.back() == 0.0 ? 0.0 : std::max(1.0 - integral, 0.0));
    for (double& e : expected) e *= kDraws;
    return chiSquareTest(observed, expected);
  }
};

// Returns true if the cells of mixtures are fine enough. For the other cases, mixing_test.cpp and the tests of single
// lobes apply. A narrow clearcoat has its peak away from the pole, around its own normal. At the most grazing angle the
// horizon is too near for narrow lobes and for refraction.
bool cellsFit(const BsdfCase& c) {
  const bool solid = c.transmission > 0.0f && !c.thin;
  const float coat = c.clearcoat > 0.0f ? c.clearcoatAlpha : 1.0f;
  if (c.ior == 1.15f) return false;
  if (c.wo.z < 0.05f) return std::min(c.alpha, coat) >= 0.1f && !solid;
  return c.alpha >= 0.003f && coat >= 0.02f;
}

std::vector<Named> lobeCases() {
  std::vector<Named> cases;
  for (const float cosine : kCosines) {
    BsdfCase base;
    base.wo = directionAt(cosine);
    cases.push_back({"diffuse" + describe(base, base.alpha), 0, base});
    cases.push_back({"sheen" + describe(base, base.alpha), 6, base});
    for (const float alpha : kRoughAlphas) {
      BsdfCase c = base;
      c.alpha = alpha;
      const std::string where = describe(c, alpha);
      cases.push_back({"specular" + where, 1, c});
      c.transmission = 1.0f;
      c.thin = 1;
      cases.push_back({"thin" + where, 2, c});
      c.thin = 0;
      // Half vectors of the narrowest lobe at the most grazing angle have too few digits for the outermost cells.
      for (const float ior : {1.15f, 1.5f, 2.4f}) {
        if (alpha < 0.003f && cosine < 0.05f) continue;
        c.ior = ior;
        for (const bool outside : {true, false}) {
          c.entering = outside;
          cases.push_back({"dielectric " + std::to_string(ior) + (outside ? " outside" : " inside") + where, 3, c});
        }
      }
      c = base;
      c.alpha = alpha, c.anisotropy = 0.7f;
      cases.push_back({"anisotropic specular" + where, 1, c});
      c.transmission = 1.0f, c.thin = 1;
      cases.push_back({"anisotropic thin" + where, 2, c});
      c.thin = 0;
      if (alpha >= 0.003f || cosine >= 0.05f) cases.push_back({"anisotropic dielectric" + where, 3, c});
      c = base;
      c.clearcoat = 1.0f;
      c.clearcoatAlpha = alpha;
      c.clearcoatNormal = glm::normalize(vec3(0.1f, -0.05f, 1.0f));
      cases.push_back({"clearcoat" + where, 4, c});
      for (const NamedCase& named : materialsAt(alpha, base.wo))
        if (cellsFit(named.material)) cases.push_back({named.name, 5, named.material});
      c = base;
      c.alpha = alpha, c.transmission = 1.0f, c.ior = 0.0f, c.specular = 0.7f;  // a rough lobe and a delta
      if (cellsFit(c)) cases.push_back({"glass of ior 0" + where, 5, c});
    }
  }
  return cases;
}

// Tests all cases of one lobe. The significance level holds for the tests of all lobes together.
template <class Test>
void expectFollowsThePdf(int lobe, const Test& test) {
  const std::vector<Named> cases = lobeCases();
  const double level = sidak(0.01, cases.size());
  for (const Named& named : cases) {
    if (named.lobe != lobe) continue;
    const ChiSquare result = test(named);
    EXPECT_GE(result.pValue, level) << named.name << ": chi-square " << result.statistic << " with " << result.freedom
                                    << " degrees";
  }
}

TEST_F(BsdfSampling, DiffuseFollowsThePdf) {
  expectFollowsThePdf(0, [](const Named& n) { return test(n); });
}
TEST_F(BsdfSampling, SpecularFollowsThePdf) {
  expectFollowsThePdf(1, [](const Named& n) { return test(n); });
}
TEST_F(BsdfSampling, ThinFollowsThePdf) {
  expectFollowsThePdf(2, [](const Named& n) { return test(n); });
}
TEST_F(BsdfSampling, DielectricFollowsThePdf) {
  expectFollowsThePdf(3, [](const Named& n) { return test(n); });
}
TEST_F(BsdfSampling, ClearcoatFollowsThePdf) {
  expectFollowsThePdf(4, [](const Named& n) { return test(n); });
}
TEST_F(BsdfSampling, SheenFollowsThePdf) {
  expectFollowsThePdf(6, [](const Named& n) { return test(n); });
}
TEST_F(BsdfSampling, MixturesFollowThePdf) {
  expectFollowsThePdf(5, [](const Named& n) { return test(n); });
}

// cos^2 has the distribution ln(1 + x / a^2) / ln(1 + 1 / a^2), a^2 = 2 alpha^2.
TEST_F(BsdfSampling, MultipleScatteringFollowsItsPdf) {
  struct Out {
    vec3 wi;
    float pdf;
  };
  const std::string body = kBsdfPrelude + R"(
    struct Out_ { vec3 wi; float pdf; };
    #define In float
    #define Out Out_
    Out run(uint index, In alpha) {
      vec3 wi = multipleSample(vec2(alpha), randomAt(index, 13u).xy);
      return Out(wi, multiplePdf(wi, vec2(alpha)));
    }
  )";
  for (const float alpha : kRoughAlphas) {
    const double a2 = 2.0 * double{alpha} * alpha, scale = std::log1p(1.0 / a2);
    std::vector<double> observed(16 * 16, 0.0);
    for (const Out& out : runQueries<Out>(body, std::vector<float>(kDraws, alpha))) {
      const double z = out.wi.z;
      ASSERT_NEAR(out.pdf, z / (std::numbers::pi * (z * z + a2) * scale), 1e-4 * out.pdf);
      ASSERT_NEAR(glm::length(out.wi), 1.0f, 1e-5f);
      const double turn = std::atan2(out.wi.y, out.wi.x) / (2.0 * std::numbers::pi) + 0.5;
      const auto cell = [](double x) { return static_cast<std::size_t>(std::clamp(16.0 * x, 0.0, 15.0)); };
      observed[16 * cell(std::log1p(z * z / a2) / scale) + cell(turn)] += 1.0;
    }
    const ChiSquare result = chiSquareTest(observed, std::vector<double>(256, kDraws / 256.0));
    EXPECT_GE(result.pValue, sidak(0.01, kRoughAlphas.size())) << alpha;
  }
}

// The test fails for a uniform diffuse pdf, for the pdf of unbounded visible normals, for a Jacobian without eta², and
// for lobe probabilities that are off by a tenth.
TEST_F(BsdfSampling, FindsAWrongPdf) {
  BsdfCase c;
  c.wo = directionAt(0.6f);
  c.alpha = 0.5f;
  for (const int lobe : {0, 1, 3, 5}) {
    c.transmission = lobe == 3 ? 1.0f : 0.0f;
    c.clearcoat = lobe == 5 ? 1.0f : 0.0f;
    EXPECT_LT(test({"wrong", lobe, c}, true).pValue, 1e-6) << "lobe " << lobe;
  }
}

}  // namespace
}  // namespace quintet::test

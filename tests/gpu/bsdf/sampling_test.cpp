// Each lobe, and the mixture, draws directions with the density that its pdf states: a chi-square test of
// counted against integrated density. The cells of each hemisphere are rings and sectors around the direction
// where the density is narrowest, with radii in geometric progression up to the horizon: they fit mirrors
// as well as diffuse lobes.
#include <gtest/gtest.h>

#include "bsdf/bsdf_cases.h"
#include "bsdf/chi_square.h"

namespace quintet::test {
namespace {

constexpr int kRings = 24;
constexpr int kSectors = 16;
constexpr int kPoints = 32;  // per cell and axis of the quadrature
constexpr std::size_t kSamples = 120'000;

// LOBE: 0 diffuse, 1 specular, 2 thin, 3 dielectric, 4 clearcoat, 5 all. WRONG: a mistake to be found.
const std::string kLobes = kBsdfPrelude + R"(
float pdfOf(Bsdf b, vec3 wo, vec3 wi) {
#if defined(WRONG) && LOBE == 0
  return wi.z > 0.0 ? 0.5 / kPi : 0.0;
#elif defined(WRONG) && LOBE == 1
  vec3 h = normalize(wo + wi);
  return wi.z > 0.0 ? ggxReflectionPdf(ggxDistribution(h.z * h.z, dot(h.xy, h.xy), b.specular.alpha), wo.z, b.specular.alpha, 1.0) : 0.0;
#elif defined(WRONG) && LOBE == 3
  return dielectricPdf(b.dielectric, wo, wi) / (wi.z < 0.0 ? b.dielectric.eta * b.dielectric.eta : 1.0);
#elif LOBE == 0
  return diffusePdf(wi);
#elif LOBE == 1
  return specularPdf(b.specular, wo, wi);
#elif LOBE == 2
  return thinPdf(b.thin, wo, wi);
#elif LOBE == 3
  return dielectricPdf(b.dielectric, wo, wi);
#elif LOBE == 4
  return clearcoatPdf(b.clearcoat, wo, wi);
#elif defined(WRONG)
  b.chance = mix(b.chance, b.chance.zyxw, 0.1);
  return bsdfPdf(b, wo, wi);
#else
  return bsdfPdf(b, wo, wi);
#endif
}
vec3 sampleOf(Bsdf b, vec3 wo, vec3 u) {
#if LOBE == 0
  return diffuseSample(u.xy);
#elif LOBE == 1
  return specularSample(wo, ggxSample(wo, b.specular.alpha, ggxBound(wo.z, b.specular.alpha), u.xy));
#elif LOBE == 2
  return thinSample(wo, ggxSample(wo, b.thin.alpha, ggxBound(wo.z, b.thin.alpha), u.xy));
#elif LOBE == 3
  vec3 m = ggxSample(wo, b.dielectric.alpha, 1.0, u.xy);
  vec3 wi = dielectricSample(b.dielectric, wo, m, u.z);
  return dot(wi, m) * wi.z > 0.0 ? wi : vec3(0.0);
#elif LOBE == 4
  mat3 basis = localFrame(b.clearcoat.normal);
  vec3 o = wo * basis;
  return specularSample(wo, basis * ggxSample(o, b.clearcoat.alpha, ggxBound(o.z, b.clearcoat.alpha), u.xy));
#else
  BsdfSample s;
  return bsdfSample(b, wo, u.z, u.xy, s) ? s.wi : vec3(0.0);
#endif
}
// Where the density of a hemisphere is narrowest, inside the hemisphere.
vec3 poleOf(Case c, Bsdf b, bool below) {
  vec3 pole = reflect(-c.wo, LOBE == 4 ? c.clearcoatNormal : vec3(0.0, 0.0, 1.0));
  if (below) {
    pole = refract(-c.wo, vec3(0.0, 0.0, 1.0), b.refractive ? 1.0 / b.dielectric.eta : 1.0);
    if (dot(pole, pole) == 0.0) pole = vec3(pole.xy, -0.05);
  }
  pole.z = below ? min(pole.z, -0.02) : max(pole.z, 0.02);
  return normalize(pole);
}
// The angle from the pole to the horizon, for the azimuth of the unit vector t across the pole.
float horizon(vec3 pole, vec3 t) { return atan(abs(pole.z), pole.z > 0.0 ? -t.z : t.z); }
)";

// A cell: (side · RINGS + ring) · SECTORS + sector. Radii are relative to that of the horizon.
const std::string kDraw = kLobes + R"(
#define In Case
#define Out uint
Out run(uint index, In c) {
  Bsdf b = makeBsdfOf(c);
  vec3 wi = sampleOf(b, c.wo, randomAt(index, 7u));
  if (pdfOf(b, c.wo, wi) <= 0.0) return uint(2 * RINGS * SECTORS);
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
)";

// The integral of the density over cell `index`.
const std::string kIntegrate = kLobes + R"(
#define In Case
#define Out float
Out run(uint index, In c) {
  Bsdf b = makeBsdfOf(c);
  int sector = int(index) % SECTORS;
  int ring = int(index) / SECTORS % RINGS;
  vec3 pole = poleOf(c, b, int(index) >= RINGS * SECTORS);
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
)";

struct Named {
  std::string name;
  int lobe;
  BsdfCase material;
};

class BsdfSampling : public BsdfTest {
 protected:
  // Compares counted and integrated density in all cells, and in one for what is rejected.
  static ChiSquare test(const Named& named, bool wrong = false) {
    const float narrowest = named.lobe == 4 ? named.material.clearcoatAlpha : named.material.alpha;
    Defines defines = {{"LOBE", std::to_string(named.lobe)}, {"FIRST", std::to_string(std::max(0.02f * narrowest, 2e-5f))},
                       {"RINGS", std::to_string(kRings)}, {"SECTORS", std::to_string(kSectors)},
                       {"POINTS", std::to_string(kPoints)}};
    if (wrong) defines.emplace_back("WRONG", "1");
    const auto integrals = runCases<float>(kIntegrate, {named.material}, 2 * kRings * kSectors, defines);
    const auto draws = runCases<std::uint32_t>(kDraw, {named.material}, kSamples, defines);

    std::vector<double> observed(integrals.size() + 1, 0.0);
    for (const std::uint32_t cell : draws) observed.at(cell) += 1.0;
    const double integral = std::accumulate(integrals.begin(), integrals.end(), 0.0);
    const double accepted = 1.0 - observed.back() / kSamples;
    EXPECT_LE(integral, 1.0 + 2e-3) << named.name;
    EXPECT_TRUE(wrong || std::abs(integral - accepted) < 5e-3) << named.name << ": " << integral << ", accepted " << accepted;

    std::vector<double> expected(integrals.begin(), integrals.end());
    // Where nothing is rejected, the quadrature's own error is no expectation.
    expected.push_back(observed.back() == 0.0 ? 0.0 : std::max(1.0 - integral, 0.0));
    for (double& e : expected) e *= kSamples;
    return chiSquareTest(observed, expected);
  }
};

std::vector<Named> lobeCases() {
  std::vector<Named> cases;
  for (const float cosine : {1.0f, 0.75f, 0.3f, 0.05f}) {
    BsdfCase base;
    base.wo = directionAt(cosine);
    cases.push_back({"diffuse", 0, base});
    for (const float alpha : {0.001f, 0.02f, 0.1f, 0.4f, 1.0f}) {
      BsdfCase c = base;
      c.alpha = alpha;
      cases.push_back({"specular", 1, c});
      c.transmission = 1.0f;
      c.thin = 1;
      cases.push_back({"thin", 2, c});
      c.thin = 0;
      cases.push_back({"dielectric outside", 3, c});
      c.entering = 0;
      cases.push_back({"dielectric inside", 3, c});
      c = base;
      c.clearcoat = 1.0f;
      c.clearcoatAlpha = alpha;
      c.clearcoatNormal = glm::normalize(vec3(0.1f, -0.05f, 1.0f));
      cases.push_back({"clearcoat", 4, c});

      BsdfCase mix = base;
      mix.alpha = alpha;
      mix.baseColor = {0.9f, 0.5f, 0.2f};
      mix.metallic = 0.3f;
      mix.transmission = 0.5f;
      mix.clearcoat = 0.8f;
      mix.clearcoatAlpha = 0.2f;
      mix.clearcoatNormal = glm::normalize(vec3(0.1f, -0.05f, 1.0f));
      cases.push_back({"mixture, solid", 5, mix});
      mix.thin = 1;
      cases.push_back({"mixture, thin", 5, mix});
      mix.transmission = 0.0f;
      cases.push_back({"mixture, opaque", 5, mix});
    }
  }
  for (Named& named : cases) {
    char text[64];
    std::snprintf(text, sizeof text, ", alpha %g, cosine %.2g", named.lobe == 4 ? named.material.clearcoatAlpha : named.material.alpha,
                  static_cast<double>(named.material.wo.z));
    named.name += text;
  }
  return cases;
}

TEST_F(BsdfSampling, FollowsThePdf) {
  const std::vector<Named> cases = lobeCases();
  const double level = sidak(0.01, cases.size());
  for (const Named& named : cases) {
    const ChiSquare result = test(named);
    EXPECT_GE(result.pValue, level) << named.name << ": chi-square " << result.statistic << " with " << result.freedom << " degrees";
  }
}

// The test can fail: a uniform diffuse pdf, the pdf of unbounded visible normals, a Jacobian without eta²,
// mixture weights off by a tenth.
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

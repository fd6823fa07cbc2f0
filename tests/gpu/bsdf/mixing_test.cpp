// SPDX-License-Identifier: Apache-2.0
// The BSDF is the sum of its lobes: its density is their weighted sum, and the number of samples from each lobe follows
// the lobe's probability. The direction of a sample identifies the part of the BSDF that it comes from, because each
// part maps the same numbers u to a different direction. Tested at every roughness and angle.
#include <gtest/gtest.h>

#include "bsdf/bsdf_cases.h"

namespace quintet::test {
namespace {

const std::string kMixing = kBsdfPrelude + R"(
  // Clearcoat, specular and its multiple scattering, diffuse, transmission and the thin wall's multiple scattering; then
  // two parts for lobes that are added to the list.
  const int kParts = 8;
  struct Out_ { float mixed; float sum; float probabilities; float distance; uint part; float expected[kParts]; };
  #define In Case
  #define Out Out_
  void nearer(vec3 wi, vec3 candidate, uint part, inout Out o) {
    if (distance(wi, candidate) >= o.distance) return;
    o.distance = distance(wi, candidate);
    o.part = part;
  }
  Out run(uint index, In c) {
    Bsdf b = makeBsdfOf(c);
    BsdfSample s;
    vec3 u = randomAt(index, 11u);
    bool valid = bsdfSample(b, c.wo, u.z, u.xy, s);
    DielectricLobe dielectric = b.transmission.dielectric;
    float specular = b.specular.multipleProbability;
    float thin = b.transmission.refractive ? 0.0 : b.transmission.thin.multipleProbability;
    float pSpecular = b.lobeProbability[kLobeSpecular], pTransmission = b.lobeProbability[kLobeTransmission];
    Out o = Out(0.0, 0.0, 0.0, 1e30, 0u,
                float[](b.lobeProbability[kLobeClearcoat], pSpecular * (1.0 - specular), pSpecular * specular,
                        b.lobeProbability[kLobeDiffuse], pTransmission * (1.0 - thin), pTransmission * thin, 0.0, 0.0));
    for (int i = 0; i < kLobeCount; ++i) o.probabilities += b.lobeProbability[i];

    mat3 basis = localFrame(b.clearcoat.normal);
    vec3 local = c.wo * basis;
    vec3 m = ggxSample(c.wo, b.specular.alpha, ggxBound(c.wo, b.specular.alpha), u.xy);
    vec3 mCoat = basis * ggxSample(local, b.clearcoat.alpha, ggxBound(local.z, b.clearcoat.alpha), u.xy);
    nearer(s.wi, clearcoatSample(b.clearcoat, c.wo, mCoat), 0u, o);
    nearer(s.wi, reflect(-c.wo, m), 1u, o);
    nearer(s.wi, multipleSample(b.specular.alpha, u.xy), 2u, o);
    nearer(s.wi, diffuseSample(u.xy), 3u, o);
    for (int i = kLobeTransmission + 1; i < kLobeCount; ++i) {
      o.expected[6 + i - kLobeTransmission - 1] = b.lobeProbability[i];
      nearer(s.wi, lobeSample(b, i, c.wo, m, u.z, u.xy), uint(6 + i - kLobeTransmission - 1), o);
    }
    if (b.transmission.refractive) {  // reflection by a solid has the direction of the specular lobe: one part
      m = ggxSample(c.wo, dielectric.alpha, 1.0, u.xy);
      float reflected = pTransmission * dielectricSplit(dielectric, dot(c.wo, m)).reflectProbability;
      o.expected[1] += reflected;
      o.expected[4] -= reflected;
      nearer(s.wi, reflect(-c.wo, m), 1u, o);
      nearer(s.wi, refract(-c.wo, m, 1.0 / dielectric.eta), 4u, o);
    } else {
      nearer(s.wi, thinSample(b.transmission.thin, c.wo, m, 1.0, u.xy), 4u, o);
      nearer(s.wi, thinSample(b.transmission.thin, c.wo, m, -1.0, u.xy), 5u, o);
    }

    vec3 wi = valid && index % 4u != 0u ? s.wi : uniformDirection(randomAt(index, 12u).xy);
    o.sum = b.lobeProbability[kLobeDiffuse] * diffusePdf(wi);
    if (pSpecular > 0.0) o.sum += pSpecular * specularPdf(b.specular, c.wo, wi);
    if (b.clearcoat.weight > 0.0) o.sum += b.lobeProbability[kLobeClearcoat] * clearcoatPdf(b.clearcoat, c.wo, wi);
    if (pTransmission > 0.0 && b.transmission.refractive) o.sum += pTransmission * dielectricPdf(dielectric, c.wo, wi);
    if (pTransmission > 0.0 && !b.transmission.refractive)
      o.sum += pTransmission * thinPdf(b.transmission.thin, c.wo, wi);
    float pdf[kLobeCount];
    lobePdfs(b, c.wo, wi, pdf);
    for (int i = kLobeTransmission + 1; i < kLobeCount; ++i) o.sum += b.lobeProbability[i] * pdf[i];
    o.mixed = bsdfPdf(b, c.wo, wi);
    return o;
  }
)";

// Counts an event in trials of different probabilities, and sums the expected count.
struct Tally {
  double count = 0.0, expected = 0.0, variance = 0.0;
  void add(bool happened, double probability) {
    count += happened, expected += probability, variance += probability * (1.0 - probability);
  }
  // Returns the bound that |count - expected| exceeds with a probability below `level` (Bernstein's inequality).
  double bound(double level) const {
    const double l = std::log(2.0 / level);
    return l / 3.0 + std::sqrt(l * l / 9.0 + 2.0 * variance * l);
  }
};

using BsdfMixing = BsdfTest;

TEST_F(BsdfMixing, LobesFollowTheirProbabilities) {
  constexpr std::size_t kParts = 8;
  struct Out {
    float mixed;
    float sum;
    float probabilities;
    float distance;
    std::uint32_t part;
    float expected[kParts];
  };
  std::vector<NamedCase> named;
  std::vector<BsdfCase> cases;
  for (const float alpha : kRoughAlphas)
    for (const float cosine : kCosines)
      for (const NamedCase& one : materialsAt(alpha, directionAt(cosine))) {
        named.push_back(one);
        cases.push_back(one.material);
      }
  std::size_t positive = 0, index = 0;
  std::vector<Tally> tallies(cases.size() * kParts), all(kParts);
  for (const Out& out : runCases<Out>(kMixing, cases, cases.size() * 2000)) {
    ASSERT_NEAR(out.probabilities, 1.0f, 1e-5f);
    ASSERT_LE(std::abs(out.mixed - out.sum), 1e-4f * out.sum);
    positive += out.mixed > 0.0f;
    ASSERT_LT(out.distance, 2e-3f) << "no lobe has this direction: " << named[index % cases.size()].name;
    for (std::size_t part = 0; part < kParts; ++part) {
      tallies[index % cases.size() * kParts + part].add(out.part == part, double{out.expected[part]});
      all[part].add(out.part == part, double{out.expected[part]});
    }
    ++index;
  }
  EXPECT_GT(positive, cases.size() * 1600);
  for (std::size_t i = 0; i < tallies.size(); ++i) {
    const Tally& t = tallies[i];
    EXPECT_LE(std::abs(t.count - t.expected), t.bound(0.01 / static_cast<double>(tallies.size())))
        << named[i / kParts].name << ", part " << i % kParts << ": " << t.count << " samples of " << t.expected;
  }
  for (std::size_t part = 0; part < kParts; ++part) {
    EXPECT_LE(std::abs(all[part].count - all[part].expected), all[part].bound(0.01 / kParts))
        << "part " << part << ": " << all[part].count << " samples of " << all[part].expected;
    if (all[part].expected > 0.0 || part < 6) {
      EXPECT_GT(all[part].count, 1000.0);
    }
  }
}

}  // namespace
}  // namespace quintet::test

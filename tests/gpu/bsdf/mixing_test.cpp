// The mixture is what its lobes and the chances of drawing them say: the density is their sum, and as many samples
// come from each part as its chance says. The part that a sample comes from is told by its direction: each part's own
// function makes another one of the same numbers u. At every roughness and angle.
#include <gtest/gtest.h>

#include "bsdf/bsdf_cases.h"

namespace quintet::test {
namespace {

const std::string kMixing = kBsdfPrelude + R"(
  // Coat, specular and its multiple scattering, diffuse, transmission and the thin wall's multiple scattering.
  const int kParts = 6;
  struct Out_ { float mixed; float sum; float chances; float distance; uint part; float expected[kParts]; };
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
    float specular = b.specular.multipleChance, thin = b.refractive ? 0.0 : b.thin.multipleChance;
    Out o = Out(0.0, 0.0, b.chance.x + b.chance.y + b.chance.z + b.chance.w, 1e30, 0u,
                float[](b.chance.x, b.chance.y * (1.0 - specular), b.chance.y * specular, b.chance.z,
                        b.chance.w * (1.0 - thin), b.chance.w * thin));

    mat3 basis = localFrame(b.clearcoat.normal);
    vec3 local = c.wo * basis;
    vec3 m = ggxSample(c.wo, b.specular.alpha, ggxBound(c.wo.z, b.specular.alpha), u.xy);
    vec3 mCoat = basis * ggxSample(local, b.clearcoat.alpha, ggxBound(local.z, b.clearcoat.alpha), u.xy);
    nearer(s.wi, clearcoatSample(b.clearcoat, c.wo, mCoat), 0u, o);
    nearer(s.wi, reflect(-c.wo, m), 1u, o);
    nearer(s.wi, multipleSample(b.specular.alpha, u.xy), 2u, o);
    nearer(s.wi, diffuseSample(u.xy), 3u, o);
    if (b.refractive) {  // what a solid reflects goes where the specular lobe does: one part
      m = ggxSample(c.wo, b.dielectric.alpha, 1.0, u.xy);
      float reflected = b.chance.w * dielectricSplit(b.dielectric, dot(c.wo, m)).reflectChance;
      o.expected[1] += reflected;
      o.expected[4] -= reflected;
      nearer(s.wi, reflect(-c.wo, m), 1u, o);
      nearer(s.wi, refract(-c.wo, m, 1.0 / b.dielectric.eta), 4u, o);
    } else {
      nearer(s.wi, thinSample(b.thin, c.wo, m, 1.0, u.xy), 4u, o);
      nearer(s.wi, thinSample(b.thin, c.wo, m, -1.0, u.xy), 5u, o);
    }

    vec3 wi = valid && index % 4u != 0u ? s.wi : uniformDirection(randomAt(index, 12u).xy);
    o.sum = b.chance.z * diffusePdf(wi);
    if (b.chance.y > 0.0) o.sum += b.chance.y * specularPdf(b.specular, c.wo, wi);
    if (b.clearcoat.weight > 0.0) o.sum += b.chance.x * clearcoatPdf(b.clearcoat, c.wo, wi);
    if (b.chance.w > 0.0 && b.refractive) o.sum += b.chance.w * dielectricPdf(b.dielectric, c.wo, wi);
    if (b.chance.w > 0.0 && !b.refractive) o.sum += b.chance.w * thinPdf(b.thin, c.wo, wi);
    o.mixed = bsdfPdf(b, c.wo, wi);
    return o;
  }
)";

// How often something happened, and how often it should have: trials of different chances.
struct Tally {
  double count = 0.0, expected = 0.0, variance = 0.0;
  void add(bool happened, double chance) { count += happened, expected += chance, variance += chance * (1.0 - chance); }
  // What |count - expected| exceeds with a probability below `level` (Bernstein's inequality).
  double bound(double level) const {
    const double l = std::log(2.0 / level);
    return l / 3.0 + std::sqrt(l * l / 9.0 + 2.0 * variance * l);
  }
};

using BsdfMixing = BsdfTest;

TEST_F(BsdfMixing, LobesAreDrawnByTheirChances) {
  constexpr std::size_t kParts = 6;
  struct Out {
    float mixed;
    float sum;
    float chances;
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
    ASSERT_NEAR(out.chances, 1.0f, 1e-5f);
    ASSERT_LE(std::abs(out.mixed - out.sum), 1e-4f * out.sum);
    positive += out.mixed > 0.0f;
    ASSERT_LT(out.distance, 2e-3f) << "made by no lobe: " << named[index % cases.size()].name;
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
    EXPECT_GT(all[part].count, 1000.0);
  }
}

}  // namespace
}  // namespace quintet::test

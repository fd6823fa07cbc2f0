// SPDX-License-Identifier: Apache-2.0
// Dispersion: the indices of the channels, and the mean over the channels of what a path transmits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bsdf/bsdf_cases.h"

namespace quintet::test {
namespace {

struct DispersionQuery {
  vec3 wo;
  float alpha;
  float dispersion;
  std::uint32_t channel;
  std::uint32_t entering;
  std::uint32_t thin;
};
struct DispersionAnswer {
  vec3 above;  // f |cos| of a direction on the same side, and below
  vec3 below;
  vec3 weight;  // of a sample
  vec3 wi;
  std::uint32_t transmitted;
  std::uint32_t channel;  // behind the surface
  float ior;
};

const std::string kDisperse = kBsdfPrelude + R"(
#include <quintet/bsdf/dispersion.glsl>
struct Query { vec3 wo; float alpha; float dispersion; uint channel; uint entering; uint thin; };
struct Answer { vec3 above; vec3 below; vec3 weight; vec3 wi; uint transmitted; uint channel; float ior; };
#define In Query
#define Out Answer
Out run(uint index, In q) {
  BsdfParameters p = BsdfParameters(vec3(0.8, 0.6, 0.4), 0.0, q.alpha, 0.7, 1.5, q.entering != 0u, q.thin != 0u, 1.0, vec3(1.0),
                                    0.0, 0.01, vec3(0.0, 0.0, 1.0), vec3(0.0), 0.25, 0.4, vec3(0.5), 0.0, 0.0, 1.3, 400.0,
                                    q.dispersion, vec3(1.0));
  disperse(p, q.channel);
  Bsdf b = makeBsdf(p, q.wo);
  BsdfSample s;
  s.weight = s.wi = vec3(0.0);
  vec3 u = randomAt(index, 41u);
  bool valid = bsdfSample(b, q.wo, u.z, u.xy, s);
  return Out(bsdfEval(b, q.wo, normalize(vec3(0.3, -0.2, 0.8))), bsdfEval(b, q.wo, normalize(vec3(-0.4, -0.1, -0.9))),
             valid ? s.weight : vec3(0.0), s.wi, uint(valid && s.transmitted), channelBehind(p, q.channel), p.ior);
}
)";

constexpr std::uint32_t kOnly = 4;  // kChannelOnly

class BsdfDispersion : public BsdfTest {
 protected:
  static DispersionAnswer ask(const DispersionQuery& q) {
    return runQueries<DispersionAnswer>(kDisperse, std::vector<DispersionQuery>{q})[0];
  }
};

// Abbe number 55 at ior 1.5: n_F - n_C = 0.5 / 55.
TEST_F(BsdfDispersion, IndicesFollowTheAbbeNumber) {
  for (const float abbe : {55.0f, 150.0f}) {
    const auto index = [&](std::uint32_t channel) { return ask({{0, 0, 1}, 0.2f, 20.0f / abbe, channel, 1, 0}).ior; };
    EXPECT_NEAR(index(1), 1.5f, 1e-6f);
    EXPECT_NEAR(index(2) - index(0), 0.5f / abbe, 1e-6f);
    EXPECT_NEAR(index(2) + index(0), 3.0f, 1e-6f);
    EXPECT_EQ(index(2), index(2 | kOnly));
  }
}

TEST_F(BsdfDispersion, AffectsMaterialsThatTransmitLittle) {
  std::string body = kDisperse;
  body.replace(body.find("0.7, 1.5"), 3, "0.1");
  const std::vector<DispersionQuery> query{{{0, 0, 1}, 0.2f, 1.0f, 2, 1, 0}};
  EXPECT_NEAR(runQueries<DispersionAnswer>(body, query)[0].ior, 1.5f + 0.025f * 0.5f, 1e-6f);
}

TEST_F(BsdfDispersion, MeanOverTheChannelsIsUnbiased) {
  for (const std::uint32_t entering : {1u, 0u}) {
    vec3 above(0.0f), below(0.0f);
    for (std::uint32_t channel = 0; channel < 3; ++channel) {
      DispersionQuery q{directionAt(0.8f), 0.3f, 1.5f, channel, entering, 0};
      const DispersionAnswer open = ask(q);
      q.channel |= kOnly;
      const DispersionAnswer only = ask(q);
      EXPECT_EQ(open.above, only.above);
      EXPECT_EQ(open.channel, channel | kOnly);
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(open.below[k], static_cast<std::uint32_t>(k) == channel ? 3.0f * only.below[k] : 0.0f, 1e-6f);
      above += open.above / 3.0f;
      below[static_cast<int>(channel)] = only.below[static_cast<int>(channel)];
      EXPECT_GT(only.below[static_cast<int>(channel)], 0.01f);
    }
    const DispersionAnswer plain = ask({directionAt(0.8f), 0.3f, 0.0f, 0, entering, 0});
    EXPECT_EQ(plain.channel, 0u);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(above[k], plain.above[k], 0.03f * plain.above[k]);
      EXPECT_NEAR(below[k], plain.below[k], 0.2f * plain.below[k]);
    }
  }
}

// Snell's law with the index of the channel. Transmitted samples keep one channel, reflected ones all three.
TEST_F(BsdfDispersion, SmoothGlassRefractsEachChannel) {
  for (std::uint32_t channel = 0; channel < 3; ++channel) {
    const vec3 wo = directionAt(0.6f);
    const std::vector<DispersionQuery> queries(400, {wo, 0.0f, 2.0f, channel, 1, 0});
    std::size_t refracted = 0;
    for (const DispersionAnswer& a : runQueries<DispersionAnswer>(kDisperse, queries)) {
      const vec3 snell = glm::refract(-wo, vec3(0, 0, 1), 1.0f / a.ior);
      if (a.transmitted && glm::length(a.wi - snell) < 1e-5f) ++refracted;
      for (int k = 0; k < 3 && a.transmitted; ++k)
        EXPECT_EQ(a.weight[k] > 0.0f, static_cast<std::uint32_t>(k) == channel);
      if (!a.transmitted && a.weight.x > 0.0f) {
        EXPECT_GT(std::min({a.weight.x, a.weight.y, a.weight.z}), 0.0f);
      }
    }
    EXPECT_GT(refracted, 100u);
  }
}

TEST_F(BsdfDispersion, ThinWallsDoNotDisperse) {
  const DispersionAnswer thin = ask({directionAt(0.8f), 0.3f, 1.5f, 2, 1, 1}),
                         plain = ask({directionAt(0.8f), 0.3f, 0.0f, 2, 1, 1});
  EXPECT_EQ(thin.ior, 1.5f);
  EXPECT_EQ(thin.channel, 2u);
  EXPECT_EQ(thin.below, plain.below);
}

}  // namespace
}  // namespace quintet::test

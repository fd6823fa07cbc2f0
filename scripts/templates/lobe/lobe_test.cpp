// SPDX-License-Identifier: Apache-2.0
// The @WORDS@ lobe alone: energy, reciprocity, and the density of its samples. A lobe in the list of lobes.glsl needs a
// material in bsdf_cases.h, too: the other suites of this folder then test it together with all lobes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "bsdf/bsdf_cases.h"
#include "bsdf/chi_square.h"

namespace quintet::test {
namespace {

// The arguments of make@Name@, as the shader's struct Query below.
struct @Name@Query {
  vec3 wo;
  vec3 color;
};

class Bsdf@Name@ : public BsdfTest {
 protected:
  static constexpr std::size_t kDraws = 1 << 16;
  static constexpr std::size_t kRings = 32, kSectors = 16;  // cells of equal size on the sphere

  // The queries that all tests run.
  static std::vector<@Name@Query> queries() {
    std::vector<@Name@Query> result;
    for (const float cosine : kCosines)
      for (const vec3 color : {vec3(1.0f), vec3(0.9f, 0.5f, 0.2f)}) result.push_back({directionAt(cosine), color});
    return result;
  }

  // Runs `Out run(uint index, In q)` of `body` for index 0 … count-1.
  template <class Out>
  static std::vector<Out> run(const std::string& body, const @Name@Query& query, std::size_t count) {
    static const std::string kBegin = kBsdfPrelude + R"(
      #include <quintet/bsdf/@NAME@.glsl>
      struct Query { vec3 wo; vec3 color; };
      #define In Query
      const int kRings = 32, kSectors = 16;
      @Name@Lobe lobeOf(Query q, vec3 wo) {
        float albedo;
        return make@Name@(q.color, wo, albedo);
      }
    )";
    return runQueries<Out>(kBegin + body, std::vector<@Name@Query>(count, query));
  }
};

// In light of radiance 1 from all directions. Valid for reflection, and for transmission without refraction.
TEST_F(Bsdf@Name@, ReflectsNoMoreThanArrives) {
  const std::string body = R"(
    #define Out vec3
    Out run(uint index, In q) {
      @Name@Lobe lobe = lobeOf(q, q.wo);
      vec3 wi = @name@Sample(lobe, q.wo, randomAt(index, 1u).xy);
      float pdf = @name@Pdf(lobe, q.wo, wi);
      return pdf > 0.0 ? @name@Eval(lobe, q.wo, wi) / pdf : vec3(0.0);
    }
  )";
  for (const @Name@Query& query : queries()) {
    double sum = 0.0, squares = 0.0;
    for (const vec3& weight : run<vec3>(body, query, kDraws)) {
      const double largest = std::max({weight.x, weight.y, weight.z});
      ASSERT_TRUE(std::isfinite(largest) && std::min({weight.x, weight.y, weight.z}) >= 0.0f);
      sum += largest, squares += largest * largest;
    }
    const double n = kDraws, mean = sum / n;
    EXPECT_LE(mean, 1.0 + 4.0 * std::sqrt(std::max(squares / n - mean * mean, 0.0) / n) + 1e-5) << query.wo.z;
  }
}

TEST_F(Bsdf@Name@, IsReciprocal) {
  struct Out {
    vec3 forward, backward;
  };
  const std::string body = R"(
    struct Out_ { vec3 forward; vec3 backward; };
    #define Out Out_
    vec3 f(In q, vec3 wo, vec3 wi) { return @name@Eval(lobeOf(q, wo), wo, wi) / abs(wi.z); }
    Out run(uint index, In q) {
      vec3 wo = uniformDirection(randomAt(index, 2u).xy);
      vec3 wi = uniformDirection(randomAt(index, 3u).xy);
      wo.z = max(abs(wo.z), 0.01);
      wi.z = wi.z < 0.0 ? min(wi.z, -0.01) : max(wi.z, 0.01);
      wo = normalize(wo);
      wi = normalize(wi);
      if (wi.z > 0.0) return Out(f(q, wo, wi), f(q, wi, wo));
      const vec3 turn = vec3(1.0, 1.0, -1.0);  // seen from the other side, upside down
      return Out(f(q, wo, wi), f(q, wi * turn, wo * turn));
    }
  )";
  for (const @Name@Query& query : queries())
    for (const Out& out : run<Out>(body, query, kDraws))
      ASSERT_LE(glm::length(out.forward - out.backward), 2e-3f * glm::length(out.forward) + 1e-6f) << query.wo.z;
}

// The integral of the density over all directions is the fraction of samples that are not rejected: 1 if the lobe has no
// microfacets. A sample is rejected if its density is 0.
TEST_F(Bsdf@Name@, SamplesFollowThePdf) {
  const std::string draw = R"(
    #define Out uint
    Out run(uint index, In q) {
      @Name@Lobe lobe = lobeOf(q, q.wo);
      vec3 wi = @name@Sample(lobe, q.wo, randomAt(index, 4u).xy);
      if (!(@name@Pdf(lobe, q.wo, wi) > 0.0)) return uint(kRings * kSectors);
      int ring = clamp(int((0.5 + 0.5 * wi.z) * float(kRings)), 0, kRings - 1);
      int sector = clamp(int(fract(atan(wi.y, wi.x) / 6.2831853) * float(kSectors)), 0, kSectors - 1);
      return uint(ring * kSectors + sector);
    }
  )";
  const std::string integrate = R"(
    #define Out float
    Out run(uint index, In q) {
      const int kPoints = 32;
      @Name@Lobe lobe = lobeOf(q, q.wo);
      float sum = 0.0;
      for (int j = 0; j < kPoints; ++j)
        for (int i = 0; i < kPoints; ++i) {
          vec2 point = (vec2(i, j) + 0.5) / float(kPoints) + vec2(int(index) % kSectors, int(index) / kSectors);
          float z = 2.0 * point.y / float(kRings) - 1.0, phi = 6.2831853 * point.x / float(kSectors);
          sum += @name@Pdf(lobe, q.wo, vec3(sqrt(1.0 - z * z) * vec2(cos(phi), sin(phi)), z));
        }
      return sum * 12.5663706 / float(kRings * kSectors * kPoints * kPoints);
    }
  )";
  const std::vector<@Name@Query> all = queries();
  for (const @Name@Query& query : all) {
    std::vector<double> observed(kRings * kSectors + 1, 0.0), expected;
    for (const std::uint32_t cell : run<std::uint32_t>(draw, query, kDraws)) observed.at(cell) += 1.0;
    for (const float density : run<float>(integrate, query, kRings * kSectors)) expected.push_back(double{density});
    const double integral = std::accumulate(expected.begin(), expected.end(), 0.0);
    EXPECT_NEAR(integral, 1.0 - observed.back() / kDraws, 5e-3) << query.wo.z;
    expected.push_back(observed.back() == 0.0 ? 0.0 : std::max(1.0 - integral, 0.0));
    for (double& value : expected) value *= kDraws;
    EXPECT_GE(chiSquareTest(observed, expected).pValue, sidak(0.01, all.size())) << query.wo.z;
  }
}

// Otherwise, some directions are never sampled.
TEST_F(Bsdf@Name@, ThePdfIsPositiveWhereTheLobeIs) {
  const std::string body = R"(
    #define Out uint
    Out run(uint index, In q) {
      @Name@Lobe lobe = lobeOf(q, q.wo);
      vec3 wi = uniformDirection(randomAt(index, 5u).xy);
      vec3 value = @name@Eval(lobe, q.wo, wi);
      return uint(any(greaterThan(value, vec3(0.0))) && !(@name@Pdf(lobe, q.wo, wi) > 0.0));
    }
  )";
  for (const @Name@Query& query : queries())
    for (const std::uint32_t missed : run<std::uint32_t>(body, query, kDraws)) ASSERT_EQ(missed, 0u) << query.wo.z;
}

// Materials without the lobe stay as they are.
TEST_F(Bsdf@Name@, DoesNotExistWithoutColor) {
  const std::string body = R"(
    #define Out vec3
    Out run(uint index, In q) {
      float albedo;
      @Name@Lobe lobe = make@Name@(q.color, q.wo, albedo);
      return @name@Eval(lobe, q.wo, uniformDirection(randomAt(index, 6u).xy)) + albedo;
    }
  )";
  for (const vec3& value : run<vec3>(body, {directionAt(0.5f), vec3(0.0f)}, kDraws)) ASSERT_EQ(value, vec3(0.0f));
}

}  // namespace
}  // namespace quintet::test

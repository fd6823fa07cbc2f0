// SPDX-License-Identifier: Apache-2.0
// Materials and directions that the tests of quintet/bsdf share, and the GLSL that runs them.
#ifndef QUINTET_TESTS_GPU_BSDF_CASES_H
#define QUINTET_TESTS_GPU_BSDF_CASES_H

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gpu/buffer.h"
#include "harness.h"
#include "quintet/shared/frame.h"
#include "render/scene/albedo_tables.h"

namespace quintet::test {

// BsdfParameters and wo, as the shader's struct Case below. The default is a white, fully rough dielectric.
struct BsdfCase {
  vec3 wo{0.0f, 0.0f, 1.0f};
  float alpha = 1.0f;
  vec3 baseColor{1.0f};
  float metallic = 0.0f;
  float transmission = 0.0f;
  float ior = 1.5f;
  std::uint32_t entering = 1;
  std::uint32_t thin = 0;
  float specular = 1.0f;
  vec3 specularColor{1.0f};
  float clearcoat = 0.0f;
  float clearcoatAlpha = 0.01f;
  vec3 clearcoatNormal{0.0f, 0.0f, 1.0f};
  vec3 sheenColor{0.0f};
  float sheenAlpha = 0.25f;
  float diffuseTransmission = 0.0f;
  vec3 diffuseTransmissionColor{1.0f};
  float anisotropy = 0.0f;
  float iridescence = 0.0f;
  float iridescenceIor = 1.3f;
  float iridescenceThickness = 400.0f;
};

inline vec3 directionAt(float cosine, float azimuth = 0.7f) {
  const float sine = std::sqrt(1.0f - cosine * cosine);
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}

// From the narrowest lobe that is not a delta to the roughest; from normal incidence to grazing angles.
inline const std::vector<float> kRoughAlphas = {0.0005f, 0.003f, 0.02f, 0.1f, 0.4f, 1.0f};
inline const std::vector<float> kCosines = {1.0f, 0.75f, 0.3f, 0.05f, 0.001f};

struct NamedCase {
  std::string name;
  BsdfCase material;
  bool inReference = true;  // reference.cpp implements the lobes of this material
};

// Returns materials with one lobe each, as far as possible, and mixtures of all lobes; the width is `alpha`. A new lobe
// needs a case here: all suites of this folder run these materials.
inline std::vector<NamedCase> materialsAt(float alpha, const vec3& wo) {
  BsdfCase base;
  base.alpha = alpha;
  base.wo = wo;
  base.baseColor = {0.9f, 0.5f, 0.2f};
  std::vector<NamedCase> cases;
  const auto add = [&](const char* name, auto change) {
    cases.push_back({name, base});
    change(cases.back().material);
    char text[64];
    std::snprintf(text, sizeof text, ", alpha %g, cosine %g", static_cast<double>(alpha), static_cast<double>(wo.z));
    cases.back().name += text;
  };
  const auto coat = [](BsdfCase& c) {
    c.clearcoat = 0.8f, c.clearcoatAlpha = 0.2f;
    c.clearcoatNormal = glm::normalize(vec3(0.1f, -0.05f, 1.0f));
  };
  const auto mix = [&](BsdfCase& c) { c.metallic = 0.3f, c.transmission = 0.5f, c.specular = 0.7f, coat(c); };
  add("metal", [](BsdfCase& c) { c.metallic = 1.0f; });
  add("dielectric", [](BsdfCase&) {});
  add("dielectric, ior 2.4", [](BsdfCase& c) { c.ior = 2.4f, c.specularColor = {0.5f, 1.0f, 0.8f}; });
  add("thin wall", [](BsdfCase& c) { c.transmission = 1.0f, c.thin = 1; });
  for (const bool outside : {true, false}) {
    const auto glass = [&](BsdfCase& c) { c.transmission = 1.0f, c.entering = outside; };
    add(outside ? "glass outside" : "glass inside", glass);
    add(outside ? "glass 1.15 outside" : "glass 1.15 inside",
        [&](BsdfCase& c) { glass(c), c.ior = 1.15f, c.specular = 0.5f; });
    add(outside ? "mixture, solid outside" : "mixture, solid inside",
        [&](BsdfCase& c) { mix(c), c.entering = outside; });
  }
  add("coat", [&](BsdfCase& c) { coat(c), c.clearcoatAlpha = alpha, c.alpha = 0.3f; });
  add("sheen", [&](BsdfCase& c) { c.sheenColor = {0.9f, 0.6f, 0.3f}, c.sheenAlpha = alpha, c.alpha = 0.3f; });
  add("mixture with sheen", [&](BsdfCase& c) { mix(c), c.thin = 1, c.sheenColor = vec3(0.8f), c.sheenAlpha = 0.04f; });
  add("mixture with sheen, solid inside", [&](BsdfCase& c) { mix(c), c.entering = 0, c.sheenColor = vec3(0.8f); });
  add("diffuse transmission", [&](BsdfCase& c) {
    c.diffuseTransmission = 0.6f, c.diffuseTransmissionColor = {0.3f, 0.7f, 0.5f}, c.thin = 1;
  });
  add("mixture with diffuse transmission",
      [&](BsdfCase& c) { mix(c), c.thin = 1, c.diffuseTransmission = 0.7f, c.sheenColor = vec3(0.5f); });
  add("diffuse transmission, solid inside",
      [&](BsdfCase& c) { c.diffuseTransmission = 0.6f, c.entering = 0, c.sheenColor = vec3(0.8f), coat(c); });
  add("anisotropic metal", [](BsdfCase& c) { c.metallic = 1.0f, c.anisotropy = 0.9f; });
  add("anisotropic dielectric", [](BsdfCase& c) { c.anisotropy = 0.5f; });
  add("anisotropic thin wall", [](BsdfCase& c) { c.anisotropy = 0.6f, c.transmission = 1.0f, c.thin = 1; });
  add("anisotropic glass outside", [](BsdfCase& c) { c.anisotropy = 0.6f, c.transmission = 1.0f; });
  add("anisotropic glass inside", [](BsdfCase& c) { c.anisotropy = 0.6f, c.transmission = 1.0f, c.entering = 0; });
  add("anisotropic mixture", [&](BsdfCase& c) { mix(c), c.anisotropy = 0.7f, c.thin = 1, c.sheenColor = vec3(0.5f); });
  const auto film = [](BsdfCase& c, float thickness) { c.iridescence = 0.8f, c.iridescenceThickness = thickness; };
  add("film on metal", [&](BsdfCase& c) { film(c, 350.0f), c.metallic = 1.0f; });
  add("film on dielectric", [&](BsdfCase& c) { film(c, 500.0f), c.iridescenceIor = 1.8f; });
  add("film on a thin wall", [&](BsdfCase& c) { film(c, 250.0f), c.transmission = 1.0f, c.thin = 1; });
  for (const bool outside : {true, false})
    add(outside ? "film on glass outside" : "film on glass inside",
        [&](BsdfCase& c) { film(c, 300.0f), c.transmission = 1.0f, c.entering = outside; });
  add("mixture with film", [&](BsdfCase& c) { mix(c), film(c, 600.0f), c.thin = 1, c.sheenColor = vec3(0.5f); });
  add("mixture, thin", [&](BsdfCase& c) { mix(c), c.thin = 1; });
  add("mixture, opaque", [&](BsdfCase& c) { mix(c), c.transmission = 0.0f; });
  return cases;
}

// A sample of the BSDF, as the shader's struct Sample below.
struct BsdfSampleOut {
  vec3 wi;
  std::uint32_t valid;  // 0: rejected
  vec3 weight;
  float pdf;
  std::uint32_t delta;
  std::uint32_t transmitted;
};

// The frame with the albedo tables.
class BsdfFrame {
 public:
  BsdfFrame()
      : tables_(gpu::makeBufferOf(testContext(), render::computeAlbedoTables(), 0, "albedo tables")),
        frame_(gpu::makeBufferOf(testContext(), std::vector<shared::Frame>{makeFrame()}, 0, "frame")) {}
  VkDeviceAddress address() const { return frame_.address(); }

 private:
  shared::Frame makeFrame() const {
    shared::Frame frame{};
    frame.albedoTables = tables_.address();
    return frame;
  }
  gpu::Buffer tables_;
  gpu::Buffer frame_;
};

// The beginning of every shader.
inline const std::string kBsdfPrelude = R"(
#include <quintet/bsdf/bsdf.glsl>
struct Case {
  vec3 wo; float alpha; vec3 baseColor; float metallic; float transmission; float ior; uint entering; uint thin;
  float specular; vec3 specularColor; float clearcoat; float clearcoatAlpha; vec3 clearcoatNormal;
  vec3 sheenColor; float sheenAlpha;
  float diffuseTransmission; vec3 diffuseTransmissionColor;
  float anisotropy; float iridescence; float iridescenceIor; float iridescenceThickness;
};
struct Sample { vec3 wi; uint valid; vec3 weight; float pdf; uint delta; uint transmitted; };
Bsdf makeBsdfOf(Case c) {
  return makeBsdf(BsdfParameters(c.baseColor, c.metallic, c.alpha, c.transmission, c.ior, c.entering != 0u, c.thin != 0u,
                                 c.specular, c.specularColor, c.clearcoat, c.clearcoatAlpha, c.clearcoatNormal,
                                 c.sheenColor, c.sheenAlpha, c.diffuseTransmission, c.diffuseTransmissionColor,
                                 c.anisotropy, c.iridescence, c.iridescenceIor, c.iridescenceThickness, 0.0, vec3(1.0)), c.wo);
}
// Jarzynski and Olano 2020, "Hash Functions for GPU Rendering", listing "pcg3d"; 24 bits in [0,1).
vec3 randomAt(uint index, uint dimension) {
  uvec3 v = uvec3(index, dimension, 0x9E3779B9u) * 1664525u + 1013904223u;
  v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
  v ^= v >> 16u;
  v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
  return vec3(v >> 8u) / 16777216.0;
}
vec3 uniformDirection(vec2 u) {
  float z = 1.0 - 2.0 * u.x;
  float r = sqrt(max(1.0 - z * z, 0.0));
  return vec3(r * cos(6.2831853 * u.y), r * sin(6.2831853 * u.y), z);
}
)";

// bsdfSample run by run(index, case) → Sample.
inline const std::string kBsdfSampling = kBsdfPrelude + R"(
#define In Case
#define Out Sample
Out run(uint index, In c) {
  BsdfSample s;
  vec3 u = randomAt(index, 1u);
  bool valid = bsdfSample(makeBsdfOf(c), c.wo, u.z, u.xy, s);
  return Out(s.wi, uint(valid), s.weight, s.pdf, uint(s.delta), uint(s.transmitted));
}
)";

// Base of the suites; owns the frame.
class BsdfTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { frame_ = std::make_unique<BsdfFrame>(); }
  static void TearDownTestSuite() { frame_.reset(); }

  template <class Out>
  static std::vector<Out> runCases(const std::string& body, const std::vector<BsdfCase>& cases, std::size_t count,
                                   const Defines& defines = {}) {
    return runCompute<Out>(body, cases, count, {.defines = defines, .frame = frame_->address()});
  }
  template <class Out, class In>
  static std::vector<Out> runQueries(const std::string& body, const std::vector<In>& queries) {
    return runCompute<Out>(body, queries, queries.size(), {.frame = frame_->address()});
  }
  template <class Out>
  static std::vector<Out> runCases(const std::string& body, std::size_t count) {
    return runCompute<Out>(body, count, {.frame = frame_->address()});
  }

 private:
  static inline std::unique_ptr<BsdfFrame> frame_;
};

}  // namespace quintet::test
#endif

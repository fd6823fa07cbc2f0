// SPDX-License-Identifier: Apache-2.0
// Scenes for the tests of quintet/lights: a scene on the device as programs see it, small builders, and the
// Z-test of an estimate against its exact value.
#ifndef QUINTET_TESTS_GPU_LIGHTS_LIGHT_SCENE_H
#define QUINTET_TESTS_GPU_LIGHTS_LIGHT_SCENE_H

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bsdf/chi_square.h"
#include "harness.h"
#include "lights/tree_oracle.h"
#include "render/lights/light_table.h"
#include "render/scene/device_scene.h"

namespace quintet::test {

inline constexpr double kPiDouble = glm::pi<double>();

// The choice by one table of powers instead of the tree.
inline const Defines kByPower{{"QUINTET_LIGHTS_BY_POWER", "1"}};

class LightScene {
 public:
  LightScene(const scene::Scene& scene, const scene::Environment& environment)
      : table(render::buildLightTable(scene, environment)),
        device_(testContext(), scene::Scene(scene), environment),
        frame_(gpu::makeBufferOf(testContext(), std::vector<shared::Frame>{device_.frameTemplate()}, 0, "frame")) {}

  ComputeOptions options(const Defines& defines = {}) const {
    ComputeOptions result;
    result.defines = defines;
    result.set = &device_.set();
    result.frame = frame_.address();
    return result;
  }

  // Of each light, for a receiver without a surface.
  std::vector<double> probabilities(const vec3& position) const { return probabilities(Receiver{position}); }
  std::vector<double> probabilities(const Receiver& receiver) const {
    return oracleProbabilities(table.nodes, table.lights.size(), receiver);
  }

  void setFrame(float frame) { device_.setFrame(frame); }

  const render::LightTable table;  // the same that the device has at frame 0

 private:
  render::DeviceScene device_;
  gpu::Buffer frame_;
};

// The rectangle [-1/2, 1/2]² in z = 0, transformed, as two triangles of an emissive material.
inline scene::Scene emissiveRectangle(const vec3& emission, const mat4& worldFromObject) {
  scene::Scene scene;
  scene.materials.resize(1);
  scene.materials[0].emissive = emission;
  scene::Geometry geometry;
  geometry.positions = {{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}};
  geometry.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  geometry.triangles = {{0, 1, 2}, {0, 2, 3}};
  geometry.material = 0;
  scene.meshes.resize(1);
  scene.meshes[0].geometries = {geometry};
  scene.instances.resize(1);
  scene.instances[0].mesh = 0;
  scene.instances[0].worldFromObject = worldFromObject;
  return scene;
}

// What sampleLight hands back, and the densities with which BSDF sampling would be weighed.
struct LightOut {
  vec3 wi;
  float distance;
  vec3 radiance;
  float pdf;
  vec3 point;
  std::uint32_t valid;
  vec3 normal;
  std::uint32_t delta;
};

// Inputs are positions; invocation i draws sample i. The tests share this one sequence, so a p-value that is low by
// chance is low in several of them: over 60 seeds they are spread evenly, and this seed is not an unlucky one.
inline const std::string kSampleLight = R"(
  #include <quintet/lights/lights.glsl>
  #include <quintet/sampling/pcg.glsl>
  struct LightOut {
    vec3 wi; float distance; vec3 radiance; float pdf; vec3 point; uint valid; vec3 normal; uint delta;
  };
  #define In vec3
  #define Out LightOut
  LightOut run(uint i, vec3 position) {
    Sampler rng = makeSampler(uvec2(0u), i, 1u);
    LightSample s;
    if (!sampleLight(position, next1D(rng), next2D(rng), s))
      return LightOut(vec3(0.0), 0.0, vec3(0.0), 0.0, vec3(0.0), 0u, vec3(0.0), 0u);
    return LightOut(s.wi, s.distance, s.radiance, s.pdf, s.point, 1u, s.normal, s.delta ? 1u : 0u);
  }
)";

inline std::vector<LightOut> sampleLights(const LightScene& scene, const vec3& position, std::size_t count,
                                          const Defines& defines = {}) {
  return runCompute<LightOut>(kSampleLight, std::vector<vec3>{position}, count, scene.options(defines));
}

// Mean of independent estimates with its standard error.
struct Estimate {
  double mean = 0.0;
  double error = 0.0;
};

template <class Value, class F>
Estimate estimate(const std::vector<Value>& samples, const F& valueOf) {
  double sum = 0.0, squares = 0.0;
  for (const Value& sample : samples) {
    const double value = valueOf(sample);
    sum += value;
    squares += value * value;
  }
  const auto n = static_cast<double>(samples.size());
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / n)};
}

// Two-sided probability of so large a deviation; 1e-5 relative is granted for float arithmetic.
inline double pValue(const Estimate& found, double exact) {
  const double deviation = std::max(0.0, std::abs(found.mean - exact) - 1e-5 * std::abs(exact));
  return found.error > 0.0 ? std::erfc(deviation / found.error / std::sqrt(2.0)) : deviation > 0.0 ? 0.0 : 1.0;
}

// Irradiance of a surface with this normal, from light samples.
inline Estimate irradiance(const std::vector<LightOut>& samples, const vec3& normal) {
  return estimate(samples, [&](const LightOut& s) {
    if (!s.valid) return 0.0;
    return static_cast<double>(s.radiance.x) / s.pdf * std::max(0.0, static_cast<double>(glm::dot(s.wi, normal)));
  });
}

}  // namespace quintet::test
#endif

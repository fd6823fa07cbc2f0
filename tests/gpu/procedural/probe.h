// SPDX-License-Identifier: Apache-2.0
// Traces rays given by the host through the stages of the library, and returns the hit and the surface of each.
#ifndef QUINTET_TESTS_GPU_PROCEDURAL_PROBE_H
#define QUINTET_TESTS_GPU_PROCEDURAL_PROBE_H

#include <cstdint>
#include <random>
#include <vector>

#include "scene/model/scene.h"

namespace quintet::test {

struct ProbeRay {
  vec3 origin{0};
  vec3 direction{0, 0, -1};  // of any length
  float tmin = 0.0f;
  float tmax = 1e30f;
};

struct ProbeHit {
  float t = -1.0f;  // < 0: miss
  std::uint32_t instance = 0;
  std::uint32_t primitive = 0;  // index of the solid or tree in the set, or of the triangle
  std::uint32_t leaf = 0;       // index in PrimitiveSet::primitives
  std::uint32_t face = 0;
  bool front = false;
  bool flipped = false;
  bool visible = false;  // result of a shadow ray from origin to tmax
  vec3 position{0};
  float error = 0;
  vec3 normal{0};  // geometric, on the ray's side
  vec3 shadingNormal{0};
  vec3 tangent{0};
  vec3 bitangent{0};
  vec2 uv{0};
  std::uint32_t material = 0;
};

std::vector<ProbeHit> probe(const scene::Scene& scene, const std::vector<ProbeRay>& rays);

// The origin of a ray that leaves the hit in `direction`, as offsetOrigin computes it.
vec3 leave(const ProbeHit& hit, const vec3& direction);

// A scene with one instance of the set.
scene::Scene sceneOf(const scene::PrimitiveSet& set, const mat4& worldFromObject = mat4(1.0f));
scene::PrimitiveSet solidsOf(const std::vector<scene::Primitive>& primitives);

// Random numbers, directions and transforms; equal for equal seeds.
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  float uniform(float low = 0.0f, float high = 1.0f);
  std::uint32_t below(std::uint32_t n);
  vec3 inBox(float halfSize);
  vec3 onSphere();
  mat4 rotation();
  // Rotation, scale and shear within `stretch`, random mirroring, and a translation of up to `distance`.
  mat4 affine(float stretch, float distance);

 private:
  std::mt19937 engine_;
};

}  // namespace quintet::test
#endif

// Rays of the host's choice through the library's stages: what each one meets, and the surface there.
#ifndef QUINTET_TESTS_GPU_PROCEDURAL_PROBE_H
#define QUINTET_TESTS_GPU_PROCEDURAL_PROBE_H

#include <cstdint>
#include <random>
#include <vector>

#include "scene/scene.h"

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
  std::uint32_t primitive = 0;  // solid or tree of the set; triangle
  std::uint32_t leaf = 0;       // index in PrimitiveSet::primitives
  std::uint32_t face = 0;
  bool front = false;
  bool flipped = false;
  bool visible = false;  // what a shadow ray from origin to tmax says
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

// The start of a ray that leaves the hit towards `direction`, as offsetOrigin computes it.
vec3 leave(const ProbeHit& hit, const vec3& direction);

// A scene of one instance of one set.
scene::Scene sceneOf(const scene::PrimitiveSet& set, const mat4& worldFromObject = mat4(1.0f));
scene::PrimitiveSet solidsOf(const std::vector<scene::Primitive>& primitives);

// Random things, the same for the same seed.
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  float uniform(float low = 0.0f, float high = 1.0f);
  std::uint32_t below(std::uint32_t n);
  vec3 inBox(float halfSize);
  vec3 onSphere();
  mat4 rotation();
  // Rotation, scale and shear within `stretch`, mirrored by chance, moved by up to `distance`.
  mat4 affine(float stretch, float distance);

 private:
  std::mt19937 engine_;
};

}  // namespace quintet::test
#endif

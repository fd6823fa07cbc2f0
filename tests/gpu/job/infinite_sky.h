// SPDX-License-Identifier: Apache-2.0
// A program whose samples are infinite where a camera ray leaves the scene, and 0 elsewhere. No scene makes those of the
// built-in programs infinite.
#ifndef QUINTET_TESTS_INFINITE_SKY_H
#define QUINTET_TESTS_INFINITE_SKY_H

#include <string>

#include "base/file.h"
#include "temp_folder.h"

namespace quintet::test {

class InfiniteSky {
 public:
  InfiniteSky() {
    writeFile(folder_ / "program.toml", R"([program]
ray_generation = "sky.rgen"

[[ray]]
name = "radiance"
miss = "<quintet/stages/radiance.rmiss>"

[[hit_group]]
name = "opaque"
geometry = "opaque"
radiance = { closest_hit = "<quintet/stages/surface.rchit>" }

[[output]]
name = "color"
)");
    writeFile(folder_ / "sky.rgen", R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/camera.glsl>
#include <quintet/explain_hooks.glsl>
#include <quintet/lights/environment.glsl>
#include <quintet/output.glsl>
#include <quintet/sampling/pcg.glsl>
#include <quintet/trace.glsl>

void main() {
  const uvec2 pixel = launchPixel();
  vec4 sum = loadOutput(kOutput_color, pixel);
  uint dropped = 0u;
  for (uint i = 0u; i < launch.sampleCount; ++i) {
    Sampler rng = makeSampler(pixel, launch.firstSample + i, frame.seed);
    const Ray ray = cameraRay(vec2(pixel) + 0.5 + filterOffset(next2D(rng)), next2D(rng));
    vec3 radiance = vec3(0.0);
    if (traceClosest(ray.origin, ray.direction, kInfinity, nextBits(rng)).t < 0.0)
      radiance = 3e38 * environmentRadiance(ray.direction);
    explainFound(kExplainFromBackground, radiance, vec3(1.0), 0u);
    if (isFinite(vec4(radiance, 1.0))) sum += vec4(radiance, 1.0);
    else dropped++;
  }
  storeOutput(kOutput_color, pixel, sum);
  countRays(pixel, launch.sampleCount, dropped);
}
)");
  }
  std::string path() const { return folder_.path().string(); }

 private:
  TempFolder folder_;
};

}  // namespace quintet::test
#endif

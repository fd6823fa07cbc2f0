// The light for scenes that bring none.
#ifndef QUINTET_SCENE_DEFAULT_ENVIRONMENT_H
#define QUINTET_SCENE_DEFAULT_ENVIRONMENT_H

#include "scene/scene.h"

namespace quintet::scene {

// A studio sky, 512 × 256 floats: with h = the direction's height (-1 … 1),
//   sky (h >= 0)     mix(horizon (1.00, 1.00, 1.00), zenith (0.55, 0.65, 0.80), h^0.6)
//   ground (h < 0)   mix((0.38, 0.36, 0.33), (0.24, 0.22, 0.20), -h), blended into the sky for |h| < 0.06
//   key light        + (14.0, 13.2, 12.0) · exp(60 (cos θ - 1)), θ from direction (0.5, 0.75, 0.55)
//   fill light       + ( 1.0,  1.1,  1.3) · exp( 8 (cos θ - 1)), θ from direction (-0.8, 0.3, 0.2)
// then each channel is divided by its mean over the sphere, so that a white diffuse ball in it has the mean
// radiance 1 in each channel: objects are lit well and neutrally, from above, with soft shadows.
Environment defaultEnvironment();

// Any light, or any visible surface that emits.
bool givesLight(const Scene& scene);

// The scene's own environment; else the default one if nothing in the scene gives light; else none (black).
Environment environmentInUse(const Scene& scene);

}  // namespace quintet::scene
#endif

// SPDX-License-Identifier: Apache-2.0
// The default environment, and the rule that decides when a scene uses it.
#ifndef QUINTET_SCENE_DEFAULTS_DEFAULT_ENVIRONMENT_H
#define QUINTET_SCENE_DEFAULTS_DEFAULT_ENVIRONMENT_H

#include "scene/defaults/own_light.h"
#include "scene/model/scene.h"

namespace quintet::scene {

// In this light, white surfaces stay below the white of a display, and keep their shading.
inline constexpr double kDefaultRadiance = 0.6;

// A studio sky of 512 × 256 floats. With h the y component of the direction:
//   sky (h >= 0)     mix(horizon (1.00, 1.00, 1.00), zenith (0.55, 0.65, 0.80), h^0.6)
//   ground (h < 0)   mix((0.38, 0.36, 0.33), (0.24, 0.22, 0.20), -h), blended into the sky for |h| < 0.06
//   key light        + (14.0, 13.2, 12.0) · exp(60 (cos θ - 1)), θ from direction (0.5, 0.75, 0.55)
//   fill light       + ( 1.0,  1.1,  1.3) · exp( 8 (cos θ - 1)), θ from direction (-0.8, 0.3, 0.2)
// Then each channel is scaled to the mean kDefaultRadiance over the sphere, which is the mean radiance of a white diffuse
// sphere. The light is neutral, mainly from above, with soft shadows.
Environment defaultEnvironment();

// Whether a scene with this light of its own, and without an environment, gets the default environment.
inline bool needsEnvironment(OwnLight light) { return light == OwnLight::none || light == OwnLight::faint; }

// The scene's own environment; else the default environment if the scene needs one; else none (black).
Environment effectiveEnvironment(const Scene& scene);

}  // namespace quintet::scene
#endif

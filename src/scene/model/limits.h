// SPDX-License-Identifier: Apache-2.0
// The largest numbers of a scene with which the arithmetic of the renderer stays finite.
#ifndef QUINTET_SCENE_MODEL_LIMITS_H
#define QUINTET_SCENE_MODEL_LIMITS_H

#include <string>

#include "io/image.h"
#include "scene/model/scene.h"

namespace quintet::scene {

// Largest coordinate in world space, in meters. Squares of distances stay below the largest float.
inline constexpr float kMaxCoordinate = 1e18f;

// Largest radiance. Infinite and huge values would make sums over samples infinite, and then all pixels that the light reaches.
// Of the emission of materials, the intensity of lights, a constant environment, and texels of images with floats. 500 times
// the luminance of the sun in cd/m²; a film (shared/film.h) can sum a million samples of it.
inline constexpr float kMaxRadiance = 1e12f;

// Replaces samples of an image with floats that are NaN by 0, and clamps the others to ±kMaxRadiance. Returns what it did and
// where, for reports and warnings; empty if the image did not change. On all cores.
std::string repairTexels(io::Image&);

// Whether the transform and its point are within the largest coordinate. False for NaN.
bool isWithinLimits(const vec3& point);
bool isWithinLimits(const mat4& transform);
bool isWithinLimits(const Bounds3& bounds);  // true for empty bounds

// Throws Error with the name of the first instance that extends beyond the largest coordinate. `bounds`: worldBounds(scene).
void checkExtent(const Scene&, const Bounds3& bounds);

}  // namespace quintet::scene
#endif

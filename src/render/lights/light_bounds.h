// SPDX-License-Identifier: Apache-2.0
// Bounds of the light that one or many lights emit: positions, directions and power. A. Conty Estevez and C. Kulla,
// "Importance Sampling of Many Lights with Adaptive Tree Splitting" (2018), section 4; thetaO and thetaE are the
// paper's names.
#ifndef QUINTET_RENDER_LIGHTS_LIGHT_BOUNDS_H
#define QUINTET_RENDER_LIGHTS_LIGHT_BOUNDS_H

#include <array>

#include "scene/model/procedural.h"

namespace quintet::render {

// Light leaves within thetaE of a normal, which is within thetaO of `axis`. Angles are in radians.
struct LightBounds {
  Bounds3 box;          // world space; for infinite lights, bounds of the directions to them
  vec3 center{0.0f};    // mean position of the lights, weighted by intensity
  float radius = 0.0f;  // radius in meters of a ball around `center` that contains the lights
  // Sum of the lights' largest radiant intensities, as luminance. Irradiance for infinite lights.
  float intensity = 0.0f;
  vec3 axis{0, 0, 1};   // unit vector
  float thetaO = 0.0f;  // kPi means all normals
  float thetaE = 0.0f;
  bool twoSided = false;  // each normal stands for its opposite, too; thetaO is then at most kPi / 2
};

// `intensity` is the largest radiant intensity in any direction. The boxes of surfaces are enlarged by the rounding
// error of float arithmetic on the device.
LightBounds triangleBounds(const std::array<vec3, 3>& objectCorners, const mat4& worldFromObject, double intensity);
LightBounds solidBounds(const scene::Primitive& primitive, const mat4& worldFromObject, double intensity);
LightBounds pointBounds(const vec3& position, double intensity);
LightBounds spotBounds(const vec3& position, const vec3& direction, double innerAngle, double outerAngle,
                       double intensity);
LightBounds directionalBounds(const vec3& direction, double irradiance);  // direction in which the light travels
LightBounds environmentBounds(double irradiance);

LightBounds unite(const LightBounds& a, const LightBounds& b);

// Returns the orientation measure M_Ω, equation 1 of the paper; twice that for two-sided lights.
double orientationMeasure(const LightBounds& bounds);

}  // namespace quintet::render
#endif

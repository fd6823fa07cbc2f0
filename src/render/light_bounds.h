// What bounds the light of one light or of many: where it starts, in which directions it leaves, how much there is.
// A. Conty Estevez and C. Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting" (2018), section 4.
#ifndef QUINTET_RENDER_LIGHT_BOUNDS_H
#define QUINTET_RENDER_LIGHT_BOUNDS_H

#include <array>

#include "scene/procedural.h"

namespace quintet::render {

// Light leaves within `beyond` of a normal, which is within `spread` of `axis`. Radians.
struct LightBounds {
  Bounds3 box;             // world; infinite lights: of the directions to them
  vec3 center{0.0f};       // mean of the lights' places by intensity
  float radius = 0.0f;     // of a ball around it that holds the lights, m
  float intensity = 0.0f;  // sum of the lights' largest radiant intensities, luminance; infinite: irradiance
  vec3 axis{0, 0, 1};      // unit
  float spread = 0.0f;     // kPi: all normals
  float beyond = 0.0f;
  bool bothSides = false;  // the normals are lines: each stands for its opposite, too; spread is at most half a turn
};

// `intensity`: the largest in any direction. Boxes of surfaces are wider than these by what float arithmetic on the device
// may be off.
LightBounds triangleBounds(const std::array<vec3, 3>& objectCorners, const mat4& worldFromObject, double intensity);
LightBounds solidBounds(const scene::Primitive& primitive, const mat4& worldFromObject, double intensity);
LightBounds pointBounds(const vec3& position, double intensity);
LightBounds spotBounds(const vec3& position, const vec3& direction, double innerAngle, double outerAngle,
                       double intensity);
LightBounds directionalBounds(const vec3& direction, double irradiance);  // direction: the way the light goes
LightBounds environmentBounds(double irradiance);

LightBounds unite(const LightBounds& a, const LightBounds& b);

// How wide the directions of the light are, about: equation 1, twice that for both sides.
double orientationMeasure(const LightBounds& bounds);

}  // namespace quintet::render
#endif

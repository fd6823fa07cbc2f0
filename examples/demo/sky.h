// SPDX-License-Identifier: Apache-2.0
// A clear sky over the sea as an equirectangular image: the daylight model of Preetham, Shirley & Smits, "A Practical
// Analytic Model for Daylight", SIGGRAPH 1999. The disc of the sun is larger and softer than the real one, so that its
// shadows are soft and its light is easy to sample. Thin clouds, hills in the haze and the sea are not physical; they
// use the light of the model.
#ifndef QUINTET_DEMO_SKY_H
#define QUINTET_DEMO_SKY_H

#include <cstdint>

#include "base/math.h"
#include "io/image.h"

namespace quintet::demo {

struct SkySettings {
  vec3 sunDirection{0.0f, 1.0f, 0.0f};   // unit, towards the sun, above the horizon
  float turbidity = 3.0f;                // 2 (clear) … 6 (hazy)
  float skyIrradiance = 1.5f;            // luminance of the irradiance on the ground, without the sun
  float sunIrradiance = 3.0f;            // luminance of the irradiance of the sun on a surface that faces it
  float sunRadius = glm::radians(4.0f);  // radius at which the disc has faded out
  float clouds = 0.0f;                   // 0 (none) … 1
  float haze = 0.0f;                     // whiteness of the horizon, 0 … 1
  bool hills = false;                    // along the horizon
};

class Sky {
 public:
  explicit Sky(const SkySettings& settings);

  // Radiance from a unit direction: sky, sun and hills above the horizon, the sea below.
  vec3 radiance(const vec3& direction) const;

 private:
  vec3 dome(const vec3& direction) const;
  vec3 sun(const vec3& direction) const;
  vec3 cloudy(const vec3& clear, const vec3& direction) const;
  vec3 hilly(const vec3& behind, const vec3& direction) const;
  vec3 hazy(const vec3& clear, float height) const;
  vec3 haze(const vec3& direction) const;  // of the horizon in this direction
  vec3 sea(const vec3& direction) const;

  struct Perez {
    float a, b, c, d, e, zenith;
    float at(float cosTheta, float gamma) const;
    float ratio(float cosTheta, float gamma, float thetaSun) const;
  };
  SkySettings settings_;
  float thetaSun_;
  Perez luminance_, x_, y_;
  float scale_ = 1.0f;
  vec3 sunColor_{1.0f};    // of luminance 1
  vec3 whiteLight_{0.0f};  // radiance of a cloud
  vec3 sunRadiance_{0.0f};
};

// Linear RGB floats. u = atan2(z, x)/2π + 0.5, v = acos(y)/π from the top row.
io::Image skyImage(const SkySettings& settings, std::uint32_t width, std::uint32_t height);

}  // namespace quintet::demo
#endif

// SPDX-License-Identifier: Apache-2.0
// Light sampling of a sphere in world space, seen from outside: uniform over the cone of its directions, on the near side
// (Shirley et al. 1996, "Monte Carlo Techniques for Direct Lighting Calculations").
#ifndef QUINTET_LIGHTS_BALL_GLSL
#define QUINTET_LIGHTS_BALL_GLSL

#include "../surface.glsl"

// Returns the world radius of a sphere, or 0 for an ellipsoid and for other solids.
float ballRadius(uint type, mat3 m) {
  const vec3 squares = vec3(dot(m[0], m[0]), dot(m[1], m[1]), dot(m[2], m[2]));
  const vec3 mixed = abs(vec3(dot(m[0], m[1]), dot(m[1], m[2]), dot(m[2], m[0])));
  const bool ball = type == kPrimitiveSphere && maxComponent(max(abs(squares - squares.x), mixed)) <= 2e-5 * squares.x;
  return ball ? sqrt(squares.x) : 0.0;
}

// Returns true outside the ball. The margin excludes its surface, where rounding would decide.
bool seesBallFromOutside(float radius, vec3 toCenter) { return radius > 0.0 && 1.00002 * radius * radius < dot(toCenter, toCenter); }

// Returns the density per solid angle of sampleBall.
float pdfBall(vec3 toCenter, float radius) {
  const float sineSquared = radius * radius / dot(toCenter, toCenter);
  return (1.0 + sqrt(1.0 - sineSquared)) / (2.0 * kPi * sineSquared);
}

// Returns a point of a ball around the origin, seen from -toCenter, uniform over the cone of its directions.
vec3 sampleBall(vec3 toCenter, float radius, vec2 u) {
  const float sineSquaredMax = radius * radius / dot(toCenter, toCenter);
  const float h = u.x * sineSquaredMax / (1.0 + sqrt(1.0 - sineSquaredMax));  // 1 - cos of the direction
  const float sineSquared = h * (2.0 - h);
  // The near intersection as an angle at the ball's center (pbrt-v4, section 6.2.4). The sine comes from the distance,
  // because the angle is small close to the ball.
  const float rest = sqrt(max(0.0, 1.0 - sineSquared / sineSquaredMax));
  const float sineMax = sqrt(sineSquaredMax);
  const float cosine = sineSquared / sineMax + (1.0 - h) * rest;
  const float along = (1.0 / sineSquaredMax - 1.0) / ((1.0 - h) / sineMax + rest);  // distance in radii
  const float sine = min(along * sqrt(sineSquared), 1.0);
  const vec3 z = -normalize(toCenter);
  const vec3 x = anyTangent(z);
  const float phi = 2.0 * kPi * u.y;
  return radius * (sine * cos(phi) * x + sine * sin(phi) * cross(z, x) + cosine * z);
}

#endif

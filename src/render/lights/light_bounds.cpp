// SPDX-License-Identifier: Apache-2.0
#include "render/lights/light_bounds.h"

#include <algorithm>
#include <array>
#include <utility>

namespace quintet::render {
namespace {

constexpr double kRoundoff = 0x1p-24;
constexpr float kHalfPi = 0.5f * kPi;

// Returns a bound on the rounding error of L v + t in float, including the rounding of its inputs: 8 roundings for
// components up to `largest`.
vec3 transformError(const mat4& m, const vec3& largest) {
  vec3 error;
  for (int row = 0; row < 3; ++row) {
    double sum = std::abs(m[3][row]);
    for (int column = 0; column < 3; ++column) sum += std::abs(static_cast<double>(m[column][row])) * largest[column];
    error[row] = static_cast<float>(8.0 * kRoundoff * sum);
  }
  return error;
}

float angleBetween(const vec3& a, const vec3& b) { return std::acos(std::clamp(glm::dot(a, b), -1.0f, 1.0f)); }

struct Cone {
  vec3 axis;
  float thetaO;
};

// Returns the smallest cone that contains both; algorithm 1 of the paper.
Cone uniteCones(Cone a, Cone b, bool twoSided) {
  if (a.thetaO < b.thetaO) std::swap(a, b);
  const float full = twoSided ? kHalfPi : kPi;
  if (a.thetaO >= full) return a;
  if (twoSided && glm::dot(a.axis, b.axis) < 0.0f) b.axis = -b.axis;
  const float thetaD = angleBetween(a.axis, b.axis);
  if (std::min(thetaD + b.thetaO, kPi) <= a.thetaO) return a;
  const float thetaO = 0.5f * (a.thetaO + thetaD + b.thetaO);
  const float thetaR = thetaO - a.thetaO, sine = std::sin(thetaD);
  if (thetaO >= full || sine < 1e-6f) return thetaD < 1e-3f ? Cone{a.axis, std::min(thetaO, full)} : Cone{a.axis, full};
  return {glm::normalize((std::sin(thetaD - thetaR) * a.axis + std::sin(thetaR) * b.axis) / sine), thetaO};
}

float toFloat(double intensity) {
  return intensity > 0.0 ? static_cast<float>(std::clamp(intensity, 1e-37, 1e37)) : 0.0f;
}

}  // namespace

LightBounds triangleBounds(const std::array<vec3, 3>& corners, const mat4& worldFromObject, double intensity) {
  std::array<glm::dvec3, 3> p;
  vec3 largest(0.0f);
  for (std::size_t i = 0; i < 3; ++i) {
    p[i] = glm::dvec3(glm::dmat4(worldFromObject) * glm::dvec4(corners[i], 1.0));
    largest = glm::max(largest, glm::abs(corners[i]));
  }
  const vec3 error = transformError(worldFromObject, largest);
  LightBounds bounds;
  for (const glm::dvec3& corner : p) {
    bounds.box.extend(vec3(corner) - error);
    bounds.box.extend(vec3(corner) + error);
  }
  bounds.center = bounds.box.center();
  for (const glm::dvec3& corner : p)
    bounds.radius = std::max(bounds.radius, static_cast<float>(glm::distance(corner, glm::dvec3(bounds.center))));
  bounds.radius += glm::length(error);
  const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
  const double length = glm::length(normal);
  bounds.axis = length > 0.0 ? vec3(normal / length) : vec3(0, 0, 1);
  bounds.thetaE = kHalfPi;
  bounds.twoSided = true;
  bounds.intensity = toFloat(intensity);
  return bounds;
}

LightBounds solidBounds(const scene::Primitive& primitive, const mat4& worldFromObject, double intensity) {
  const Bounds3 object = scene::boundsOf(primitive);
  const vec3 error = transformError(worldFromObject, glm::max(glm::abs(object.min), glm::abs(object.max)));
  LightBounds bounds;
  bounds.box = scene::boundsOf(primitive, worldFromObject);
  bounds.box.min -= error;
  bounds.box.max += error;
  bounds.center = bounds.box.center();
  bounds.radius = 0.5f * glm::length(bounds.box.extent());
  if (primitive.type == scene::PrimitiveType::sphere) {
    // A bound on the largest singular value of the transform from the row sums of m mᵀ; exact for balls.
    const glm::dmat3 m = glm::dmat3(glm::mat3(worldFromObject)) * glm::dmat3(glm::mat3(primitive.objectFromPrimitive));
    const glm::dmat3 squares = m * glm::transpose(m);
    double largest = 0.0;
    for (int row = 0; row < 3; ++row)
      largest = std::max(largest, std::abs(squares[row][0]) + std::abs(squares[row][1]) + std::abs(squares[row][2]));
    bounds.radius =
        std::min(bounds.radius, static_cast<float>(std::sqrt(largest)) * (1.0f + 1e-6f) + glm::length(error));
  }
  bounds.thetaO = kPi;
  bounds.thetaE = kHalfPi;
  bounds.intensity = toFloat(intensity);
  return bounds;
}

LightBounds pointBounds(const vec3& position, double intensity) {
  LightBounds bounds;
  bounds.box.extend(position);
  bounds.center = position;
  bounds.thetaO = kPi;
  bounds.thetaE = kHalfPi;
  bounds.intensity = toFloat(intensity);
  return bounds;
}

LightBounds spotBounds(const vec3& position, const vec3& direction, double innerAngle, double outerAngle,
                       double intensity) {
  LightBounds bounds = pointBounds(position, intensity);
  bounds.axis = direction;
  bounds.thetaO = static_cast<float>(innerAngle);
  bounds.thetaE = static_cast<float>(outerAngle - innerAngle);
  return bounds;
}

LightBounds directionalBounds(const vec3& direction, double irradiance) {
  LightBounds bounds = pointBounds(-direction, irradiance);
  bounds.axis = -direction;
  bounds.thetaO = 0.0f;
  bounds.thetaE = 0.0f;
  return bounds;
}

LightBounds environmentBounds(double irradiance) { return pointBounds(vec3(0.0f), irradiance); }

LightBounds unite(const LightBounds& a, const LightBounds& b) {
  LightBounds result;
  result.box = a.box;
  result.box.extend(b.box);
  result.intensity = a.intensity + b.intensity;
  result.center = glm::mix(a.center, b.center, b.intensity / result.intensity);
  const float around =
      std::max(glm::distance(result.center, a.center) + a.radius, glm::distance(result.center, b.center) + b.radius);
  const float corner = glm::length(glm::max(result.box.max - result.center, result.center - result.box.min));
  result.radius = (1.0f + 1e-6f) * std::min(corner, around);
  result.twoSided = a.twoSided || b.twoSided;
  const Cone cone = uniteCones({a.axis, a.thetaO}, {b.axis, b.thetaO}, result.twoSided);
  result.axis = cone.axis;
  result.thetaO = cone.thetaO;
  result.thetaE = std::max(a.thetaE, b.thetaE);
  return result;
}

double orientationMeasure(const LightBounds& bounds) {
  if (bounds.thetaO >= (bounds.twoSided ? kHalfPi : kPi)) return 4.0 * glm::pi<double>();
  const double o = bounds.thetaO, w = std::min(o + bounds.thetaE, glm::pi<double>());
  const double oneSide =
      2.0 * glm::pi<double>() * (1.0 - std::cos(o)) +
      glm::half_pi<double>() * (2.0 * w * std::sin(o) - std::cos(o - 2.0 * w) - 2.0 * o * std::sin(o) + std::cos(o));
  return bounds.twoSided ? std::min(2.0 * oneSide, 4.0 * glm::pi<double>()) : oneSide;
}

}  // namespace quintet::render

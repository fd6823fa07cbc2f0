#include "render/solid_area.h"

#include <algorithm>

namespace quintet::render {
namespace {

using glm::dmat3;
using glm::dvec3;

constexpr double kTwoPi = 2.0 * glm::pi<double>();

// What m makes of a unit of area with unit normal n.
double stretch(const dmat3& m, const dvec3& n) {
  return glm::length(n.x * glm::cross(m[1], m[2]) + n.y * glm::cross(m[2], m[0]) + n.z * glm::cross(m[0], m[1]));
}

bool keepsShapes(const dmat3& m) {
  const dvec3 squares(glm::dot(m[0], m[0]), glm::dot(m[1], m[1]), glm::dot(m[2], m[2]));
  const double mixed =
      std::max({std::abs(glm::dot(m[0], m[1])), std::abs(glm::dot(m[1], m[2])), std::abs(glm::dot(m[2], m[0]))});
  return std::max({std::abs(squares.y - squares.x), std::abs(squares.z - squares.x), mixed}) < 1e-5 * squares.x;
}

// Mean over the angle about y of body(x, z).
template <class Body>
double meanAround(const Body& body) {
  constexpr int kSteps = 32;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) sum += body(std::sin(kTwoPi * i / kSteps), std::cos(kTwoPi * i / kSteps));
  return sum / kSteps;
}

template <class StretchOf>
double canonicalArea(const scene::Primitive& primitive, const StretchOf& at) {
  constexpr int kSteps = 16;
  const double caps = kTwoPi / 2.0 * at({0, 1, 0});  // one
  switch (primitive.type) {
    case scene::PrimitiveType::box: return 8.0 * (at({1, 0, 0}) + at({0, 1, 0}) + at({0, 0, 1}));
    case scene::PrimitiveType::cylinder:
      return 2.0 * caps + 2.0 * kTwoPi * meanAround([&](double x, double z) { return at({x, 0, z}); });
    case scene::PrimitiveType::cone:
      return caps + 0.5 * kTwoPi * std::sqrt(5.0) *
                        meanAround([&](double x, double z) { return at(dvec3(2 * x, 1, 2 * z) / std::sqrt(5.0)); });
    case scene::PrimitiveType::sphere: {
      double sum = 0.0;  // slices of equal height are of equal area
      for (int i = 0; i < kSteps; ++i) {
        const double y = (2.0 * i + 1.0) / kSteps - 1.0, r = std::sqrt(1.0 - y * y);
        sum += meanAround([&](double x, double z) { return at({r * x, y, r * z}); });
      }
      return 2.0 * kTwoPi * sum / kSteps;
    }
    case scene::PrimitiveType::torus: {
      const auto minor = static_cast<double>(primitive.parameter);
      double sum = 0.0;
      for (int i = 0; i < kSteps; ++i) {
        const double c = std::cos(kTwoPi * i / kSteps), s = std::sin(kTwoPi * i / kSteps);
        sum += (1.0 + minor * c) * meanAround([&](double x, double z) { return at({c * x, s, c * z}); });
      }
      return kTwoPi * kTwoPi * minor * sum / kSteps;
    }
  }
  return 0.0;
}

}  // namespace

double solidArea(const scene::Primitive& primitive, const dmat3& worldFromObject) {
  const dmat3 m = worldFromObject * dmat3(mat3(primitive.objectFromPrimitive));
  const bool similar = keepsShapes(m);
  const double scale = glm::dot(m[0], m[0]);
  const double area = similar ? scale * canonicalArea(primitive, [](const dvec3&) { return 1.0; })
                              : canonicalArea(primitive, [&](const dvec3& n) { return stretch(m, n); });
  return std::isfinite(area) ? area : 0.0;
}

}  // namespace quintet::render

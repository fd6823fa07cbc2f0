// SPDX-License-Identifier: Apache-2.0
// Intersections of rays with analytic solids and CSG trees in double precision: the reference for tests of the shaders.
// It shares no algorithm with them: a solid is the list of all its crossings with the infinite line, and an operation
// merges two lists. Everything is in the object space of the primitive set; t refers to the direction, which is not
// normalized. Results for tangent rays and coincident surfaces are arbitrary, so tests must avoid them.
#ifndef QUINTET_TESTS_CSG_ORACLE_H
#define QUINTET_TESTS_CSG_ORACLE_H

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "scene/model/procedural.h"

namespace quintet::test::oracle {

using glm::dmat3;
using glm::dmat4;
using glm::dvec3;

struct Ray {
  dvec3 origin;
  dvec3 direction;  // any length; the unit of t
  dvec3 at(double t) const { return origin + t * direction; }
};

// A point at which a line enters or leaves a solid.
struct Crossing {
  double t = 0.0;
  dvec3 normal{0.0};            // object space, unit, out of the solid or of the result of a tree
  std::uint32_t primitive = 0;  // index in PrimitiveSet::primitives
  bool entering = true;
  bool flipped = false;  // surface of a subtrahend: the normal points into that primitive
};
using Crossings = std::vector<Crossing>;  // ascending t, entering and leaving alternately

// ---- canonical solids ----

inline bool insideCanonical(scene::PrimitiveType type, double minor, const dvec3& p) {
  const double r2 = p.x * p.x + p.z * p.z;
  switch (type) {
    case scene::PrimitiveType::sphere: return glm::dot(p, p) <= 1.0;
    case scene::PrimitiveType::box: return std::abs(p.x) <= 1.0 && std::abs(p.y) <= 1.0 && std::abs(p.z) <= 1.0;
    case scene::PrimitiveType::cylinder: return r2 <= 1.0 && std::abs(p.y) <= 1.0;
    case scene::PrimitiveType::cone: return std::abs(p.y) <= 1.0 && std::sqrt(r2) <= 0.5 * (1.0 - p.y);
    case scene::PrimitiveType::torus: {
      const double q = std::sqrt(r2) - 1.0;
      return q * q + p.y * p.y <= minor * minor;
    }
  }
  return false;
}

namespace detail {

// Coefficients by ascending powers. Real roots with a change of sign are searched between the roots of the derivative.
using Polynomial = std::vector<double>;

inline double evaluate(const Polynomial& p, double x) {
  double value = 0.0;
  for (std::size_t i = p.size(); i-- > 0;) value = value * x + p[i];
  return value;
}

inline std::vector<double> roots(Polynomial p, double low, double high) {
  while (!p.empty() && p.back() == 0.0) p.pop_back();
  if (p.size() < 2) return {};
  std::vector<double> result, stops{low};
  if (p.size() > 2) {
    Polynomial derivative;
    for (std::size_t i = 1; i < p.size(); ++i) derivative.push_back(static_cast<double>(i) * p[i]);
    for (const double x : roots(derivative, low, high)) stops.push_back(x);
  }
  stops.push_back(high);
  for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
    double a = stops[i], b = stops[i + 1];
    const bool negative = evaluate(p, a) < 0.0;
    if (negative == (evaluate(p, b) < 0.0)) continue;
    for (int k = 0; k < 200 && a < b; ++k) {
      const double middle = 0.5 * (a + b);
      if (middle <= a || middle >= b) break;
      ((evaluate(p, middle) < 0.0) == negative ? a : b) = middle;
    }
    result.push_back(0.5 * (a + b));
  }
  return result;
}

inline Polynomial product(const Polynomial& a, const Polynomial& b) {
  Polynomial result(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < b.size(); ++k) result[i + k] += a[i] * b[k];
  return result;
}

// A boundary point with its outward normal (canonical space, any length).
struct Boundary {
  double t;
  dvec3 normal;
};

// Clips the interval by the half-space dot(normal, p) <= offset.
inline void clipByPlane(const Ray& ray, const dvec3& normal, double offset, std::vector<Boundary>& interval) {
  if (interval.empty()) return;
  const double slope = glm::dot(normal, ray.direction), value = glm::dot(normal, ray.origin) - offset;
  if (slope == 0.0) {
    if (value > 0.0) interval.clear();
    return;
  }
  const double t = -value / slope;
  if (slope < 0.0 && t > interval[0].t) interval[0] = {t, normal};
  if (slope > 0.0 && t < interval[1].t) interval[1] = {t, normal};
  if (!(interval[0].t < interval[1].t)) interval.clear();
}

inline std::vector<Boundary> wholeLine() {
  const double infinity = std::numeric_limits<double>::infinity();
  return {{-infinity, dvec3(0.0)}, {infinity, dvec3(0.0)}};
}

// Real roots of a x² + b x + c, ascending, without cancellation.
inline std::vector<double> quadratic(double a, double b, double c) {
  if (a == 0.0) return b == 0.0 ? std::vector<double>{} : std::vector<double>{-c / b};
  const double discriminant = b * b - 4.0 * a * c;
  if (discriminant <= 0.0) return {};
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  std::vector<double> result{q / a, q == 0.0 ? 0.0 : c / q};
  std::ranges::sort(result);
  return result;
}

inline std::vector<Boundary> sphere(const Ray& r) {
  const double b = glm::dot(r.origin, r.direction), a = glm::dot(r.direction, r.direction);
  const std::vector<double> t = quadratic(a, 2.0 * b, glm::dot(r.origin, r.origin) - 1.0);
  if (t.size() < 2) return {};
  return {{t[0], r.at(t[0])}, {t[1], r.at(t[1])}};
}

inline std::vector<Boundary> box(const Ray& r) {
  std::vector<Boundary> interval = wholeLine();
  for (int axis = 0; axis < 3; ++axis) {
    dvec3 normal(0.0);
    for (const double sign : {-1.0, 1.0}) normal[axis] = sign, clipByPlane(r, normal, 1.0, interval);
  }
  return interval;
}

inline std::vector<Boundary> cylinder(const Ray& r) {
  const dvec3 &o = r.origin, &d = r.direction;
  std::vector<Boundary> interval = wholeLine();
  if (d.x == 0.0 && d.z == 0.0) {
    if (o.x * o.x + o.z * o.z > 1.0) return {};
  } else {
    const auto t = quadratic(d.x * d.x + d.z * d.z, 2.0 * (o.x * d.x + o.z * d.z), o.x * o.x + o.z * o.z - 1.0);
    if (t.size() < 2) return {};
    for (std::size_t i = 0; i < 2; ++i) interval[i] = {t[i], dvec3(1, 0, 1) * r.at(t[i])};
  }
  clipByPlane(r, {0, 1, 0}, 1.0, interval);
  clipByPlane(r, {0, -1, 0}, 1.0, interval);
  return interval;
}

// The intervals between the roots of x² + z² = ((1 - y)/2)² and the planes y = ±1 whose midpoint is inside. The other
// half of the double cone touches the slab only in the apex, so the result is one interval.
inline std::vector<Boundary> cone(const Ray& r) {
  const dvec3 &o = r.origin, &d = r.direction;
  const double h = 0.5 * (1.0 - o.y), k = -0.5 * d.y;
  std::vector<Boundary> stops;
  for (const double t :
       quadratic(d.x * d.x + d.z * d.z - k * k, 2.0 * (o.x * d.x + o.z * d.z - h * k), o.x * o.x + o.z * o.z - h * h)) {
    const dvec3 p = r.at(t);
    stops.push_back({t, {p.x, 0.25 * (1.0 - p.y), p.z}});
  }
  if (d.y != 0.0)
    for (const double y : {-1.0, 1.0}) stops.push_back({(y - o.y) / d.y, {0, y, 0}});
  std::ranges::sort(stops, {}, &Boundary::t);
  std::vector<Boundary> interval;
  for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
    if (!insideCanonical(scene::PrimitiveType::cone, 0.0, r.at(0.5 * (stops[i].t + stops[i + 1].t)))) continue;
    if (interval.empty())
      interval.push_back(stops[i]), interval.push_back(stops[i + 1]);
    else
      interval[1] = stops[i + 1];
  }
  return interval;
}

// (|p|² + 1 - m²)² = 4 (x² + z²), a quartic in t.
inline std::vector<Boundary> torus(const Ray& ray, double minor) {
  // Moves the origin close to the torus, so that the coefficients are small. Double precision suffices for the shift.
  const double length = glm::length(ray.direction), shift = -glm::dot(ray.origin, ray.direction) / (length * length);
  const Ray r{ray.at(shift), ray.direction / length};
  const dvec3 &o = r.origin, &d = r.direction;
  const Polynomial s{glm::dot(o, o) + 1.0 - minor * minor, 2.0 * glm::dot(o, d), 1.0};
  const Polynomial radial{4.0 * (o.x * o.x + o.z * o.z), 8.0 * (o.x * d.x + o.z * d.z), 4.0 * (d.x * d.x + d.z * d.z)};
  Polynomial f = product(s, s);
  for (std::size_t i = 0; i < 3; ++i) f[i] -= radial[i];
  std::vector<Boundary> result;
  for (const double t : roots(f, -4.0, 4.0)) {  // the torus is within 2 of the origin
    const dvec3 p = r.at(t);
    const double q = std::sqrt(p.x * p.x + p.z * p.z);
    result.push_back({shift + t / length, p - dvec3(p.x, 0, p.z) / q});
  }
  if (result.size() % 2 != 0) result.clear();  // tangent
  return result;
}

}  // namespace detail

// ---- primitives ----

inline Crossings crossings(const scene::Primitive& primitive, const Ray& ray, std::uint32_t index = 0) {
  const dmat4 back = glm::inverse(dmat4(primitive.objectFromPrimitive));
  const Ray local{dvec3(back * glm::dvec4(ray.origin, 1.0)), dvec3(back * glm::dvec4(ray.direction, 0.0))};
  // All canonical solids are within 2 of the origin.
  const double along = glm::dot(local.direction, local.direction);
  if (glm::length(local.at(-glm::dot(local.origin, local.direction) / along)) > 2.01) return {};
  std::vector<detail::Boundary> boundary;
  switch (primitive.type) {
    case scene::PrimitiveType::sphere: boundary = detail::sphere(local); break;
    case scene::PrimitiveType::box: boundary = detail::box(local); break;
    case scene::PrimitiveType::cylinder: boundary = detail::cylinder(local); break;
    case scene::PrimitiveType::cone: boundary = detail::cone(local); break;
    case scene::PrimitiveType::torus: boundary = detail::torus(local, static_cast<double>(primitive.parameter)); break;
  }
  const dmat3 normalMatrix = glm::transpose(dmat3(back));
  Crossings result;
  for (std::size_t i = 0; i < boundary.size(); ++i)
    result.push_back({boundary[i].t, glm::normalize(normalMatrix * boundary[i].normal), index, i % 2 == 0, false});
  return result;
}

inline bool inside(const scene::Primitive& primitive, const dvec3& p) {
  const dmat4 back = glm::inverse(dmat4(primitive.objectFromPrimitive));
  return insideCanonical(primitive.type, static_cast<double>(primitive.parameter), dvec3(back * glm::dvec4(p, 1.0)));
}

// ---- trees ----

inline bool combine(scene::CsgOperation operation, bool a, bool b) {
  switch (operation) {
    case scene::CsgOperation::unite: return a || b;
    case scene::CsgOperation::intersect: return a && b;
    case scene::CsgOperation::subtract: return a && !b;
    case scene::CsgOperation::leaf: break;
  }
  return false;
}

inline Crossings merge(scene::CsgOperation operation, const Crossings& a, const Crossings& b) {
  Crossings result;
  bool inA = false, inB = false;
  for (std::size_t i = 0, k = 0; i < a.size() || k < b.size();) {
    const bool before = combine(operation, inA, inB);
    const bool takeA = k == b.size() || (i < a.size() && a[i].t <= b[k].t);
    Crossing crossing = takeA ? a[i++] : b[k++];
    (takeA ? inA : inB) = crossing.entering;
    const bool after = combine(operation, inA, inB);
    if (before == after) continue;
    if (!takeA && operation == scene::CsgOperation::subtract) {
      crossing.normal = -crossing.normal;
      crossing.flipped = !crossing.flipped;
    }
    crossing.entering = after;
    result.push_back(crossing);
  }
  return result;
}

inline Crossings crossings(const scene::PrimitiveSet& set, const scene::CsgTree& tree, const Ray& ray) {
  std::vector<Crossings> stack;
  for (std::uint32_t i = tree.firstNode; i < tree.firstNode + tree.nodeCount; ++i) {
    const scene::CsgNode& node = set.nodes[i];
    if (node.operation == scene::CsgOperation::leaf) {
      stack.push_back(crossings(set.primitives[node.primitive], ray, node.primitive));
      continue;
    }
    const Crossings right = std::move(stack.back());
    stack.pop_back();
    stack.back() = merge(node.operation, stack.back(), right);
  }
  return stack.back();
}

inline bool inside(const scene::PrimitiveSet& set, const scene::CsgTree& tree, const dvec3& p) {
  std::vector<bool> stack;
  for (std::uint32_t i = tree.firstNode; i < tree.firstNode + tree.nodeCount; ++i) {
    const scene::CsgNode& node = set.nodes[i];
    if (node.operation == scene::CsgOperation::leaf) {
      stack.push_back(inside(set.primitives[node.primitive], p));
      continue;
    }
    const bool right = stack.back();
    stack.pop_back();
    stack.back() = combine(node.operation, stack.back(), right);
  }
  return stack.back();
}

// The first crossing with tmin < t < tmax, entering or leaving: the expected closest hit.
inline std::optional<Crossing> firstHit(const Crossings& crossings, double tmin, double tmax) {
  for (const Crossing& crossing : crossings)
    if (crossing.t > tmin && crossing.t < tmax) return crossing;
  return std::nullopt;
}

}  // namespace quintet::test::oracle
#endif

// SPDX-License-Identifier: Apache-2.0
#include "check/flow/space_tag.h"

#include <fmt/format.h>

namespace quintet::check {
namespace {

using Kind = SpaceTag::Kind;
using W = SpaceTag::W;

W joinedW(W a, W b) { return a == b ? a : W::other; }

W sumOfW(W a, W b) {
  if (a == W::none || b == W::none) return W::none;
  if (a == W::zero) return b;
  return b == W::zero ? a : W::other;
}

W differenceOfW(W a, W b) {
  if (a == W::none || b == W::none) return W::none;
  if (b == W::zero) return a;
  return a == W::one && b == W::one ? W::zero : W::other;
}

// Drops what holds only for the unchanged value.
SpaceTag plain(SpaceTag tag) {
  tag.translation = tag.column = false;
  tag.map = {};
  tag.index = 0;
  return tag;
}

// A value of the space of `tag` and with a different kind.
SpaceTag like(const SpaceTag& tag, Kind kind) {
  SpaceTag result = geometricTag(tag.space, kind);
  result.component = tag.component;
  return result;
}

bool sameSpace(const SpaceTag& a, const SpaceTag& b) { return a.space == b.space && a.component == b.component; }

bool isVector(Kind kind) { return kind == Kind::direction || kind == Kind::normal || kind == Kind::radial; }

SpaceTag pointPlus(const SpaceTag& point, const SpaceTag& other) {
  SpaceTag result = like(point, Kind::point);
  result.scaled = point.scaled || other.kind == Kind::point;
  result.onRay = other.kind == Kind::direction && other.onRay;
  if (isVector(other.kind) || other.kind == Kind::point) return result;
  if (other.untranslated && point.translation) return result;
  return like(point, Kind::any);
}

// The sum of two values of one space that are not points.
SpaceTag vectorSum(const SpaceTag& a, const SpaceTag& b) {
  if (a.kind == Kind::any || b.kind == Kind::any) return like(a, Kind::any);
  if (a.kind == Kind::normal && b.kind == Kind::normal) return like(a, Kind::normal);
  if (a.kind == Kind::radial || b.kind == Kind::radial) return like(a, a.kind == b.kind ? Kind::any : Kind::radial);
  SpaceTag result = like(a, Kind::direction);
  const bool bothDirections = a.kind == Kind::direction && b.kind == Kind::direction;
  result.onRay = bothDirections && a.onRay && b.onRay;
  // (origin - center) + t * direction
  if (bothDirections && ((a.onRay && a.scaled && !b.onRay) || (b.onRay && b.scaled && !a.onRay)))
    return like(a, Kind::radial);
  return result;
}

// True if a constant offset keeps the value a point. A constant plus any other vector, or plus a scaled point, can be a
// color: 0.5 + 0.5 * normal.
bool movesPoint(const SpaceTag& tag) { return tag.kind == Kind::point && !tag.scaled; }

SpaceTag sumOfTerms(const SpaceTag& a, const SpaceTag& b) {
  SpaceTag result = a;
  result.index = a.index | b.index;
  SpaceTag other = b;
  other.index = result.index;
  if ((a.index & b.index) != 0 || !(result == other)) return unknownTag();
  if (result.index != 7) return result;
  return transformed({result.map, result.covariant, false}, geometricTag(result.map.from, result.operand));
}

}  // namespace

SpaceTag unknownTag() {
  SpaceTag tag;
  tag.kind = Kind::unknown;
  return tag;
}

SpaceTag neutralTag() {
  SpaceTag tag;
  tag.kind = Kind::neutral;
  return tag;
}

SpaceTag geometricTag(Space space, Kind kind) {
  SpaceTag tag;
  tag.kind = kind;
  tag.space = space;
  return tag;
}

SpaceTag joined(const SpaceTag& a, const SpaceTag& b) {
  if (a == b) return a;
  if (a.kind == Kind::undefined) return b;
  if (b.kind == Kind::undefined) return a;
  if (a.kind == Kind::unknown || b.kind == Kind::unknown) return unknownTag();
  if (a.kind == Kind::neutral || b.kind == Kind::neutral) {
    SpaceTag result = a.kind == Kind::neutral ? b : a;
    result.w = joinedW(a.w, b.w);
    return result;
  }
  if (!a.geometric() || !b.geometric() || !sameSpace(a, b)) return unknownTag();
  SpaceTag result = like(a, a.kind == b.kind ? a.kind : Kind::any);
  result.w = joinedW(a.w, b.w);
  result.scaled = a.scaled || b.scaled;
  result.onRay = a.onRay && b.onRay && a.kind == b.kind;
  result.untranslated = a.untranslated && b.untranslated;
  result.fromMesh = a.fromMesh || b.fromMesh;
  return result;
}

SpaceTag sumOf(const SpaceTag& a, const SpaceTag& b) {
  if (a.kind == Kind::undefined || b.kind == Kind::undefined) return {};
  if (a.kind == Kind::term && b.kind == Kind::term) return sumOfTerms(a, b);
  const W w = sumOfW(a.w, b.w);
  SpaceTag result = unknownTag();
  if (a.kind == Kind::neutral && b.kind == Kind::neutral)
    result = neutralTag();
  else if (a.kind == Kind::neutral && movesPoint(b))
    result = like(b, Kind::point);
  else if (b.kind == Kind::neutral && movesPoint(a))
    result = like(a, Kind::point);
  else if (a.geometric() && b.geometric() && sameSpace(a, b))
    result = a.kind == Kind::point ? pointPlus(a, b) : b.kind == Kind::point ? pointPlus(b, a) : vectorSum(a, b);
  if (result.kind != Kind::unknown) result.w = w;
  return result;
}

SpaceTag differenceOf(const SpaceTag& a, const SpaceTag& b) {
  if (a.kind == Kind::undefined || b.kind == Kind::undefined) return {};
  const W w = differenceOfW(a.w, b.w);
  SpaceTag result = unknownTag();
  if (a.kind == Kind::neutral && b.kind == Kind::neutral) {
    result = neutralTag();
  } else if (a.kind == Kind::neutral && b.geometric()) {
    if (b.kind == Kind::point) result = like(b, Kind::direction);
  } else if (b.kind == Kind::neutral && a.geometric()) {
    if (a.kind == Kind::point) result = like(a, a.onRay ? Kind::radial : Kind::direction);
  } else if (a.geometric() && b.geometric() && sameSpace(a, b)) {
    if (a.kind == Kind::point && b.kind == Kind::point)
      result = like(a, a.onRay && !b.onRay ? Kind::radial : Kind::direction);
    else if (a.kind == Kind::point)
      result = pointPlus(a, b);
    else
      result = b.kind == Kind::point ? like(a, Kind::any) : vectorSum(a, b);
  }
  if (result.kind != Kind::unknown) result.w = w;
  return result;
}

SpaceTag scaledTag(const SpaceTag& tag) {
  if (tag.kind == Kind::matrix || tag.kind == Kind::frame) return tag;
  if (!tag.geometric() && tag.kind != Kind::neutral) return tag.kind == Kind::undefined ? tag : unknownTag();
  SpaceTag result = plain(tag);
  result.scaled = tag.geometric();
  if (result.w != W::none && result.w != W::zero) result.w = W::other;
  return result;
}

SpaceTag productOf(const SpaceTag& vector, const SpaceTag& scalar) {
  if (vector.kind == Kind::undefined || scalar.kind == Kind::undefined) return {};
  const bool component = scalar.geometric() && !scalar.whole();
  if (vector.kind == Kind::row || vector.column) {
    // Row i of a matrix times component i of a vector is a term of the product with the transpose.
    const bool row = vector.kind == Kind::row;
    const Transform transform{vector.map, row, false};
    const SpaceMap map = row ? SpaceMap{vector.map.to, vector.map.from} : vector.map;
    const bool matches = component && scalar.component == vector.index && scalar.space == map.from;
    // All three rows times unknown scalars are the product with an unknown vector.
    if (matches || (row && !scalar.geometric())) {
      SpaceTag term;
      term.kind = Kind::term;
      term.map = map;
      term.covariant = transform.covariant;
      term.index = static_cast<std::uint8_t>(1u << vector.index);
      term.operand = matches ? scalar.kind : Kind::unknown;
      return term;
    }
    if (row) return unknownTag();
  }
  if (vector.kind == Kind::neutral) return scalar.kind == Kind::neutral ? neutralTag() : unknownTag();
  return scaledTag(vector);
}

SpaceTag normalizedTag(const SpaceTag& tag) {
  if (tag.kind == Kind::neutral || tag.kind == Kind::undefined) return tag;
  if (!tag.geometric()) return unknownTag();
  SpaceTag result = plain(tag);
  result.scaled = result.onRay = result.untranslated = false;
  if (tag.kind == Kind::point) result.kind = Kind::radial;
  result.w = tag.w == W::none || tag.w == W::zero ? tag.w : W::other;
  return result;
}

SpaceTag crossOf(const SpaceTag& a, const SpaceTag& b) {
  if (a.kind == Kind::undefined || b.kind == Kind::undefined) return {};
  if (a.kind == Kind::neutral && b.kind == Kind::neutral) return neutralTag();
  if (a.kind == Kind::neutral && b.geometric()) return like(b, Kind::any);
  if (b.kind == Kind::neutral && a.geometric()) return like(a, Kind::any);
  if (!a.geometric() || !b.geometric() || !sameSpace(a, b)) return unknownTag();
  if (a.kind == Kind::direction && b.kind == Kind::direction) return like(a, Kind::normal);
  if (a.kind == Kind::normal && b.kind == Kind::normal) return like(a, Kind::direction);
  return like(a, Kind::any);
}

SpaceTag componentOf(const SpaceTag& vector, std::uint32_t i) {
  if (vector.kind == Kind::undefined) return vector;
  if (vector.kind == Kind::row && i == kWholeVector) {  // the translation
    SpaceTag tag = geometricTag(vector.map.to, Kind::point);
    tag.component = vector.index;
    tag.translation = tag.fromMesh = true;
    return tag;
  }
  if (vector.kind == Kind::neutral) return neutralTag();
  if (vector.kind == Kind::barycentric && vector.whole() && i < 2) {
    SpaceTag tag = vector;
    tag.component = static_cast<std::uint8_t>(i);
    return tag;
  }
  if (i == kWholeVector && (vector.w == W::zero || vector.w == W::one)) return neutralTag();
  if (!vector.geometric() || !vector.whole() || i >= kWholeVector) return unknownTag();
  SpaceTag tag = vector;
  tag.component = static_cast<std::uint8_t>(i);
  tag.w = W::none;
  return tag;
}

Transform transformOf(const SpaceMap& map, bool transposed, bool affine) {
  return transposed ? Transform{{map.to, map.from}, true, affine} : Transform{map, false, affine};
}

SpaceTag transformed(const Transform& transform, const SpaceTag& vector) {
  if (vector.kind == Kind::undefined) return vector;
  if (vector.geometric() && vector.space != transform.map.from) return unknownTag();
  const Space to = transform.map.to;
  const bool rigid = transform.map.from == Space::camera || to == Space::camera;
  SpaceTag result = geometricTag(to, Kind::any);
  result.fromMesh = true;
  if (transform.affine && vector.w == W::one) result.kind = Kind::point;
  if (transform.affine && vector.w != W::zero) return result;
  if (!vector.geometric()) return result;
  switch (vector.kind) {
    case Kind::point: result.untranslated = true; break;
    case Kind::direction:
      if (transform.covariant && !rigid) break;
      result.kind = Kind::direction;
      result.onRay = vector.onRay;
      break;
    case Kind::normal: result.kind = Kind::normal; break;
    case Kind::radial: result.kind = transform.covariant ? Kind::normal : Kind::radial; break;
    default:
      if (transform.covariant && !rigid) result.kind = Kind::normal;
  }
  return result;
}

std::string nameOf(Space space) {
  switch (space) {
    case Space::world: return "world space";
    case Space::object: return "object space";
    case Space::camera: return "camera space";
    default: return "an unknown space";
  }
}

std::string describe(const SpaceTag& tag) {
  const char* kind = tag.kind == Kind::point       ? "a position"
                     : tag.kind == Kind::direction ? "a direction"
                     : tag.kind == Kind::normal    ? "a normal"
                                                   : "a vector";
  return fmt::format("{} in {}", kind, nameOf(tag.space));
}

}  // namespace quintet::check

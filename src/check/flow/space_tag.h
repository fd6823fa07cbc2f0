// SPDX-License-Identifier: Apache-2.0
// What a value means geometrically: point, direction or normal, and its coordinate space. Tags form a lattice; the
// functions below are the rules of vector algebra on tags.
#ifndef QUINTET_CHECK_FLOW_SPACE_TAG_H
#define QUINTET_CHECK_FLOW_SPACE_TAG_H

#include <cstdint>
#include <string>

namespace quintet::check {

enum class Space : std::uint8_t { none, world, object, camera };

// An affine transform. A matrix with this transform maps points and directions; its transpose maps normals back.
struct SpaceMap {
  Space from = Space::none;
  Space to = Space::none;
  bool operator==(const SpaceMap&) const = default;
};

constexpr std::uint8_t kWholeVector = 3;  // SpaceTag::component

struct SpaceTag {
  enum class Kind : std::uint8_t {
    undefined,  // no value seen so far
    neutral,    // a constant or a parameter of the program: it can be meant in any space
    any,        // of a known space, but not known whether point, direction or normal
    point,
    direction,
    normal,
    radial,       // from a point, such as a center, to a point on the ray
    matrix,       // transform `map`, or its transpose
    frame,        // matrix whose columns are vectors of `space`
    row,          // row `index` of an affine matrix: the linear part and the translation
    term,         // sum of some of the three terms of a product of matrix and vector
    address,      // buffer address of the library's array `array`
    barycentric,  // weights of the vertices 1 and 2 at a triangle hit; as a scalar, weight `component` + 1
    unknown,
  };
  // Component w of a vec4.
  enum class W : std::uint8_t { none, zero, one, other };
  enum class Array : std::uint8_t { none, positions, normals, tangents, parameters };

  Kind kind = Kind::undefined;
  Space space = Space::none;
  std::uint8_t component = kWholeVector;  // for a scalar that is component 0, 1 or 2 of such a vector
  W w = W::none;
  bool scaled = false;    // times a factor
  bool onRay = false;     // point: origin + t * direction. direction: of the ray
  bool fromMesh = false;  // depends on vertices of a mesh or was transformed, so the space is more than a convention
  bool untranslated = false;       // any: a point times a matrix without its translation
  bool translation = false;        // point: the translation of a matrix
  bool column = false;             // direction: column `index` of a matrix
  bool transposed = false;         // matrix
  bool covariant = false;          // term: the result transforms like a normal
  SpaceMap map;                    // of matrix, row, column and term
  std::uint8_t index = 0;          // of row and column; of a term: bits of the terms in the sum
  Kind operand = Kind::undefined;  // term: kind of the vector
  Array array = Array::none;

  bool operator==(const SpaceTag&) const = default;
  // True for vectors and components of a known space.
  bool geometric() const { return kind >= Kind::any && kind <= Kind::radial; }
  bool whole() const { return component == kWholeVector; }
};

using SpaceKind = SpaceTag::Kind;

SpaceTag unknownTag();
SpaceTag neutralTag();
SpaceTag geometricTag(Space space, SpaceKind kind);

// The tag of a choice between two values.
SpaceTag joined(const SpaceTag& a, const SpaceTag& b);
SpaceTag sumOf(const SpaceTag& a, const SpaceTag& b);
SpaceTag differenceOf(const SpaceTag& a, const SpaceTag& b);
// A vector or component times a scalar.
SpaceTag scaledTag(const SpaceTag& tag);
// A vector times a scalar, which can be the component of a different vector.
SpaceTag productOf(const SpaceTag& vector, const SpaceTag& scalar);
SpaceTag normalizedTag(const SpaceTag& tag);
SpaceTag crossOf(const SpaceTag& a, const SpaceTag& b);
// Component i of a vector.
SpaceTag componentOf(const SpaceTag& vector, std::uint32_t i);

// How a matrix acts on a vector at its right.
struct Transform {
  SpaceMap map;
  bool covariant = false;  // maps normals
  bool affine = false;     // has a translation
};
Transform transformOf(const SpaceMap& map, bool transposed, bool affine);
SpaceTag transformed(const Transform& transform, const SpaceTag& vector);

std::string nameOf(Space space);            // "world space"
std::string describe(const SpaceTag& tag);  // "a normal in object space"

}  // namespace quintet::check
#endif

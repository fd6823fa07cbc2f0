#include "scene/scene_toml_solid.h"

#include <fmt/format.h>

#include "scene/scene_toml_transform.h"

namespace quintet::scene {
namespace {

// The solid about the origin, and where its centre is.
struct Shape {
  mat4 scaled{1.0f};
  vec3 center{0.0f};
  float parameter = 0.25f;
};

// A rotation that takes +y to `axis` (unit).
mat4 turnY(const vec3& axis) {
  const glm::dvec3 to = glm::normalize(glm::dvec3(axis));
  if (to.y < -0.999999999) return glm::scale(mat4(1.0f), vec3(1, -1, -1));  // half a turn about x
  const glm::dquat q = glm::normalize(glm::dquat(1.0 + to.y, glm::cross(glm::dvec3(0, 1, 0), to)));
  return mat4(glm::mat4_cast(q));
}

vec3 readAxis(TomlReader& reader) {
  const TomlValue* value = reader.find("axis");
  if (!value) return {0, 1, 0};
  if (value->kind != TomlValue::Kind::text) return reader.toDirection(*value, "axis");
  vec3 axis(0.0f);
  axis[reader.choice("axis", {"x", "y", "z"}, 1)] = 1.0f;
  return axis;
}

Shape readSphere(TomlReader& reader) {
  Shape shape;
  shape.center = reader.triple("center", vec3(0.0f));
  shape.scaled = glm::scale(mat4(1.0f), vec3(reader.number("radius", 1.0f, kPositive)));
  return shape;
}

Shape readBox(TomlReader& reader) {
  Shape shape;
  const TomlValue *low = reader.find("min"), *high = reader.find("max");
  if (low || high) {
    const glm::dvec3 a(reader.toTriple(reader.require("min"), "min")), b(reader.toTriple(reader.require("max"), "max"));
    if (!glm::all(glm::lessThan(a, b)))
      reader.fail(*low, fmt::format("'min' of {} must be below 'max' on each axis", reader.what()));
    for (const char* other : {"center", "size"})
      if (const TomlValue* value = reader.find(other))
        reader.fail(*value, fmt::format("'min' and '{}' of {} exclude each other", other, reader.what()));
    shape.center = vec3(0.5 * (a + b));
    shape.scaled = glm::scale(mat4(1.0f), vec3(0.5 * (b - a)));
    return shape;
  }
  shape.center = reader.triple("center", vec3(0.0f));
  vec3 size(2.0f);
  if (const TomlValue* value = reader.find("size"))
    size = value->isNumber() ? vec3(reader.toNumber(*value, "size", kPositive))
                             : reader.toTriple(*value, "size", kPositive);
  shape.scaled = glm::scale(mat4(1.0f), 0.5f * size);
  return shape;
}

// Cylinder and cone: from the middle of the base to that of the top or to the apex, or centre, axis and height.
Shape readColumn(TomlReader& reader) {
  Shape shape;
  const float radius = reader.number("radius", 1.0f, kPositive);
  const TomlValue *from = reader.find("from"), *to = reader.find("to");
  vec3 axis(0, 1, 0);
  float height = 2.0f;
  if (from || to) {
    const glm::dvec3 a(reader.toTriple(reader.require("from"), "from")), b(reader.toTriple(reader.require("to"), "to"));
    for (const char* other : {"center", "axis", "height"})
      if (const TomlValue* value = reader.find(other))
        reader.fail(*value, fmt::format("'from' and '{}' of {} exclude each other", other, reader.what()));
    height = static_cast<float>(glm::length(b - a));
    if (!(height > 0.0f)) reader.fail(*from, fmt::format("'from' and 'to' of {} are the same point", reader.what()));
    axis = vec3((b - a) / glm::length(b - a));
    shape.center = vec3(0.5 * (a + b));
  } else {
    shape.center = reader.triple("center", vec3(0.0f));
    axis = readAxis(reader);
    height = reader.number("height", 2.0f, kPositive);
  }
  shape.scaled = glm::scale(turnY(axis), vec3(radius, 0.5f * height, radius));
  return shape;
}

Shape readTorus(TomlReader& reader) {
  Shape shape;
  shape.center = reader.triple("center", vec3(0.0f));
  const float radius = reader.number("radius", 1.0f, kPositive);
  const float tube = reader.number("tube", 0.25f * radius, kPositive);
  shape.parameter = tube / radius;
  if (!(shape.parameter > 0.0f && shape.parameter < 1.0f))
    reader.fail(reader.table(), fmt::format("'tube' of {} must be smaller than its 'radius'", reader.what()));
  shape.scaled = glm::scale(turnY(readAxis(reader)), vec3(radius));
  return shape;
}

Shape readShape(TomlReader& reader, PrimitiveType type) {
  switch (type) {
    case PrimitiveType::sphere: return readSphere(reader);
    case PrimitiveType::box: return readBox(reader);
    case PrimitiveType::cylinder:
    case PrimitiveType::cone: return readColumn(reader);
    case PrimitiveType::torus: break;
  }
  return readTorus(reader);
}

}  // namespace

Primitive readSolid(SceneTomlContext& context, TomlReader& reader, PrimitiveType type, const mat4& outer,
                    int material) {
  const Shape shape = readShape(reader, type);
  Primitive primitive;
  primitive.type = type;
  primitive.parameter = shape.parameter;
  primitive.objectFromPrimitive =
      outer * glm::translate(mat4(1.0f), shape.center) * readTransform(reader) * shape.scaled;
  checkInvertible(reader, reader.table(), primitive.objectFromPrimitive);
  const int own = context.readMaterialKey(reader);
  primitive.material = own == kNone ? material : own;
  reader.finish();
  return primitive;
}

}  // namespace quintet::scene

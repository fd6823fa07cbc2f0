#include "scene/scene_toml_transform.h"

#include <fmt/format.h>

#include "scene/keyframes.h"

namespace quintet::scene {
namespace {

using glm::dmat4;
using glm::dquat;
using glm::dvec3;

bool isFinite(const mat4& m) {
  for (int column = 0; column < 4; ++column)
    if (!quintet::isFinite(vec3(m[column]))) return false;
  return true;
}

vec3 readScale(const TomlReader& reader, const TomlValue& value) {
  const vec3 scale = value.isNumber() ? vec3(reader.toNumber(value, "scale")) : reader.toTriple(value, "scale");
  if (scale.x == 0.0f || scale.y == 0.0f || scale.z == 0.0f)
    reader.fail(value, fmt::format("'scale' of {} must not be 0", reader.what()));
  return scale;
}

// 16 numbers column by column, as in glTF, or 3 or 4 rows as one writes them on paper.
mat4 readMatrix(const TomlReader& reader, const TomlValue& value) {
  mat4 m(1.0f);
  const bool rows = value.kind == TomlValue::Kind::array && (value.elements.size() == 3 || value.elements.size() == 4);
  if (rows) {
    for (std::size_t row = 0; row < value.elements.size(); ++row) {
      const std::vector<float> numbers = reader.toNumbers(value.elements[row], "matrix", 4);
      for (std::size_t column = 0; column < 4; ++column) m[column][row] = numbers[column];
    }
  } else {
    const std::vector<float> numbers = reader.toNumbers(value, "matrix", 16);
    for (std::size_t i = 0; i < 16; ++i) m[i / 4][i % 4] = numbers[i];
  }
  if (vec4(m[0].w, m[1].w, m[2].w, m[3].w) != vec4(0, 0, 0, 1))
    reader.fail(value, fmt::format("the last row of 'matrix' of {} must be 0 0 0 1", reader.what()));
  return m;
}

}  // namespace

quat readRotation(const TomlReader& reader, const TomlValue& value) {
  if (value.kind == TomlValue::Kind::array) {
    const dvec3 angles = glm::radians(dvec3(reader.toTriple(value, "rotate")));
    return quat(glm::angleAxis(angles.z, dvec3(0, 0, 1)) * glm::angleAxis(angles.y, dvec3(0, 1, 0)) *
                glm::angleAxis(angles.x, dvec3(1, 0, 0)));
  }
  TomlReader inner(reader.toTable(value, "rotate"), fmt::format("'rotate' of {}", reader.what()), reader.file());
  quat rotation(1, 0, 0, 0);
  if (const TomlValue* numbers = inner.find("quaternion")) {
    const std::vector<float> n = inner.toNumbers(*numbers, "quaternion", 4);
    const dquat q(static_cast<double>(n[3]), static_cast<double>(n[0]), static_cast<double>(n[1]),
                  static_cast<double>(n[2]));
    if (!(glm::length(q) > 0.0)) inner.fail(*numbers, "a quaternion must not be 0");
    rotation = quat(glm::normalize(q));
  } else {
    const vec3 axis = inner.toDirection(inner.require("axis"), "axis");
    rotation =
        quat(glm::angleAxis(glm::radians(static_cast<double>(inner.toNumber(inner.require("degrees"), "degrees"))),
                            glm::normalize(dvec3(axis))));
  }
  inner.finish();
  return rotation;
}

Keyframe readParts(TomlReader& reader, const Keyframe& fallback) {
  Keyframe key = fallback;
  key.translation = reader.triple("translate", fallback.translation);
  if (const TomlValue* rotate = reader.find("rotate")) key.rotation = readRotation(reader, *rotate);
  if (const TomlValue* scale = reader.find("scale")) key.scale = readScale(reader, *scale);
  return key;
}

mat4 readTransform(TomlReader& reader) {
  const Keyframe parts = readParts(reader);
  const TomlValue* matrix = reader.find("matrix");
  if (!matrix) {
    const mat4 m = matrixOf(parts);
    checkInvertible(reader, reader.table(), m);
    return m;
  }
  for (const char* other : {"translate", "rotate", "scale"})
    if (reader.has(other))
      reader.fail(*matrix, fmt::format("'matrix' and '{}' of {} exclude each other", other, reader.what()));
  const mat4 m = readMatrix(reader, *matrix);
  checkInvertible(reader, *matrix, m);
  return m;
}

void checkInvertible(const TomlReader& reader, const TomlValue& at, const mat4& matrix) {
  const dmat4 m(matrix);
  if (!isFinite(matrix) || glm::determinant(glm::dmat3(m)) == 0.0 || !isFinite(mat4(glm::inverse(m))))
    reader.fail(at, fmt::format("the transform of {} has no inverse", reader.what()));
}

}  // namespace quintet::scene

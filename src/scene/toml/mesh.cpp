// SPDX-License-Identifier: Apache-2.0
// [[mesh]]: triangles from lists or from a named shape.
#include <algorithm>

#include <fmt/format.h>

#include "base/plural.h"
#include "scene/animation/deform.h"
#include "scene/geometry/repair.h"
#include "scene/geometry/shapes.h"
#include "scene/geometry/tangents.h"
#include "scene/model/limits.h"
#include "scene/toml/context.h"
#include "scene/toml/transform.h"

namespace quintet::scene {
namespace {

constexpr std::uint32_t kMaxSegments = 4096;

template <class T, class Convert>
std::vector<T> readList(TomlReader& reader, const std::string& key, std::size_t count, const Convert& convert) {
  const TomlValue* value = reader.find(key);
  std::vector<T> result;
  if (!value) return result;
  for (const TomlValue& element : reader.list(key)) result.push_back(convert(element));
  if (result.size() != count)
    reader.fail(*value, fmt::format("'{}' of {} has {} for {}", key, reader.what(), counted(result.size(), "element"),
                                    counted(count, "position")));
  return result;
}

void readTriangles(TomlReader& reader, Geometry& geometry) {
  const auto count = static_cast<std::uint32_t>(geometry.positions.size());
  const TomlValue* indices = reader.find("indices");
  if (!indices) {
    if (count % 3 != 0)
      reader.fail(reader.table(), fmt::format("{} has {} and no 'indices'; the number must be a multiple of 3",
                                              reader.what(), counted(count, "position")));
    for (std::uint32_t i = 0; i < count; i += 3) geometry.triangles.push_back({i, i + 1, i + 2});
    return;
  }
  const std::vector<TomlValue>& list = reader.list("indices");
  std::vector<std::uint32_t> flat;
  for (const TomlValue& element : list) {  // [[0, 1, 2], ...] or [0, 1, 2, ...]
    if (element.kind != TomlValue::Kind::array) {
      flat.push_back(reader.toInteger(element, "indices", 0, count - 1));
      continue;
    }
    if (element.elements.size() != 3)
      reader.fail(element, fmt::format("each triangle in 'indices' of {} must have 3 vertices", reader.what()));
    for (const TomlValue& index : element.elements) flat.push_back(reader.toInteger(index, "indices", 0, count - 1));
  }
  if (flat.size() % 3 != 0)
    reader.fail(*indices, fmt::format("'indices' of {} has {}; the number must be a multiple of 3", reader.what(),
                                      counted(flat.size(), "number")));
  for (std::size_t i = 0; i < flat.size(); i += 3) geometry.triangles.push_back({flat[i], flat[i + 1], flat[i + 2]});
}

Geometry readVertices(TomlReader& reader) {
  Geometry geometry;
  const TomlValue& positions = reader.require("positions");
  for (const TomlValue& element : reader.list("positions"))
    geometry.positions.push_back(reader.toTriple(element, "positions"));
  if (geometry.positions.empty()) reader.fail(positions, fmt::format("'positions' of {} is empty", reader.what()));
  const std::size_t count = geometry.positions.size();
  readTriangles(reader, geometry);
  geometry.normals =
      readList<vec3>(reader, "normals", count, [&](const TomlValue& v) { return reader.toDirection(v, "normals"); });
  geometry.uvs[0] = readList<vec2>(reader, "uvs", count, [&](const TomlValue& v) { return reader.toPair(v, "uvs"); });
  geometry.uvs[1] =
      readList<vec2>(reader, "uvs_1", count, [&](const TomlValue& v) { return reader.toPair(v, "uvs_1"); });
  geometry.colors = readList<vec4>(reader, "colors", count, [&](const TomlValue& v) {
    if (v.kind != TomlValue::Kind::array || v.elements.size() != 4)
      return vec4(toColor(reader, v, "colors", kNotNegative), 1.0f);
    const std::vector<float> n = reader.toNumbers(v, "colors", 4, kNotNegative);
    return vec4(n[0], n[1], n[2], n[3]);
  });
  return geometry;
}

// One number or a list of two.
uvec2 readSegments(TomlReader& reader, const uvec2& fallback, const uvec2& low) {
  const TomlValue* value = reader.find("segments");
  if (!value) return fallback;
  if (value->kind != TomlValue::Kind::array)
    return uvec2(reader.toInteger(*value, "segments", std::max(low.x, low.y), kMaxSegments));
  if (value->elements.size() != 2)
    reader.fail(*value, fmt::format("'segments' of {} must be one integer or two", reader.what()));
  return {reader.toInteger(value->elements[0], "segments", low.x, kMaxSegments),
          reader.toInteger(value->elements[1], "segments", low.y, kMaxSegments)};
}

vec2 readSize2(TomlReader& reader) {
  const TomlValue* value = reader.find("size");
  if (!value) return vec2(2.0f);
  return value->isNumber() ? vec2(reader.toNumber(*value, "size", kPositive))
                           : reader.toPair(*value, "size", kPositive);
}

vec3 readSize3(TomlReader& reader) {
  const TomlValue* value = reader.find("size");
  if (!value) return vec3(2.0f);
  return value->isNumber() ? vec3(reader.toNumber(*value, "size", kPositive))
                           : reader.toTriple(*value, "size", kPositive);
}

Geometry readShape(SceneTomlContext& context, TomlReader& reader) {
  constexpr std::size_t kBytesPerQuad = 100;  // upper bound for one vertex and two triangles
  const auto take = [&](std::size_t quads) { context.budget.take(quads * kBytesPerQuad); };
  switch (reader.choice("shape", {"quad", "plane", "cube", "uv_sphere", "tetrahedron"}, 0)) {
    case 0:
    case 1: {
      const vec2 size = readSize2(reader);
      const uvec2 segments = readSegments(reader, uvec2(1), uvec2(1));
      take(static_cast<std::size_t>(segments.x) * segments.y);
      return reader.text("shape") == "quad" ? makeQuad(size, segments) : makePlane(size, segments);
    }
    case 2: {
      const vec3 size = readSize3(reader);
      const std::uint32_t segments = reader.integer("segments", 1, 1, kMaxSegments);
      take(std::size_t{6} * segments * segments);
      return makeCube(size, segments);
    }
    case 3: {
      const uvec2 segments = readSegments(reader, {32, 16}, {3, 2});
      take(static_cast<std::size_t>(segments.x) * segments.y);
      return makeUvSphere(reader.number("radius", 1.0f, kPositive), segments.x, segments.y);
    }
    default: return makeTetrahedron(reader.number("radius", 1.0f, kPositive));
  }
}

void readMesh(SceneTomlContext& context, const TomlValue& table) {
  TomlReader reader(table, describeTable("mesh", table), context.file);
  const TomlValue* nameValue = reader.find("name");
  const std::string name = reader.text("name");
  if (nameValue) context.checkName(*nameValue, name);
  const TomlValue* source = reader.findOneOf({"shape", "positions"});
  if (!source) reader.fail(table, fmt::format("{} needs 'shape' or 'positions'", reader.what()));
  Geometry geometry = reader.has("shape") ? readShape(context, reader) : readVertices(reader);
  if (reader.boolean("flat")) geometry.normals.clear();
  const int material = context.readMaterialKey(reader);
  geometry.material = material == kNone ? context.defaultMaterial() : material;
  const mat4 transform = readTransform(reader);
  if (transform != mat4(1.0f)) applyTransform(geometry, transform);
  for (const vec3& p : geometry.positions)
    if (!isWithinLimits(p))
      reader.fail(*source,
                  fmt::format("{} is too large: its coordinates can be at most {:g}", reader.what(), kMaxCoordinate));
  const std::size_t mesh = static_cast<std::size_t>(context.meshFor(reader, name, false));
  reader.rejectUnknownKeys();
  repairNormals(geometry);
  addTangents(geometry, context.scene.materials[static_cast<std::size_t>(geometry.material)]);
  context.scene.meshes[mesh].geometries.push_back(std::move(geometry));
}

}  // namespace

void readMeshes(SceneTomlContext& context, TomlReader& root) {
  for (const TomlValue& table : root.tables("mesh")) readMesh(context, table);
}

}  // namespace quintet::scene

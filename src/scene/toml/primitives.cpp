// SPDX-License-Identifier: Apache-2.0
// [[spheres]], [[boxes]], [[cylinders]], [[cones]], [[tori]], [[csg]] and [[custom]]: sets of procedural primitives.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/suggestion.h"
#include "scene/toml/context.h"
#include "scene/toml/transform.h"

namespace quintet::scene {
namespace {

// ---- One solid ----

// The solid at the origin, and its center.
struct Shape {
  mat4 scaled{1.0f};
  vec3 center{0.0f};
  float parameter = 0.25f;
};

// A rotation that maps +y to `axis` (unit).
mat4 rotationFromY(const vec3& axis) {
  const glm::dvec3 to = glm::normalize(glm::dvec3(axis));
  if (to.y < -0.999999999) return glm::scale(mat4(1.0f), vec3(1, -1, -1));  // 180° about x
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
        reader.fail(*value, fmt::format("'min' and '{}' of {} are mutually exclusive", other, reader.what()));
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

// Cylinder and cone: `from` (center of the base) and `to` (center of the top, or apex); or center, axis and height.
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
        reader.fail(*value, fmt::format("'from' and '{}' of {} are mutually exclusive", other, reader.what()));
    height = static_cast<float>(glm::length(b - a));
    if (!(height > 0.0f)) reader.fail(*from, fmt::format("'from' and 'to' of {} are the same point", reader.what()));
    axis = vec3((b - a) / glm::length(b - a));
    shape.center = vec3(0.5 * (a + b));
  } else {
    shape.center = reader.triple("center", vec3(0.0f));
    axis = readAxis(reader);
    height = reader.number("height", 2.0f, kPositive);
  }
  shape.scaled = glm::scale(rotationFromY(axis), vec3(radius, 0.5f * height, radius));
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
  shape.scaled = glm::scale(rotationFromY(readAxis(reader)), vec3(radius));
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

// Reads the keys of a solid, its transform and `material`, and rejects other keys:
//   outer · T(center) · translate · rotate · scale · (the solid at the origin)
// `material` applies without the key.
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
  reader.rejectUnknownKeys();
  return primitive;
}

// ---- CSG trees ----

constexpr std::size_t kMaxCsgNodes = 1u << 16;  // per tree

constexpr std::array<const char*, 5> kSolids{"sphere", "box", "cylinder", "cone",
                                             "torus"};  // in the order of PrimitiveType
constexpr std::array<const char*, 3> kOperations{"union", "intersection", "difference"};  // CsgOperation 1, 2, 3

// Appends one tree to a set, in postfix order.
class TreeReader {
 public:
  TreeReader(SceneTomlContext& context, PrimitiveSet& set) : context_(context), set_(set) {}

  // `outer` and `material` are inherited from the nodes above.
  void read(const TomlValue& node, const std::string& what, const mat4& outer, int material) {
    TomlReader reader(node, what, context_.file);
    const mat4 transform = outer * readTransform(reader);
    checkInvertible(reader, node, transform);
    if (const int own = context_.readMaterialKey(reader); own != kNone) material = own;
    const TomlValue* content =
        reader.findOneOf({"sphere", "box", "cylinder", "cone", "torus", "union", "intersection", "difference", "csg"});
    reader.rejectUnknownKeys();
    if (!content)
      reader.fail(
          node, fmt::format("{} needs one of sphere, box, cylinder, cone, torus, union, intersection, difference, csg",
                            what));
    for (std::size_t i = 0; i < kSolids.size(); ++i)
      if (reader.find(kSolids[i]))
        return addLeaf(*content, fmt::format("'{}' of {}", kSolids[i], what), static_cast<PrimitiveType>(i), transform,
                       material);
    for (std::size_t i = 0; i < kOperations.size(); ++i)
      if (reader.find(kOperations[i]))
        return addOperation(*content, kOperations[i], static_cast<CsgOperation>(i + 1), transform, material);
    addNamed(reader, *content, transform, material);
  }

 private:
  void push(const TomlValue& at, const CsgNode& node) {
    if (set_.nodes.size() - first_ >= kMaxCsgNodes)
      context_.fail(at, fmt::format("the tree has more than {} nodes", kMaxCsgNodes));
    set_.nodes.push_back(node);
  }

  void addLeaf(const TomlValue& at, const std::string& what, PrimitiveType type, const mat4& transform, int material) {
    TomlReader reader(at, what, context_.file);
    push(at, {CsgOperation::leaf, static_cast<std::uint32_t>(set_.primitives.size())});
    set_.primitives.push_back(readSolid(context_, reader, type, transform, material));
  }

  void addOperation(const TomlValue& list, const char* name, CsgOperation operation, const mat4& transform,
                    int material) {
    if (list.kind != TomlValue::Kind::array || list.elements.size() < 2)
      context_.fail(list, fmt::format("'{}' must be a list of at least two operands", name));
    for (std::size_t i = 0; i < list.elements.size(); ++i) {
      read(list.elements[i], fmt::format("operand {} of '{}'", i, name), transform, material);
      if (i > 0) push(list.elements[i], {operation, 0});
    }
  }

  // Appends a copy of an earlier tree.
  void addNamed(const TomlReader& reader, const TomlValue& value, const mat4& transform, int material) {
    const std::string name = reader.toText(value, "csg");
    const auto found = context_.trees.find(name);
    if (found == context_.trees.end()) {
      std::vector<std::string> names;
      for (const auto& [known, tree] : context_.trees) names.push_back(known);
      context_.fail(value, fmt::format("no [[csg]] '{}' with one tree found above{}", name, suggestion(name, names)));
    }
    const auto& [other, target] = found->second;
    if (!target.empty()) context_.targets.at(target).placedByDefault = false;
    for (CsgNode node : other.nodes) {
      if (node.operation == CsgOperation::leaf) {
        Primitive primitive = other.primitives[node.primitive];
        if (primitive.material == kNone) primitive.material = material;
        primitive.objectFromPrimitive = transform * primitive.objectFromPrimitive;
        checkInvertible(reader, value, primitive.objectFromPrimitive);
        node.primitive = static_cast<std::uint32_t>(set_.primitives.size());
        set_.primitives.push_back(primitive);
      }
      push(value, node);
    }
  }

  SceneTomlContext& context_;
  PrimitiveSet& set_;
  const std::size_t first_ = set_.nodes.size();
};

void readTree(SceneTomlContext& context, const TomlValue& node, const std::string& what, const mat4& outer,
              int material, PrimitiveSet& set) {
  const auto first = static_cast<std::uint32_t>(set.nodes.size());
  TreeReader(context, set).read(node, what, outer, material);
  const std::vector<CsgNode> ordered = orderForSmallStack(std::span(set.nodes).subspan(first));
  std::ranges::copy(ordered, set.nodes.begin() + first);
  if (const std::uint32_t stack = csgStackSize(ordered); stack > kMaxCsgStack)
    context.fail(
        node,
        fmt::format("{} needs a stack of {} solids, the maximum is {}; nest fewer differences in the second operand of "
                    "differences",
                    what, stack, kMaxCsgStack));
  const CsgTree tree{first, static_cast<std::uint32_t>(set.nodes.size()) - first};
  const Bounds3 bounds = boundsOf(set, tree);
  if (bounds.empty())
    context.scene.report.ignored.push_back(
        fmt::format("line {}: {} is empty: the boxes of an intersection are disjoint", node.line, what));
  else if (!isFinite(bounds.min) || !isFinite(bounds.max))
    context.fail(node, fmt::format("{} is too large", what));
  set.trees.push_back(tree);
  context.budget.take(tree.nodeCount * (sizeof(CsgNode) + 3 * sizeof(Primitive)));
}

void readCsg(SceneTomlContext& context, const TomlValue& table) {
  TomlReader reader(table, describeTable("csg", table), context.file);
  PrimitiveSet set;
  set.kind = PrimitiveSetKind::csg;
  const TomlValue* nameValue = reader.find("name");
  set.name = reader.text("name");
  if (nameValue) context.checkName(*nameValue, set.name);
  const int material = context.readMaterialKey(reader);
  const mat4 outer = readTransform(reader);
  const TomlValue* content = reader.findOneOf({"tree", "trees"});
  if (!content) reader.fail(table, fmt::format("{} needs 'tree' or 'trees'", reader.what()));
  if (reader.has("tree")) {
    readTree(context, *content, fmt::format("'tree' of {}", reader.what()), outer, material, set);
  } else {
    std::size_t index = 0;
    for (const TomlValue& tree : reader.list("trees"))
      readTree(context, tree, fmt::format("trees[{}] of {}", index++, reader.what()), outer, material, set);
    if (set.trees.empty()) reader.fail(*content, fmt::format("'trees' of {} is empty", reader.what()));
  }
  const auto mesh = static_cast<std::size_t>(context.meshFor(reader, set.name, true));
  reader.rejectUnknownKeys();
  if (!set.name.empty() && set.trees.size() == 1)
    context.trees.emplace(set.name, NamedTree{set, reader.has("object") ? std::string() : set.name});
  context.applyDefaultMaterial(set);
  context.scene.meshes[mesh].primitiveSets.push_back(std::move(set));
}

// ---- Sets of solids and custom boxes ----

constexpr std::size_t kBytesPerSolid = sizeof(Placement) + 2 * sizeof(Primitive) + 2 * sizeof(Bounds3);
constexpr std::size_t kBytesPerBox = sizeof(Placement) + 3 * sizeof(Bounds3);

struct Kind {
  const char* key;
  PrimitiveType type;
};
constexpr std::array<Kind, 5> kKinds{{{"spheres", PrimitiveType::sphere},
                                      {"boxes", PrimitiveType::box},
                                      {"cylinders", PrimitiveType::cylinder},
                                      {"cones", PrimitiveType::cone},
                                      {"tori", PrimitiveType::torus}}};

std::string readName(SceneTomlContext& context, TomlReader& reader) {
  const TomlValue* value = reader.find("name");
  if (!value) return {};
  const std::string name = reader.toText(*value, "name");
  context.checkName(*value, name);
  return name;
}

// Scale of the canonical solid for the size of a placement, which is the radius of a sphere, the outer diameter of a
// torus, or the edge of the cube around any other solid.
float scaleOf(PrimitiveType type, float size, float tube) {
  if (type == PrimitiveType::sphere) return size;
  return type == PrimitiveType::torus ? 0.5f * size / (1.0f + tube) : 0.5f * size;
}

void addPlacements(SceneTomlContext& context, TomlReader& reader, PrimitiveType type, const mat4& outer, int material,
                   PrimitiveSet& set) {
  PlacementOptions options;
  options.bytesEach = kBytesPerSolid;
  if (type == PrimitiveType::sphere) options.sizeKey = "radius";
  const std::vector<Placement> placements = readPlacements(context, reader, options);
  if (placements.empty()) return;
  const float tube = type == PrimitiveType::torus ? reader.number("tube", 0.25f, {0.0, 1.0, true, true}) : 0.25f;
  set.primitives.reserve(set.primitives.size() + placements.size());
  for (Placement placement : placements) {
    placement.size = scaleOf(type, placement.size, tube);
    Primitive& primitive = set.primitives.emplace_back();
    primitive.type = type;
    primitive.parameter = tube;
    primitive.objectFromPrimitive = outer * matrixOf(placement);
    checkInvertible(reader, reader.table(), primitive.objectFromPrimitive);
    primitive.material = placement.material == kNone ? material : placement.material;
  }
}

void checkBounds(const TomlReader& reader, const Bounds3& bounds) {
  if (!isFinite(bounds.min) || !isFinite(bounds.max))
    reader.fail(reader.table(), fmt::format("{} is too large", reader.what()));
}

void readSolids(SceneTomlContext& context, const TomlValue& table, const Kind& kind) {
  TomlReader reader(table, describeTable(kind.key, table), context.file);
  PrimitiveSet set;
  set.name = readName(context, reader);
  const int material = context.readMaterialKey(reader);
  const mat4 outer = readTransform(reader);
  std::size_t index = 0;
  for (const TomlValue& item : reader.list("items")) {
    TomlReader inner(item, fmt::format("items[{}] of {}", index++, reader.what()), context.file);
    set.primitives.push_back(readSolid(context, inner, kind.type, outer, material));
  }
  addPlacements(context, reader, kind.type, outer, material, set);
  if (set.primitives.empty()) reader.fail(table, fmt::format("{} needs 'items', 'random' or 'grid'", reader.what()));
  context.applyDefaultMaterial(set);
  const auto mesh = static_cast<std::size_t>(context.meshFor(reader, set.name, true));
  reader.rejectUnknownKeys();
  checkBounds(reader, boundsOf(set));
  context.scene.meshes[mesh].primitiveSets.push_back(std::move(set));
}

Bounds3 readCustomBox(TomlReader& reader) {
  Bounds3 box;
  const TomlValue* low = reader.find("min");
  if (low || reader.has("max")) {
    box.min = reader.toTriple(reader.require("min"), "min");
    box.max = reader.toTriple(reader.require("max"), "max");
    if (box.empty()) reader.fail(*low, fmt::format("'min' of {} must not be above 'max'", reader.what()));
  } else {
    const glm::dvec3 center(reader.triple("center", vec3(0.0f)));
    vec3 size(2.0f);
    if (const TomlValue* value = reader.find("size"))
      size = value->isNumber() ? vec3(reader.toNumber(*value, "size", kNotNegative))
                               : reader.toTriple(*value, "size", kNotNegative);
    box.min = vec3(center - 0.5 * glm::dvec3(size)), box.max = vec3(center + 0.5 * glm::dvec3(size));
  }
  reader.rejectUnknownKeys();
  checkBounds(reader, box);
  return box;
}

void readCustom(SceneTomlContext& context, const TomlValue& table) {
  TomlReader reader(table, describeTable("custom", table), context.file);
  PrimitiveSet set;
  set.kind = PrimitiveSetKind::custom;
  set.name = readName(context, reader);
  const int material = context.readMaterialKey(reader);
  set.material = material == kNone ? context.defaultMaterial() : material;
  std::size_t index = 0;
  for (const TomlValue& item : reader.list("boxes")) {
    TomlReader inner(item, fmt::format("boxes[{}] of {}", index++, reader.what()), context.file);
    set.boxes.push_back(readCustomBox(inner));
  }
  PlacementOptions options;
  options.bytesEach = kBytesPerBox;
  options.turns = options.materials = false;
  for (const Placement& placement : readPlacements(context, reader, options)) {
    const vec3 half(0.5f * placement.size);
    set.boxes.push_back({placement.center - half, placement.center + half});
  }
  if (set.boxes.empty()) reader.fail(table, fmt::format("{} needs 'boxes', 'random' or 'grid'", reader.what()));
  const auto mesh = static_cast<std::size_t>(context.meshFor(reader, set.name, true));
  reader.rejectUnknownKeys();
  checkBounds(reader, boundsOf(set));
  context.scene.meshes[mesh].primitiveSets.push_back(std::move(set));
}

}  // namespace

void readPrimitives(SceneTomlContext& context, TomlReader& root) {
  // In the order of the file, which determines the numbers of the geometries of an object.
  std::vector<std::pair<const TomlValue*, const Kind*>> tables;
  for (const Kind& kind : kKinds)
    for (const TomlValue& table : root.tables(kind.key)) tables.emplace_back(&table, &kind);
  for (const TomlValue& table : root.tables("custom")) tables.emplace_back(&table, nullptr);
  static constexpr Kind kCsg{"csg", PrimitiveType::sphere};
  for (const TomlValue& table : root.tables("csg")) tables.emplace_back(&table, &kCsg);
  std::ranges::stable_sort(tables, {}, [](const auto& entry) { return entry.first->line; });
  for (const auto& [table, kind] : tables) {
    if (!kind)
      readCustom(context, *table);
    else if (kind == &kCsg)
      readCsg(context, *table);
    else
      readSolids(context, *table, *kind);
  }
}

}  // namespace quintet::scene

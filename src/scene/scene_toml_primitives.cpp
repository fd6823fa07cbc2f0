// [[spheres]], [[boxes]], [[cylinders]], [[cones]], [[tori]] and [[custom]]: sets of procedural primitives.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scene/scene_toml_context.h"
#include "scene/scene_toml_placement.h"
#include "scene/scene_toml_solid.h"
#include "scene/scene_toml_transform.h"

namespace quintet::scene {
namespace {

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

// How the canonical solid becomes one of a random or grid placement's size: a sphere's radius; of the others the
// edge of the cube around it (a torus: its outer diameter).
float scaleOf(PrimitiveType type, float size, float tube) {
  if (type == PrimitiveType::sphere) return size;
  return type == PrimitiveType::torus ? 0.5f * size / (1.0f + tube) : 0.5f * size;
}

void addPlaced(SceneTomlContext& context, TomlReader& reader, PrimitiveType type, const mat4& outer, int material,
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
  addPlaced(context, reader, kind.type, outer, material, set);
  if (set.primitives.empty()) reader.fail(table, fmt::format("{} needs 'items', 'random' or 'grid'", reader.what()));
  context.fillMaterials(set);
  const auto mesh = static_cast<std::size_t>(context.meshFor(reader, set.name, true));
  reader.finish();
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
  reader.finish();
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
  reader.finish();
  checkBounds(reader, boundsOf(set));
  context.scene.meshes[mesh].primitiveSets.push_back(std::move(set));
}

}  // namespace

void readPrimitiveSets(SceneTomlContext& context, TomlReader& root) {
  // In the order of the file, whatever their kind: the geometries of an object are numbered by it.
  std::vector<std::pair<const TomlValue*, const Kind*>> tables;
  for (const Kind& kind : kKinds)
    for (const TomlValue& table : context.tables(root, kind.key)) tables.emplace_back(&table, &kind);
  for (const TomlValue& table : context.tables(root, "custom")) tables.emplace_back(&table, nullptr);
  static constexpr Kind kCsg{"csg", PrimitiveType::sphere};
  for (const TomlValue& table : context.tables(root, "csg")) tables.emplace_back(&table, &kCsg);
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

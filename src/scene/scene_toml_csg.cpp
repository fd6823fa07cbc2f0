// [[csg]]: trees of solids.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scene/scene_toml_context.h"
#include "scene/scene_toml_solid.h"
#include "scene/scene_toml_transform.h"

namespace quintet::scene {
namespace {

constexpr std::size_t kMaxCsgNodes = 1u << 16;  // of one tree

constexpr std::array<const char*, 5> kSolids{"sphere", "box", "cylinder", "cone", "torus"};  // as PrimitiveType
constexpr std::array<const char*, 3> kOperations{"union", "intersection", "difference"};     // CsgOperation 1, 2, 3

// Appends one tree in postfix order to a set.
class TreeReader {
 public:
  TreeReader(SceneTomlContext& context, PrimitiveSet& set) : context_(context), set_(set) {}

  // `material` and `outer` come from the nodes above.
  void read(const TomlValue& node, const std::string& what, const mat4& outer, int material) {
    TomlReader reader(node, what, context_.file);
    const mat4 transform = outer * readTransform(reader);
    checkInvertible(reader, node, transform);
    if (const int own = context_.readMaterialKey(reader); own != kNone) material = own;
    const TomlValue* content =
        reader.findOneOf({"sphere", "box", "cylinder", "cone", "torus", "union", "intersection", "difference", "csg"});
    reader.finish();
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
      context_.fail(at, fmt::format("a tree has at most {} nodes", kMaxCsgNodes));
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

  // A copy of an earlier tree.
  void addNamed(const TomlReader& reader, const TomlValue& value, const mat4& transform, int material) {
    const std::string name = reader.toText(value, "csg");
    const auto found = context_.trees.find(name);
    if (found == context_.trees.end()) {
      std::vector<std::string> names;
      for (const auto& [known, tree] : context_.trees) names.push_back(known);
      context_.fail(value,
                    fmt::format("there is no [[csg]] '{}' with one tree above{}", name, didYouMean(name, names)));
    }
    const auto& [other, target] = found->second;
    if (!target.empty()) context_.targets.at(target).placedAlone = false;
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
        node, fmt::format(
                  "{} keeps {} solids waiting while it is evaluated, and {} is the limit: a difference is taken from a "
                  "difference that is taken from another, and so on",
                  what, stack, kMaxCsgStack));
  const CsgTree tree{first, static_cast<std::uint32_t>(set.nodes.size()) - first};
  const Bounds3 bounds = boundsOf(set, tree);
  if (bounds.empty())
    context.scene.report.ignored.push_back(
        fmt::format("line {}: {} is empty: an intersection has nothing in common", node.line, what));
  else if (!isFinite(bounds.min) || !isFinite(bounds.max))
    context.fail(node, fmt::format("{} is too large", what));
  set.trees.push_back(tree);
  context.budget.take(tree.nodeCount * (sizeof(CsgNode) + 3 * sizeof(Primitive)));
}

}  // namespace

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
  reader.finish();
  if (!set.name.empty() && set.trees.size() == 1)
    context.trees.emplace(set.name, NamedTree{set, reader.has("object") ? std::string() : set.name});
  context.fillMaterials(set);
  context.scene.meshes[mesh].primitiveSets.push_back(std::move(set));
}

}  // namespace quintet::scene

// SPDX-License-Identifier: Apache-2.0
#include "render/scene/procedural_data.h"

#include <algorithm>

namespace quintet::render {
namespace {

void setRows(vec4 (&rows)[3], const glm::dmat4& m) {
  const mat4 transposed = glm::transpose(mat4(m));
  for (int i = 0; i < 3; ++i) rows[i] = transposed[i];
}

shared::PrimitiveData makePrimitive(const scene::Scene& scene, const scene::Primitive& primitive) {
  shared::PrimitiveData data{};
  const glm::dmat4 objectFromPrimitive(primitive.objectFromPrimitive);
  setRows(data.objectFromPrimitive, objectFromPrimitive);
  setRows(data.primitiveFromObject, glm::inverse(objectFromPrimitive));
  data.type = static_cast<std::uint32_t>(primitive.type);
  data.parameter = primitive.parameter;
  data.material = materialIndex(scene, primitive.material);
  return data;
}

// Padding on each side of a box, relative to its size plus its distance from the origin.
constexpr float kPadding = 4e-6f;

Bounds3 padded(const Bounds3& box) {
  if (box.empty()) return box;
  const vec3 extent = box.extent();
  const vec3 padding =
      kPadding * (glm::max(glm::abs(box.min), glm::abs(box.max)) + std::max({extent.x, extent.y, extent.z}));
  return {box.min - padding, box.max + padding};
}

}  // namespace

std::uint32_t materialIndex(const scene::Scene& scene, int material) {
  return static_cast<std::uint32_t>(material == scene::kNone ? scene.materials.size()
                                                             : static_cast<std::size_t>(material));
}

std::vector<shared::PrimitiveData> makePrimitives(const scene::Scene& scene, const scene::PrimitiveSet& set) {
  std::vector<shared::PrimitiveData> result;
  result.reserve(set.primitives.size());
  for (const scene::Primitive& primitive : set.primitives) result.push_back(makePrimitive(scene, primitive));
  return result;
}

std::vector<shared::CsgNodeData> makeNodes(const scene::PrimitiveSet& set) {
  std::vector<shared::CsgNodeData> result(set.nodes.size());
  std::vector<std::uint32_t> sizes;  // node counts of the operands on the stack
  for (const scene::CsgTree& tree : set.trees) {
    sizes.clear();
    for (std::uint32_t i = tree.firstNode; i < tree.firstNode + tree.nodeCount; ++i) {
      const scene::CsgNode& node = set.nodes[i];
      result[i].operation = static_cast<std::uint32_t>(node.operation);
      if (node.operation == scene::CsgOperation::leaf) {
        result[i].operand = node.primitive;
        sizes.push_back(1);
        continue;
      }
      result[i].operand = sizes.back();
      sizes.pop_back();
      sizes.back() += result[i].operand + 1;
    }
  }
  return result;
}

std::vector<shared::CsgTreeData> makeTrees(const scene::PrimitiveSet& set) {
  std::vector<shared::CsgTreeData> result;
  for (const scene::CsgTree& tree : set.trees) result.push_back({tree.firstNode, tree.nodeCount});
  return result;
}

std::vector<shared::BoxData> makeBoxes(const scene::PrimitiveSet& set) {
  std::vector<shared::BoxData> result;
  for (const Bounds3& box : scene::boxesOf(set)) result.push_back({box.min, box.max});
  return result;
}

std::vector<Bounds3> boxesForBuild(const scene::PrimitiveSet& set) {
  std::vector<Bounds3> boxes = scene::boxesOf(set);
  if (set.kind != scene::PrimitiveSetKind::custom) std::ranges::transform(boxes, boxes.begin(), padded);
  return boxes;
}

}  // namespace quintet::render

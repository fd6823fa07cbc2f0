// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/nodes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "base/error.h"
#include "base/normal_float.h"
#include "base/plural.h"
#include "base/text.h"
#include "scene/geometry/repair.h"
#include "scene/gltf/accessor.h"
#include "scene/gltf/extensions.h"
#include "scene/model/limits.h"

namespace quintet::scene {
namespace {

// ---- Node hierarchy ----

using glm::dmat4;
using glm::dvec3;
using glm::dvec4;

// Parent of each node, or kNone.
std::vector<int> findParents(const Document& document) {
  const auto& nodes = document.model.nodes;
  std::vector<int> parents(nodes.size(), kNone);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (std::size_t k = 0; k < nodes[i].children.size(); ++k) {
      int& parent = parents[static_cast<std::size_t>(nodes[i].children[k])];
      if (parent != kNone)
        document.fail(fmt::format("/nodes/{}/children/{}", i, k),
                      fmt::format("node {} is already a child of node {}", nodes[i].children[k], parent));
      parent = static_cast<int>(i);
    }
  }
  return parents;
}

// `roots` and their descendants, parents before children. Because each node has at most one parent, a node occurs twice
// only if a root is listed twice.
std::vector<int> walk(const Document& document, const std::vector<int>& roots) {
  std::vector<int> order;
  std::vector<int> open(roots.rbegin(), roots.rend());
  while (!open.empty()) {
    const int node = open.back();
    open.pop_back();
    order.push_back(node);
    const auto& children = document.model.nodes[static_cast<std::size_t>(node)].children;
    open.insert(open.end(), children.rbegin(), children.rend());
  }
  return order;
}

std::vector<int> rootNodes(const std::vector<int>& parents) {
  std::vector<int> roots;
  for (std::size_t i = 0; i < parents.size(); ++i)
    if (parents[i] == kNone) roots.push_back(static_cast<int>(i));
  return roots;
}

// The requested scene, else the default one, else the first one, else kNone.
int chooseScene(const Document& document, int requested) {
  const tinygltf::Model& model = document.model;
  if (requested != kNone) return requested;
  if (model.defaultScene != kNone) return model.defaultScene;
  return model.scenes.empty() ? kNone : 0;
}

std::vector<int> sceneRoots(const Document& document, int sceneIndex, const std::vector<int>& parents) {
  if (sceneIndex == kNone) return rootNodes(parents);
  const std::vector<int>& roots = document.model.scenes[static_cast<std::size_t>(sceneIndex)].nodes;
  std::vector<bool> listed(parents.size(), false);
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const auto node = static_cast<std::size_t>(roots[i]);
    const std::string location = fmt::format("/scenes/{}/nodes/{}", sceneIndex, i);
    if (parents[node] != kNone)
      document.fail(location, fmt::format("node {} is a child of node {}, not a root", node, parents[node]));
    if (listed[node]) document.fail(location, fmt::format("node {} is listed twice", node));
    listed[node] = true;
  }
  return roots;
}

void reportTransforms(const Document& document, Report& report) {
  for (std::size_t i = 0; i < document.model.nodes.size(); ++i) {
    const std::vector<double>& r = document.model.nodes[i].rotation;
    if (r.empty()) continue;
    const double length = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
    if (std::abs(length - 1.0) > 1e-3)
      report.repaired.push_back(fmt::format("/nodes/{}/rotation: length {:.4g}, normalized", i, length));
  }
}

// ---- Lights ----

void readSpot(const tinygltf::Light& from, const std::string& location, Light& light, Report& report) {
  const auto outer = static_cast<float>(from.spot.outerConeAngle), inner = static_cast<float>(from.spot.innerConeAngle);
  light.outerConeAngle = std::clamp(outer, 1e-4f, kPi / 2.0f);
  light.innerConeAngle = std::clamp(inner, 0.0f, light.outerConeAngle);
  if (light.outerConeAngle != outer && outer < kPi / 2.0f + 1e-4f && outer > 0.0f) return;  // π/2, rounded up
  if (light.outerConeAngle != outer || light.innerConeAngle != inner)
    report.repaired.push_back(fmt::format("{}/spot: cone angles {} and {} clamped to {} and {}", location, inner, outer,
                                          light.innerConeAngle, light.outerConeAngle));
}

}  // namespace

bool isVisible(const Document& document, std::size_t node) {
  const tinygltf::Value* visibility = findExtension(document.model.nodes[node].extensions, kVisibility);
  return !visibility || !visibility->Has("visible") || visibility->Get("visible").Get<bool>();
}

dmat4 localTransform(const Document& document, std::size_t index) {
  const tinygltf::Node& node = document.model.nodes[index];
  if (node.matrix.empty()) {
    const auto at = [](const std::vector<double>& v, std::size_t i, double fallback) {
      return v.empty() ? fallback : v[i];
    };
    const auto &t = node.translation, &r = node.rotation, &s = node.scale;
    return composeTransform({at(t, 0, 0), at(t, 1, 0), at(t, 2, 0)},
                            {at(r, 0, 0), at(r, 1, 0), at(r, 2, 0), at(r, 3, 1)},
                            {at(s, 0, 1), at(s, 1, 1), at(s, 2, 1)});
  }
  dmat4 matrix;
  for (std::size_t i = 0; i < 16; ++i) matrix[i / 4][i % 4] = node.matrix[i];
  for (std::size_t column = 0; column < 4; ++column) {
    const double expected = column == 3 ? 1.0 : 0.0;
    if (std::abs(matrix[column][3] - expected) > 1e-4)
      document.fail(fmt::format("/nodes/{}/matrix", index), "the last row is not 0 0 0 1");
    matrix[column][3] = expected;
  }
  return matrix;
}

std::vector<mat4> readInverseBindMatrices(const Document& document, std::size_t index) {
  const tinygltf::Skin& skin = document.model.skins[index];
  std::vector<mat4> matrices(skin.joints.size(), mat4(1.0f));
  if (skin.inverseBindMatrices == kNone) return matrices;
  const std::string location = fmt::format("/skins/{}/inverseBindMatrices", index);
  const std::vector<mat4> inverseBind = readMat4(document, skin.inverseBindMatrices, location);
  if (inverseBind.size() < matrices.size())
    document.fail(location, fmt::format("{} for {}", counted(inverseBind.size(), "matrix", "matrices"),
                                        counted(matrices.size(), "joint")));
  std::copy_n(inverseBind.begin(), matrices.size(), matrices.begin());
  return matrices;
}

dmat4 composeTransform(const dvec3& translation, const dvec4& rotation, const dvec3& scale) {
  const double length = glm::length(rotation);
  const dvec4 q = length > 0.0 ? rotation / length : dvec4(0, 0, 0, 1);
  dmat4 matrix = glm::mat4_cast(glm::dquat(q.w, q.x, q.y, q.z));
  for (std::size_t i = 0; i < 3; ++i) matrix[i] *= scale[i];
  matrix[3] = dvec4(translation, 1.0);
  return matrix;
}

int findScene(const Document& document, const std::string& nameOrIndex) {
  if (nameOrIndex.empty()) return kNone;
  std::vector<std::string> names;
  for (const tinygltf::Scene& scene : document.model.scenes) names.push_back(scene.name);
  if (const auto found = std::ranges::find(names, nameOrIndex); found != names.end())
    return static_cast<int>(found - names.begin());
  std::size_t index = 0;
  const char* end = nameOrIndex.data() + nameOrIndex.size();
  const auto [stop, error] = std::from_chars(nameOrIndex.data(), end, index);
  if (error == std::errc{} && stop == end && index < names.size()) return static_cast<int>(index);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i].empty()) names[i] = std::to_string(i);
  throw UsageError(printable(fmt::format("{}: no scene '{}'; the file has {}{}", document.file.string(), nameOrIndex,
                                         counted(names.size(), "scene"),
                                         names.empty() ? "" : fmt::format(": {}", fmt::join(names, ", ")))));
}

NodeTree readNodes(const Document& document, int sceneIndex, Report& report) {
  const std::size_t count = document.model.nodes.size();
  std::vector<int> parents = findParents(document);
  std::vector<int> order = walk(document, rootNodes(parents));
  if (order.size() != count) {  // nodes without a root form a cycle
    std::vector<bool> reached(count, false);
    for (const int node : order) reached[static_cast<std::size_t>(node)] = true;
    document.fail(fmt::format("/nodes/{}", std::ranges::find(reached, false) - reached.begin()),
                  "the node is its own ancestor");
  }
  reportTransforms(document, report);

  NodeTree tree;
  std::vector<dmat4> world(count);
  tree.worldFromNode.resize(count);
  tree.visible.resize(count, true);
  for (const int node : order) {
    const auto i = static_cast<std::size_t>(node);
    tree.visible[i] =
        isVisible(document, i) && (parents[i] == kNone || tree.visible[static_cast<std::size_t>(parents[i])]);
    const dmat4 local = localTransform(document, i);
    world[i] = parents[i] == kNone ? local : world[static_cast<std::size_t>(parents[i])] * local;
    tree.worldFromNode[i] = mat4(world[i]);
    for (std::size_t column = 0; column < 4; ++column)
      if (!isFinite(vec3(tree.worldFromNode[i][column])))
        document.fail(fmt::format("/nodes/{}", node), "the transform to world space is not finite");
  }
  tree.scene = chooseScene(document, sceneIndex);
  tree.sceneNodes = walk(document, sceneRoots(document, tree.scene, parents));
  tree.order = std::move(order);
  tree.parents = std::move(parents);
  return tree;
}

Camera readCamera(const Document& document, int index, const tinygltf::Node& node, const mat4& worldFromNode) {
  const tinygltf::Camera& from = document.model.cameras[static_cast<std::size_t>(index)];
  const std::string location = fmt::format("/cameras/{}/{}", index, from.type);
  Camera camera;
  camera.name = from.name.empty() ? node.name : from.name;
  camera.nodeName = node.name;
  camera.worldFromCamera = rigidFrame(worldFromNode);
  if (from.type == "perspective") {
    camera.verticalFov = normalFloat(from.perspective.yfov);
    if (!(camera.verticalFov > 0.0f && camera.verticalFov < kPi))
      document.fail(location + "/yfov", fmt::format("{} is not an angle between 0 and π", from.perspective.yfov));
    camera.aspect = std::max(0.0f, normalFloat(from.perspective.aspectRatio));
  } else {
    camera.orthographic = true;
    camera.orthographicHalfSize =
        glm::abs(vec2(normalFloat(from.orthographic.xmag), normalFloat(from.orthographic.ymag)));
    if (!(camera.orthographicHalfSize.x > 0.0f && camera.orthographicHalfSize.y > 0.0f))
      document.fail(location, "xmag and ymag must not be zero");
    camera.aspect = normalFloat(static_cast<double>(camera.orthographicHalfSize.x) / camera.orthographicHalfSize.y);
  }
  return camera;
}

void readLight(const Document& document, int index, const tinygltf::Node& node, const mat4& worldFromNode,
               Scene& scene) {
  const tinygltf::Light& from = document.model.lights[static_cast<std::size_t>(index)];
  const std::string location = fmt::format("/extensions/KHR_lights_punctual/lights/{}", index);
  Light light;
  if (from.type == "spot") {
    light.type = LightType::spot;
  } else if (from.type == "directional") {
    light.type = LightType::directional;
  } else if (from.type != "point") {
    scene.report.ignored.push_back(fmt::format("{}: unknown light type \"{}\"", location, from.type.substr(0, 40)));
    return;
  }
  light.name = from.name.empty() ? node.name : from.name;
  const dvec3 color = from.color.empty() ? dvec3(1.0) : dvec3(from.color[0], from.color[1], from.color[2]);
  const dvec3 intensity = from.intensity * color;
  if (glm::any(glm::lessThan(intensity, dvec3(0.0))))
    scene.report.repaired.push_back(location + ": negative intensity or color replaced by 0");
  if (const double largest = std::max({intensity.x, intensity.y, intensity.z});
      static_cast<float>(largest) > kMaxRadiance)
    scene.report.repaired.push_back(
        fmt::format("{}: an intensity of {:g} is clamped to {:g}", location, largest, kMaxRadiance));
  light.intensity = vec3(glm::clamp(intensity, 0.0, double{kMaxRadiance}));
  light.position = vec3(worldFromNode[3]);
  light.direction = directionOr(-vec3(worldFromNode[2]), vec3(0, 0, -1));
  if (from.range < 0.0)
    scene.report.repaired.push_back(
        fmt::format("{}: range {} is not positive, replaced by infinity", location, from.range));
  if (from.range > 0.0) light.range = distanceOrInfinity(from.range);
  if (light.type == LightType::directional) light.range = Light().range;
  if (light.type == LightType::spot) readSpot(from, location, light, scene.report);
  scene.lights.push_back(std::move(light));
}

}  // namespace quintet::scene

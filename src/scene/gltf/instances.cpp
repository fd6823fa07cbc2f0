// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/instances.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>

#include "base/parallel.h"
#include "base/plural.h"
#include "scene/gltf/accessor.h"
#include "scene/gltf/extensions.h"
#include "scene/model/limits.h"
#include "scene/model/mesh_bounds.h"

namespace quintet::scene {
namespace {

// Guaranteed by Vulkan for a TLAS (VkPhysicalDeviceAccelerationStructurePropertiesKHR::maxInstanceCount).
constexpr std::size_t kMaxInstances = (std::size_t{1} << 24) - 1;

// Primitives above this size are read one after the other, each on all cores.
constexpr std::size_t kLargeBytes = std::size_t{32} << 20;

enum class Rank { full, plane, less };

// Number of dimensions that remain after the transform. A singular matrix must not reach the acceleration structure.
Rank rankOf(const mat4& matrix) {
  glm::dvec3 column[3];
  int directions = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    column[i] = glm::dvec3(vec3(matrix[i]));
    const double length = glm::length(column[i]);
    if (length > 0.0) column[i] /= length, ++directions;
  }
  constexpr double kNoAngle = 1e-6;  // below the precision of a float matrix
  if (std::abs(glm::dot(column[0], glm::cross(column[1], column[2]))) > kNoAngle) return Rank::full;
  for (std::size_t i = 0; i < 3; ++i)
    if (glm::length(glm::cross(column[i], column[(i + 1) % 3])) > kNoAngle) return Rank::plane;
  return Rank::less;
}

float largestCoordinate(const Mesh& mesh) {
  float largest = 0.0f;
  for (const Geometry& geometry : mesh.geometries)
    for (const vec3& p : geometry.positions) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return largest;
}

// A bound of the coordinates of points, whose coordinates are at most `radius`, after the transform.
vec3 farthest(const mat4& transform, float radius) {
  const auto column = [&](std::size_t i) { return glm::abs(vec3(transform[i])); };
  return radius * (column(0) + column(1) + column(2)) + column(3);
}

bool hasJoints(const tinygltf::Mesh& mesh) {
  return std::ranges::any_of(mesh.primitives, [](const tinygltf::Primitive& p) {
    return p.attributes.contains("JOINTS_0") && p.attributes.contains("WEIGHTS_0");
  });
}

// Estimated bytes of a geometry, for the memory budget.
std::size_t estimateBytes(const tinygltf::Model& model, int mesh, int primitiveIndex, bool animated) {
  const tinygltf::Primitive& primitive =
      model.meshes[static_cast<std::size_t>(mesh)].primitives[static_cast<std::size_t>(primitiveIndex)];
  if (primitive.mode < TINYGLTF_MODE_TRIANGLES) return 0;
  const auto count = [&](int accessor) { return model.accessors[static_cast<std::size_t>(accessor)].count; };
  std::size_t bytes = primitive.indices == kNone ? 0 : sizeof(uvec3) * count(primitive.indices);
  for (const auto& [name, accessor] : primitive.attributes)
    if (!name.starts_with('_')) bytes += (animated ? 2 : 1) * sizeof(vec4) * count(accessor);
  for (const auto& target : primitive.targets)
    for (const auto& [name, accessor] : target) bytes += sizeof(vec3) * count(accessor);
  return bytes;
}

void appendUnique(std::vector<std::string>& lines, std::set<std::string>& seen, std::vector<std::string>& more) {
  for (std::string& line : more)
    if (seen.insert(line).second) lines.push_back(std::move(line));
}

}  // namespace

InstanceBuilder::InstanceBuilder(const Document& document, const NodeTree& tree, const PlayedAnimation& animation,
                                 Report& report)
    : document_(document), tree_(tree), animation_(animation), report_(report) {
  for (std::size_t i = 0; i < document.model.meshes.size(); ++i) checkMorphTargets(document, static_cast<int>(i));
}

int InstanceBuilder::newPose(int mesh, Deformation deformation) {
  poses_.push_back({mesh, std::move(deformation)});
  return static_cast<int>(poses_.size()) - 1;
}

int InstanceBuilder::sharedPose(int mesh, const std::vector<double>& morphWeights) {
  const auto [known, isNew] = shared_.try_emplace({mesh, morphWeights}, static_cast<int>(poses_.size()));
  if (isNew) newPose(mesh, {.morphWeights = morphWeights, .jointMatrices = {}, .bake = {}});
  return known->second;
}

void InstanceBuilder::addNode(int index) {
  const tinygltf::Node& node = document_.model.nodes[static_cast<std::size_t>(index)];
  if (node.mesh == kNone) return;
  const tinygltf::Mesh& mesh = document_.model.meshes[static_cast<std::size_t>(node.mesh)];
  const std::size_t targetCount = mesh.primitives[0].targets.size();
  if (!node.weights.empty() && node.weights.size() != targetCount)
    document_.fail(
        fmt::format("/nodes/{}/weights", index),
        fmt::format("{} for {}", counted(node.weights.size(), "weight"), counted(targetCount, "morph target")));
  if (node.skin != kNone) {
    if (hasJoints(mesh)) return addSkinned(index);
    report_.ignored.push_back(fmt::format("/nodes/{}/skin: the mesh has no JOINTS_0 and WEIGHTS_0", index));
  }
  for (const Transform& transform : instanceTransforms(index)) addRigid(index, transform);
}

Instance& InstanceBuilder::addInstance(int index, int pose, const mat4& worldFromObject) {
  if (instances_.size() == kMaxInstances)
    document_.fail(fmt::format("/nodes/{}", index), fmt::format("more than {} instances", kMaxInstances));
  nodes_.push_back(index);
  Instance& instance = instances_.emplace_back();
  instance.name = document_.model.nodes[static_cast<std::size_t>(index)].name;
  instance.mesh = pose;
  instance.worldFromObject = worldFromObject;
  if (animation_.togglesNode(index)) instance.visibleNode = index;
  return instance;
}

int InstanceBuilder::animatedPose(int index) {
  const auto [known, isNew] = animated_.try_emplace(index, static_cast<int>(poses_.size()));
  if (!isNew) return known->second;
  const tinygltf::Node& node = document_.model.nodes[static_cast<std::size_t>(index)];
  const bool skinned = node.skin != kNone && hasJoints(document_.model.meshes[static_cast<std::size_t>(node.mesh)]);
  Pose pose{.mesh = node.mesh, .deformation = {.animated = true}, .node = index};
  if (skinned) {
    pose.skin = node.skin;
    pose.deformation.jointCount = document_.model.skins[static_cast<std::size_t>(node.skin)].joints.size();
  }
  poses_.push_back(std::move(pose));
  return known->second;
}

// glTF 2.0 section 3.7.3.3: the joints' transforms apply, the node's own does not.
void InstanceBuilder::addSkinned(int index) {
  const auto i = static_cast<std::size_t>(index);
  const tinygltf::Node& node = document_.model.nodes[i];
  if (animation_.movesSkin(document_, index)) {
    addInstance(index, animatedPose(index), mat4(1.0f));
    return;
  }
  // Before the aggregate: GCC 12 destroys the members of a temporary of ?: although an exception left it incomplete
  // (GltfSkin.RejectsInconsistentSkins with AddressSanitizer).
  std::vector<mat4> joints = jointMatrices(index);
  addInstance(index, newPose(node.mesh, {node.weights, std::move(joints), tree_.worldFromNode[i]}), mat4(1.0f));
}

void InstanceBuilder::addRigid(int index, const Transform& transform) {
  const tinygltf::Node& node = document_.model.nodes[static_cast<std::size_t>(index)];
  const bool moves = animation_.movesNode(index), morphs = animation_.morphsNode(index);
  const auto pose = [&] { return morphs ? animatedPose(index) : sharedPose(node.mesh, node.weights); };
  if (moves) {
    Instance& instance = addInstance(index, pose(), transform.worldFromObject);
    instance.node = index;
    instance.animatedFromObject = transform.nodeFromObject;
    return;
  }
  switch (rankOf(transform.worldFromObject)) {
    case Rank::full: addInstance(index, pose(), transform.worldFromObject); return;
    case Rank::plane:  // flattened by a zero scale: visible, but without an inverse
      if (morphs)
        report_.ignored.push_back(
            fmt::format("/nodes/{}: the scale flattens the mesh; its weights do not move", index));
      addInstance(index, newPose(node.mesh, {node.weights, {}, transform.worldFromObject}), mat4(1.0f));
      return;
    case Rank::less:
      report_.ignored.push_back(fmt::format("/nodes/{}: the scale flattens the mesh to a line or a point", index));
      return;
  }
}

std::vector<mat4> InstanceBuilder::jointMatrices(int index) const {
  const int skinIndex = document_.model.nodes[static_cast<std::size_t>(index)].skin;
  const tinygltf::Skin& skin = document_.model.skins[static_cast<std::size_t>(skinIndex)];
  document_.budget->take(skin.joints.size() * sizeof(mat4));
  std::vector<mat4> matrices = readInverseBindMatrices(document_, static_cast<std::size_t>(skinIndex));
  for (std::size_t i = 0; i < matrices.size(); ++i)
    matrices[i] = tree_.worldFromNode[static_cast<std::size_t>(skin.joints[i])] * matrices[i];
  return matrices;
}

// One transform per instance of EXT_mesh_gpu_instancing, or the node's own.
std::vector<InstanceBuilder::Transform> InstanceBuilder::instanceTransforms(int index) const {
  const tinygltf::Node& node = document_.model.nodes[static_cast<std::size_t>(index)];
  const mat4& worldFromNode = tree_.worldFromNode[static_cast<std::size_t>(index)];
  const tinygltf::Value* extension = findExtension(node.extensions, kInstancing);
  if (!extension) return {{.worldFromObject = worldFromNode}};

  const tinygltf::Value& attributes = extension->Get("attributes");
  const std::string location = fmt::format("/nodes/{}/extensions/{}/attributes", index, kInstancing);
  std::vector<vec3> translations, scales;
  std::vector<vec4> rotations;
  if (attributes.Has("TRANSLATION"))
    translations = readVec3(document_, indexOf(attributes, "TRANSLATION"), location + "/TRANSLATION");
  if (attributes.Has("ROTATION"))
    rotations = readVec4(document_, indexOf(attributes, "ROTATION"), location + "/ROTATION", Integers::unit);
  if (attributes.Has("SCALE")) scales = readVec3(document_, indexOf(attributes, "SCALE"), location + "/SCALE");
  const std::size_t count = std::max({translations.size(), rotations.size(), scales.size()});
  const auto fits = [count](const auto& values) { return values.empty() || values.size() == count; };
  if (!fits(translations) || !fits(rotations) || !fits(scales))
    document_.fail(location, "the attributes have different counts");

  if (instances_.size() + count > kMaxInstances)
    document_.fail(location, fmt::format("more than {} instances", kMaxInstances));
  document_.budget->take(count * (sizeof(Instance) + sizeof(Transform)));
  std::vector<Transform> transforms;
  transforms.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const mat4 local(composeTransform(translations.empty() ? vec3(0.0f) : translations[i],
                                      rotations.empty() ? vec4(0, 0, 0, 1) : rotations[i],
                                      scales.empty() ? vec3(1.0f) : scales[i]));
    transforms.push_back({worldFromNode * local, local});
    for (std::size_t column = 0; column < 4; ++column)
      if (!isFinite(vec3(transforms.back().worldFromObject[column])))
        document_.fail(location, fmt::format("the transform of instance {} is not finite", i));
  }
  return transforms;
}

void InstanceBuilder::finish(Scene& scene, MemoryBudget& budget) {
  std::vector<bool> used(document_.model.meshes.size(), false);
  for (const Pose& pose : poses_) used[static_cast<std::size_t>(pose.mesh)] = true;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (!used[i]) poses_.push_back({static_cast<int>(i), {}, false});

  struct Job {
    std::size_t pose;
    int primitive;
    GeometryResult result;
  };
  std::vector<Job> jobs;
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const auto& mesh = document_.model.meshes[static_cast<std::size_t>(poses_[i].mesh)];
    for (std::size_t k = 0; k < mesh.primitives.size(); ++k) jobs.push_back({i, static_cast<int>(k), {}});
  }
  const auto run = [&](Job& job) {
    const Pose& pose = poses_[job.pose];
    budget.take(estimateBytes(document_.model, pose.mesh, job.primitive, pose.deformation.animated));
    job.result = readGeometry(document_, scene.materials, pose.mesh, job.primitive, pose.deformation);
    if (!pose.instanced) job.result = {};
  };
  // Large primitives one after the other, each on all cores; then all small ones in parallel.
  std::vector<Job*> small;
  for (Job& job : jobs) {
    const Pose& pose = poses_[job.pose];
    if (estimateBytes(document_.model, pose.mesh, job.primitive, pose.deformation.animated) > kLargeBytes) {
      run(job);
    } else {
      small.push_back(&job);
    }
  }
  parallelFor(small.size(), [&](std::size_t i) { run(*small[i]); });

  std::vector<Mesh> meshes(poses_.size());
  std::set<std::string> ignored, repaired;
  std::vector<MeshDeformation> deformations(poses_.size());
  for (Job& job : jobs) {
    if (job.result.geometry) {
      meshes[job.pose].geometries.push_back(std::move(*job.result.geometry));
      deformations[job.pose].geometries.push_back(std::move(job.result.deformation));
    }
    appendUnique(report_.ignored, ignored, job.result.ignored);
    appendUnique(report_.repaired, repaired, job.result.repaired);
  }
  std::vector<int> meshOf(poses_.size(), kNone);
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    if (meshes[i].geometries.empty()) continue;
    meshes[i].name = document_.model.meshes[static_cast<std::size_t>(poses_[i].mesh)].name;
    if (poses_[i].deformation.animated) {
      deformations[i].node = poses_[i].node;
      deformations[i].skin = poses_[i].skin;
      meshes[i].deformation = std::make_shared<MeshDeformation>(std::move(deformations[i]));
    }
    meshOf[i] = static_cast<int>(scene.meshes.size());
    scene.meshes.push_back(std::move(meshes[i]));
  }
  addInstances(meshOf, scene);
}

void InstanceBuilder::addInstances(const std::vector<int>& meshOf, Scene& scene) {
  std::vector<float> radii;
  for (const Mesh& mesh : scene.meshes) radii.push_back(largestCoordinate(mesh));
  for (std::size_t i = 0; i < instances_.size(); ++i) {
    Instance& instance = instances_[i];
    instance.mesh = meshOf[static_cast<std::size_t>(instance.mesh)];
    if (instance.mesh == kNone) continue;
    const auto m = static_cast<std::size_t>(instance.mesh);
    if (!isWithinLimits(farthest(instance.worldFromObject, radii[m])) &&
        !isWithinLimits(meshBounds(scene.meshes[m], instance.worldFromObject))) {
      report_.ignored.push_back(fmt::format("/nodes/{}: the mesh extends more than {:g} m from the origin; ignored",
                                            nodes_[i], kMaxCoordinate));
      continue;
    }
    scene.instances.push_back(std::move(instance));
  }
}

}  // namespace quintet::scene

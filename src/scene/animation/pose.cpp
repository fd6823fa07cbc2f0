// SPDX-License-Identifier: Apache-2.0
#include "scene/animation/pose.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "scene/animation/deform.h"
#include "scene/animation/interpolate.h"
#include "scene/animation/keyframes.h"
#include "scene/animation/properties.h"
#include "scene/geometry/repair.h"
#include "scene/model/limits.h"

namespace quintet::scene {
namespace {

using glm::dmat4;
using glm::dvec3;
using glm::dvec4;

dvec3 interpolateVector(const AnimationSampler& sampler, double seconds) {
  vec3 value(0.0f);
  interpolate(sampler, seconds, {&value.x, 3});
  return value;
}

// A node with the values of its channels.
struct MovedNode {
  dvec3 translation;
  glm::dquat rotation;
  dvec3 scale;
};

dmat4 localTransform(const AnimationNode& node, const MovedNode& moved) {
  if (node.hasMatrix) return node.matrix;
  dmat4 matrix = glm::mat4_cast(moved.rotation);
  for (std::size_t i = 0; i < 3; ++i) matrix[i] *= moved.scale[i];
  matrix[3] = dvec4(moved.translation, 1.0);
  return matrix;
}

vec4 valueOf(const AnimationSampler& sampler, double seconds) {
  vec4 value(0.0f);
  interpolate(sampler, seconds, {&value.x, sampler.valueSize});
  return value;
}

// `node` can be kNone.
bool isVisible(int node, const Pose& pose) { return node == kNone || pose.visible[static_cast<std::size_t>(node)]; }

void restoreNonFinite(std::vector<vec3>& positions, const std::vector<vec3>& undeformed) {
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (!isFinite(positions[i])) positions[i] = undeformed[i];
}

}  // namespace

Pose poseAt(const NodeAnimation* animation, double frame) {
  Pose pose;
  pose.frame = frame;
  if (!animation) return pose;
  const double seconds = frame / animation->framesPerSecond;
  std::vector<MovedNode> moved;
  moved.reserve(animation->nodes.size());
  pose.weights.reserve(animation->nodes.size());
  for (const AnimationNode& node : animation->nodes) {
    moved.push_back({node.translation, node.rotation, node.scale});
    pose.weights.push_back(node.weights);
    pose.visible.push_back(node.visible);
  }
  for (const AnimationChannel& channel : animation->animation.channels) {
    const auto node = static_cast<std::size_t>(channel.node);
    const AnimationSampler& sampler = animation->animation.samplers[channel.sampler];
    switch (channel.property) {
      case AnimatedProperty::translation: moved[node].translation = interpolateVector(sampler, seconds); break;
      case AnimatedProperty::rotation: moved[node].rotation = interpolateRotation(sampler, seconds); break;
      case AnimatedProperty::scale: moved[node].scale = interpolateVector(sampler, seconds); break;
      case AnimatedProperty::weights:
        pose.weights[node].resize(sampler.valueSize);
        interpolate(sampler, seconds, pose.weights[node]);
        break;
      case AnimatedProperty::visibility: pose.visible[node] = valueOf(sampler, seconds).x != 0.0f; break;
    }
  }
  for (const std::size_t sampler : animation->values)
    pose.values.push_back(valueOf(animation->animation.samplers[sampler], seconds));
  std::vector<dmat4> world(animation->nodes.size());
  pose.worldFromNode.resize(world.size());
  for (const int index : animation->order) {
    const auto i = static_cast<std::size_t>(index);
    const AnimationNode& node = animation->nodes[i];
    const dmat4 local = localTransform(node, moved[i]);
    world[i] = node.parent == kNone ? local : world[static_cast<std::size_t>(node.parent)] * local;
    pose.worldFromNode[i] = mat4(world[i]);
    if (node.parent != kNone && !pose.visible[static_cast<std::size_t>(node.parent)]) pose.visible[i] = false;
  }
  return pose;
}

mat4 worldFromObjectAt(const Instance& instance, const Pose& pose) {
  const auto frame = static_cast<float>(pose.frame);
  if (instance.node == kNone) return worldFromObjectAt(instance, frame);
  const mat4 placed = instance.placedFromRoot * pose.worldFromNode[static_cast<std::size_t>(instance.node)] *
                      instance.animatedFromObject;
  return instance.keyframes.empty() ? placed
                                    : keyframeMatrixAt(instance.keyframes, frame, instance.interpolation) * placed;
}

mat4 shownTransformAt(const Instance& instance, const Pose& pose) {
  mat4 transform = worldFromObjectAt(instance, pose);
  const bool far = !isWithinLimits(transform);
  if (far) transform[3] = vec4(0, 0, 0, 1);
  if (far || !isVisible(instance.visibleNode, pose)) transform[0] = transform[1] = transform[2] = vec4(0.0f);
  return transform;
}

Camera cameraAt(const Camera& camera, const Pose& pose) {
  Camera moved = camera;
  if (camera.node != kNone)
    moved.worldFromCamera =
        rigidFrame(camera.placedFromRoot * pose.worldFromNode[static_cast<std::size_t>(camera.node)]);
  for (const AnimatedValue& value : camera.values) setCameraValue(moved, value.property, pose.values[value.value]);
  return moved;
}

Light lightAt(const Light& light, const Pose& pose) {
  Light moved = light;
  if (light.node != kNone) {
    const mat4 worldFromNode = light.placedFromRoot * pose.worldFromNode[static_cast<std::size_t>(light.node)];
    moved.position = vec3(worldFromNode[3]);
    moved.direction = directionOr(-vec3(worldFromNode[2]), vec3(0, 0, -1));
  }
  for (const AnimatedValue& value : light.values) setLightValue(moved, value.property, pose.values[value.value]);
  const bool far = !isWithinLimits(moved.position);
  if (far) moved.position = vec3(0.0f);
  if (far || !isVisible(light.visibleNode, pose)) moved.intensity = vec3(0.0f);
  return moved;
}

void moveEnvironment(Environment& environment, const Pose& pose) {
  for (const AnimatedValue& value : environment.values)
    setEnvironmentValue(environment, value.property, pose.values[value.value]);
}

Material materialAt(const Material& material, std::span<const AnimatedValue> values, const Pose& pose) {
  Material changed = material;
  for (const AnimatedValue& value : values) setMaterialValue(changed, value.property, pose.values[value.value]);
  return changed;
}

float lastFrame(const Scene& scene) {
  double last = 0.0;
  for (const Instance& instance : scene.instances)
    if (!instance.keyframes.empty()) last = std::max(last, double{instance.keyframes.back().frame});
  if (const NodeAnimation* animation = scene.nodeAnimation.get())
    for (const AnimationSampler& sampler : animation->animation.samplers)
      last = std::max(last, sampler.times.back() * animation->framesPerSecond);
  return static_cast<float>(last);
}

std::vector<mat4> jointMatrices(const Skin& skin, const Pose& pose) {
  std::vector<mat4> matrices;
  matrices.reserve(skin.joints.size());
  for (std::size_t i = 0; i < skin.joints.size(); ++i)
    matrices.push_back(pose.worldFromNode[static_cast<std::size_t>(skin.joints[i])] * skin.inverseBindMatrices[i]);
  return matrices;
}

void deformGeometry(const MeshDeformation& mesh, std::size_t index, const NodeAnimation& animation, const Pose& pose,
                    Geometry& out) {
  const GeometryDeformation& from = mesh.geometries[index];
  const auto node = static_cast<std::size_t>(mesh.node);
  out.positions = from.positions;
  out.normals = from.normals;
  out.tangents = from.tangents;
  if (!from.triangles.empty()) out.triangles = from.triangles;
  const std::vector<float>& weights = pose.weights[node];
  for (std::size_t i = 0; i < std::min(weights.size(), from.targets.size()); ++i)
    if (weights[i] != 0.0f) applyMorphTarget(out, from.targets[i], weights[i]);
  if (mesh.skin != kNone && !from.skinSets.empty()) {
    applySkin(out, from.skinSets, jointMatrices(animation.skins[static_cast<std::size_t>(mesh.skin)], pose));
  } else if (mesh.skin != kNone) {
    transformVertices(out, pose.worldFromNode[node]);
  }
  restoreNonFinite(out.positions, from.positions);
  if (from.faceNormals) std::ranges::fill(out.normals, vec3(0.0f));  // replaced by the only face normal
  repairNormals(out);
  repairTangents(out);
}

void applyPose(Scene& scene, const Pose& pose, Hidden hidden) {
  const bool hide = hidden == Hidden::hide;
  for (Instance& instance : scene.instances)
    instance.worldFromObject = hide ? shownTransformAt(instance, pose) : worldFromObjectAt(instance, pose);
  for (Camera& camera : scene.cameras) camera = cameraAt(camera, pose);
  moveEnvironment(scene.environment, pose);
  for (Light& light : scene.lights) {
    const int visibleNode = std::exchange(light.visibleNode, hide ? light.visibleNode : kNone);
    light = lightAt(light, pose);
    light.visibleNode = visibleNode;
  }
  if (scene.nodeAnimation)
    for (const AnimatedMaterial& animated : scene.nodeAnimation->materials) {
      Material& material = scene.materials[static_cast<std::size_t>(animated.material)];
      material = materialAt(material, animated.values, pose);
    }
  for (Mesh& mesh : scene.meshes) {
    if (!mesh.deformation) continue;
    for (std::size_t g = 0; g < mesh.geometries.size(); ++g)
      deformGeometry(*mesh.deformation, g, *scene.nodeAnimation, pose, mesh.geometries[g]);
  }
}

}  // namespace quintet::scene

// SPDX-License-Identifier: Apache-2.0
#include "deformed_scene.h"

#include <limits>
#include <utility>

#include "scene/animation/pose.h"
#include "scene/geometry/repair.h"
#include "scene/geometry/tangents.h"

namespace quintet::test {

using scene::AnimatedProperty;

int DeformedScene::addNode() {
  animation_.order.push_back(static_cast<int>(animation_.nodes.size()));
  animation_.nodes.emplace_back();
  return animation_.order.back();
}

// Two values: at 0 s and 1 s.
void DeformedScene::addChannel(int node, AnimatedProperty property, std::vector<float> values) {
  scene::AnimationSampler& sampler = animation_.animation.samplers.emplace_back();
  sampler.times = {0, 1};
  sampler.valueSize = values.size() / 2;
  sampler.values = std::move(values);
  animation_.animation.channels.push_back({node, property, animation_.animation.samplers.size() - 1});
}

int DeformedScene::addSkin(std::size_t joints, const std::array<vec3, 2>& first, const vec3& last) {
  const int root = addNode();
  addChannel(root, AnimatedProperty::translation, {0, 0, 0, 1, 0.5f, -0.5f});
  scene::Skin& skin = animation_.skins.emplace_back();
  for (std::size_t j = 0; j < joints; ++j) {
    const int joint = addNode();
    animation_.nodes[static_cast<std::size_t>(joint)].parent = root;
    std::vector<float> rotations, translations, scales;
    for (int key = 0; key < 2; ++key) {
      const quat q = glm::normalize(quat(1.0f, vector(0.4f)));
      const vec3 t = vector(1.0f), s = (key == 0 ? first[j % 2] : last) * (1.0f + vector(0.3f));
      rotations.insert(rotations.end(), {q.x, q.y, q.z, q.w});
      translations.insert(translations.end(), {t.x, t.y, t.z});
      scales.insert(scales.end(), {s.x, s.y, s.z});
    }
    addChannel(joint, AnimatedProperty::rotation, rotations);
    addChannel(joint, AnimatedProperty::translation, translations);
    addChannel(joint, AnimatedProperty::scale, scales);
    skin.joints.push_back(joint);
    mat4& inverseBind = skin.inverseBindMatrices.emplace_back(1.0f);
    inverseBind[3] = vec4(vector(0.5f), 1.0f);
  }
  return static_cast<int>(animation_.skins.size()) - 1;
}

// A bumpy grid.
scene::Geometry DeformedScene::geometry(const DeformedMeshOptions& options) {
  constexpr std::uint32_t kColumns = 7, kRows = 11;
  scene::Geometry geometry;
  for (std::uint32_t y = 0; y < kRows; ++y)
    for (std::uint32_t x = 0; x < kColumns; ++x) {
      geometry.positions.push_back(0.3f * vec3(x, y, 0) + vector(0.1f));
      geometry.uvs[0].push_back(0.1f * vec2(x, y));
      if (options.normals) geometry.normals.push_back(glm::normalize(vec3(0, 0, 1) + vector(0.5f)));
      if (x == 0 || y == 0) continue;
      const std::uint32_t corner = y * kColumns + x;
      geometry.triangles.push_back({corner - kColumns - 1, corner - kColumns, corner});
      geometry.triangles.push_back({corner - kColumns - 1, corner, corner - 1});
    }
  if (options.faceNormals) scene::splitIntoFlatTriangles(geometry);
  if (options.tangents) scene::generateTangents(geometry, {});
  return geometry;
}

scene::GeometryDeformation DeformedScene::deformation(const scene::Geometry& geometry,
                                                      const DeformedMeshOptions& options) {
  const std::size_t count = geometry.positions.size();
  scene::GeometryDeformation deformation;
  deformation.positions = geometry.positions;
  deformation.normals = geometry.normals;
  deformation.tangents = geometry.tangents;
  deformation.faceNormals = options.faceNormals;
  if (options.skin >= 0) deformation.triangles = geometry.triangles;
  const auto displacements = [&](bool present) {
    std::vector<vec3> values(present ? count : 0);
    for (vec3& value : values) value = vector(0.3f);
    return values;
  };
  for (std::size_t t = 0; t < options.targets; ++t)
    deformation.targets.push_back(
        {displacements(t != 1), displacements(options.targetNormals), displacements(options.targetTangents)});
  const std::size_t joints =
      options.skin < 0 ? 0 : animation_.skins[static_cast<std::size_t>(options.skin)].joints.size();
  for (std::size_t s = 0; s < options.skinSets; ++s) {
    scene::SkinSet& set = deformation.skinSets.emplace_back();
    for (std::size_t i = 0; i < count; ++i) {
      glm::u16vec4& of = set.joints.emplace_back();
      for (glm::length_t c = 0; c < 4; ++c) of[c] = static_cast<std::uint16_t>(random_() % joints);
      set.weights.emplace_back(number(0.1f, 1), number(0, 1), number(0, 0.5f), random_() % 2 == 0 ? 0.0f : 0.2f);
    }
  }
  if (options.broken) breakVertices(deformation);
  return deformation;
}

void DeformedScene::breakVertices(scene::GeometryDeformation& deformation) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  if (deformation.targets.size() > 2) {
    scene::MorphTarget& target = deformation.targets[2];  // of weight 1
    target.positions[3] = vec3(inf, 0, 0);
    target.positions[8] = vec3(0, nan, 0);
    for (std::size_t i = 0; i < target.normals.size(); i += 3) target.normals[i] = -deformation.normals[i];
    for (std::size_t i = 0; i < target.tangents.size(); i += 4) target.tangents[i] = -vec3(deformation.tangents[i]);
    if (!target.normals.empty()) target.normals[10] = vec3(nan);
  }
  for (scene::SkinSet& set : deformation.skinSets) {
    set.weights[1] = vec4(0.0f);
    set.weights[2] = vec4(nan, 0, 0, 0);
    set.weights[4] = vec4(inf, 1, 0, 0);
    set.weights[5] = vec4(-1, 0.5f, 0, 0);
  }
}

void DeformedScene::addMesh(const DeformedMeshOptions& options) {
  const int node = addNode();
  addChannel(node, AnimatedProperty::translation, {0, 0, 0, 1, 2, 3});
  if (options.targets > 0) {
    std::vector<float> weights;
    for (int key = 0; key < 2; ++key)
      for (std::size_t t = 0; t < options.targets; ++t)
        weights.push_back(options.broken ? (t == 2 ? 1.0f : 0.0f) : t == 0 && key == 0 ? 0.0f : number(-1, 1));
    addChannel(node, AnimatedProperty::weights, weights);
    animation_.nodes.back().weights.resize(options.targets, 0.0f);
  }
  scene::Mesh& mesh = scene_.meshes.emplace_back();
  mesh.geometries.push_back(geometry(options));
  auto deformed = std::make_shared<scene::MeshDeformation>();
  deformed->node = node;
  deformed->skin = options.skin;
  deformed->geometries.push_back(deformation(mesh.geometries[0], options));
  mesh.deformation = std::move(deformed);
  scene::Instance& instance = scene_.instances.emplace_back();
  instance.mesh = static_cast<int>(scene_.meshes.size()) - 1;
}

scene::Scene DeformedScene::build() {
  scene_.nodeAnimation = std::make_shared<scene::NodeAnimation>(animation_);
  scene::applyPose(scene_, scene::poseAt(scene_.nodeAnimation.get(), 0.0));
  return std::move(scene_);
}

}  // namespace quintet::test

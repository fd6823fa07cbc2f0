// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf_animation.h"

#include <algorithm>

#include "base/file.h"
#include "scene/load.h"

namespace quintet::test {

void AnimationBuilder::addAnimation(const std::string& name) {
  root["animations"].push_back({{"name", name}, {"channels", Json::array()}, {"samplers", Json::array()}});
}

void AnimationBuilder::addChannel(int node, const std::string& path, const std::vector<float>& times,
                                  const std::vector<float>& values, const std::string& interpolation) {
  if (!root.contains("animations")) addAnimation("Move");
  Json& animation = root["animations"].back();
  const std::string type = path == "weights" ? "SCALAR" : path == "rotation" ? "VEC4" : "VEC3";
  const int input = addAccessor(times, "SCALAR"), output = addAccessor(values, type);
  animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
}

void AnimationBuilder::addPointer(const std::string& pointer, const std::vector<float>& times,
                                  const std::vector<float>& values, const std::string& type,
                                  const std::string& interpolation) {
  if (!root.contains("animations")) addAnimation("Move");
  Json& used = root["extensionsUsed"];
  if (std::ranges::find(used, Json("KHR_animation_pointer")) == used.end()) used.push_back("KHR_animation_pointer");
  Json& animation = root["animations"].back();
  const int input = addAccessor(times, "SCALAR"), output = addAccessor(values, type);
  animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size() - 1},
       {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}});
}

scene::Scene AnimationBuilder::loadAnimated(const std::optional<std::string>& animation, double framesPerSecond) const {
  const TempFolder folder;
  writeFile(folder / "scene.glb", glb());
  return scene::loadScene(folder / "scene.glb", {.animation = animation, .framesPerSecond = framesPerSecond});
}

AnimationBuilder movingTriangle() {
  AnimationBuilder builder;
  builder.addTriangle();
  builder.add("nodes", {{"children", {0}}, {"translation", {1, 0, 0}}});
  return builder;
}

AnimationBuilder bendingStrip(std::size_t sets) {
  AnimationBuilder builder;
  std::vector<float> positions, normals, uvs;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 2; ++x) {
      positions.insert(positions.end(), {static_cast<float>(x), static_cast<float>(y), 0.0f});
      normals.insert(normals.end(), {0.0f, 0.0f, 1.0f});
      uvs.insert(uvs.end(), {static_cast<float>(x), 1.0f - 0.5f * static_cast<float>(y)});
    }
  Json attributes = {{"POSITION", builder.addAccessor(positions, "VEC3")},
                     {"NORMAL", builder.addAccessor(normals, "VEC3")},
                     {"TEXCOORD_0", builder.addAccessor(uvs, "VEC2")}};
  // The lower vertices follow joint 0, the upper ones joint 1, those between both.
  const std::vector<float> lower{1, 0, 0, 0}, between{0.5f, 0.5f, 0, 0}, upper{0, 1, 0, 0};
  std::vector<float> weights;
  for (const std::vector<float>& row : {lower, between, upper})
    for (int x = 0; x < 2; ++x) weights.insert(weights.end(), row.begin(), row.end());
  std::vector<std::uint8_t> joints;
  for (int i = 0; i < 6; ++i) joints.insert(joints.end(), {0, 1, 0, 0});
  for (std::size_t set = 0; set < sets; ++set) {
    attributes["JOINTS_" + std::to_string(set)] = builder.addAccessor(joints, "VEC4");
    attributes["WEIGHTS_" + std::to_string(set)] = builder.addAccessor(weights, "VEC4");
  }
  builder.addMesh({{"attributes", attributes},
                   {"indices", builder.addAccessor<std::uint16_t>({0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4}, "SCALAR")}});
  builder.add("nodes", {{"children", {2}}});
  builder.add("nodes", {{"translation", {0, 1, 0}}});
  const std::vector<float> bind{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                                1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1};
  builder.add("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", builder.addAccessor(bind, "MAT4")}});
  builder.root["nodes"][0]["skin"] = 0;
  const float half = std::sqrt(0.5f);
  builder.addChannel(2, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, half, half});
  return builder;
}

AnimationBuilder morphingTriangle() {
  AnimationBuilder builder;
  const int positions = builder.addAccessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const int normals = builder.addAccessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  const int forward = builder.addAccessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  const int sideways = builder.addAccessor<float>({1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3");
  const int up = builder.addAccessor<float>({0, 0, 0, 0, 0, 0, 0, 2, 0}, "VEC3");
  builder.addMesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
                   {"targets", {{{"POSITION", forward}, {"NORMAL", sideways}}, {{"POSITION", up}}}}});
  builder.root["meshes"][0]["weights"] = {0.5, 0};
  builder.addChannel(0, "weights", {0, 1, 2}, {0, 0, 1, 0, 0, 1});
  return builder;
}

}  // namespace quintet::test

// SPDX-License-Identifier: Apache-2.0
#include "scene/model/names.h"

#include <fmt/format.h>

#include <unordered_map>
#include <unordered_set>

namespace quintet::scene {
namespace {

void makeUnique(std::vector<std::string>& names) {
  // Names from the file have precedence over generated names.
  const std::unordered_set<std::string> given(names.begin(), names.end());
  std::unordered_set<std::string> taken;
  std::unordered_map<std::string, std::size_t> next;  // next number to try for a repeated name
  for (std::string& name : names) {
    if (taken.insert(name).second) continue;
    std::size_t& number = next.try_emplace(name, 2).first->second;
    std::string candidate;
    do {
      candidate = fmt::format("{}#{}", name, number++);
    } while (given.contains(candidate) || taken.contains(candidate));
    name = candidate;
    taken.insert(std::move(candidate));
  }
}

}  // namespace

std::vector<std::string> instanceNames(const Scene& scene) {
  std::vector<std::string> names;
  for (const Instance& instance : scene.instances) {
    std::string name = instance.name;
    if (name.empty() && instance.mesh != kNone) name = scene.meshes[static_cast<std::size_t>(instance.mesh)].name;
    names.push_back(name.empty() ? "instance" : std::move(name));
  }
  makeUnique(names);
  return names;
}

std::vector<std::string> materialNames(const Scene& scene) {
  std::vector<std::string> names;
  for (const Material& material : scene.materials) names.push_back(material.name.empty() ? "material" : material.name);
  names.emplace_back("default");
  makeUnique(names);
  return names;
}

std::vector<std::string> lightNames(const Scene& scene) {
  std::vector<std::string> names;
  for (const Light& light : scene.lights) names.push_back(light.name.empty() ? "light" : light.name);
  makeUnique(names);
  return names;
}

std::string nameForMessages(const Scene& scene) { return scene.name.empty() ? "scene in memory" : scene.name; }

const char* nameOf(LightType type) {
  switch (type) {
    case LightType::point: return "point";
    case LightType::spot: return "spot";
    case LightType::directional: return "directional";
  }
  return "";
}

}  // namespace quintet::scene

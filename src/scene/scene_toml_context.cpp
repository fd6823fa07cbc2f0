#include "scene/scene_toml_context.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

namespace quintet::scene {
namespace {

template <class Map>
std::vector<std::string> keysOf(const Map& map) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : map) keys.push_back(key);
  return keys;
}

}  // namespace

const std::vector<TomlValue>& SceneTomlContext::tables(TomlReader& root, const std::string& key) const {
  const TomlValue* value = root.find(key);
  if (value && value->kind != TomlValue::Kind::array) fail(*value, fmt::format("'{}' is written as [[{}]]", key, key));
  return root.list(key);
}

void SceneTomlContext::checkName(const TomlValue& at, const std::string& name) const {
  if (name.empty()) fail(at, "a name must not be empty");
  if (name.find('/') != std::string::npos)
    fail(at, fmt::format("'{}': a name has no '/', which leads into a [[file]]", name));
}

std::filesystem::path SceneTomlContext::resolve(const TomlValue& at, const std::string& path) const {
  if (path.empty() || path.find('\0') != std::string::npos) fail(at, "the path is empty or has a zero byte");
  const std::filesystem::path full = folder / path;
  std::error_code error;
  if (!std::filesystem::is_regular_file(full, error)) fail(at, fmt::format("there is no file '{}'", full.string()));
  return full;
}

int SceneTomlContext::findMaterial(const TomlValue& name) const {
  if (name.kind != TomlValue::Kind::text) fail(name, "a material is named by a text in quotes");
  const auto found = materials.find(name.text);
  if (found == materials.end())
    fail(name, fmt::format("there is no material '{}'{}", name.text, didYouMean(name.text, keysOf(materials))));
  return found->second;
}

int SceneTomlContext::defaultMaterial() {
  if (defaultMaterial_ == kNone) {
    Material material;
    material.name = "default";
    material.baseColor = vec4(0.8f, 0.8f, 0.8f, 1.0f);
    material.metallic = 0.0f;
    defaultMaterial_ = static_cast<int>(scene.materials.size());
    scene.materials.push_back(std::move(material));
  }
  return defaultMaterial_;
}

void SceneTomlContext::fillMaterials(PrimitiveSet& set) {
  for (Primitive& primitive : set.primitives)
    if (primitive.material == kNone) primitive.material = defaultMaterial();
}

int SceneTomlContext::readMaterialKey(TomlReader& reader) const {
  const TomlValue* name = reader.find("material");
  return name ? findMaterial(*name) : kNone;
}

int SceneTomlContext::meshFor(TomlReader& reader, const std::string& name, bool procedural) {
  const TomlValue* object = reader.find("object");
  const std::string objectName = object ? reader.toText(*object, "object") : name;
  if (object) {
    checkName(*object, objectName);
    if (const auto known = objects_.find(objectName); known != objects_.end()) {
      if (scene.meshes[static_cast<std::size_t>(known->second)].procedural() != procedural)
        fail(*object,
             fmt::format("object '{}' has triangles and boxes: Vulkan does not mix them in one acceleration structure",
                         objectName));
      return known->second;
    }
  }
  const auto mesh = static_cast<int>(scene.meshes.size());
  scene.meshes.emplace_back().name = objectName;
  InstanceTarget target;
  Instance& instance = target.instances.emplace_back();
  instance.name = objectName;
  instance.mesh = mesh;
  addTarget(object ? *object : reader.table(), objectName, std::move(target));
  if (object) objects_[objectName] = mesh;
  return mesh;
}

void SceneTomlContext::addTarget(const TomlValue& at, const std::string& name, InstanceTarget target) {
  target.line = at.line;
  // Without a name it can only stand at the origin.
  const std::string key = name.empty() ? fmt::format("/{}", targets.size()) : name;
  const auto [entry, isNew] = targets.emplace(key, std::move(target));
  if (!isNew) fail(at, fmt::format("'{}' is already the name of what line {} describes", name, entry->second.line));
}

std::string describeTable(const std::string& key, const TomlValue& table) {
  const TomlValue* name = table.find("name");
  return name && name->kind == TomlValue::Kind::text ? fmt::format("[[{}]] '{}'", key, name->text)
                                                     : fmt::format("[[{}]]", key);
}

}  // namespace quintet::scene

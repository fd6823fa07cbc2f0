// SPDX-License-Identifier: Apache-2.0
#include "scene/toml/context.h"

#include <fmt/format.h>

#include <charconv>

#include "base/error.h"
#include "base/file.h"
#include "base/file_roots.h"
#include "base/suggestion.h"
#include "io/codec.h"
#include "io/color.h"
#include "scene/model/limits.h"

namespace quintet::scene {
namespace {

template <class Map>
std::vector<std::string> keysOf(const Map& map) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : map) keys.push_back(key);
  return keys;
}

}  // namespace

void SceneTomlContext::checkName(const TomlValue& at, const std::string& name) const {
  if (name.empty()) fail(at, "a name must not be empty");
  if (name.find('/') != std::string::npos)
    fail(at, fmt::format("'{}': a name must not contain '/', which separates a [[file]] from its parts", name));
}

std::filesystem::path SceneTomlContext::resolvePath(const TomlValue& at, const std::string& path) const {
  if (path.empty() || path.find('\0') != std::string::npos) fail(at, "the path is empty or contains a zero byte");
  const std::filesystem::path full = folder / path;
  if (!FileRoots::fromEnvironment().allows(full)) fail(at, fmt::format("file '{}' {}", path, kOutsideOfRoots));
  std::error_code error;
  if (!std::filesystem::is_regular_file(full, error)) fail(at, fmt::format("file '{}' not found", full.string()));
  return full;
}

io::Image SceneTomlContext::readImage(const std::filesystem::path& path) {
  io::Image image = io::readImage(path, budget);
  addImageFile(path, image);
  return image;
}

io::Image SceneTomlContext::readRadiance(const std::filesystem::path& path) {
  io::Image image = io::readRadiance(path, budget);
  addImageFile(path, image);
  return image;
}

void SceneTomlContext::addImageFile(const std::filesystem::path& path, io::Image& image) {
  scene.report.files.push_back(path);
  if (const std::string repair = repairTexels(image); !repair.empty())
    scene.report.repaired.push_back(fmt::format("{}: {}", path.filename().string(), repair));
}

int SceneTomlContext::findMaterial(const TomlValue& name) const {
  if (name.kind != TomlValue::Kind::text) fail(name, "the name of a material must be a string");
  const auto found = materials.find(name.text);
  if (found == materials.end())
    fail(name, fmt::format("unknown material '{}'{}", name.text, suggestion(name.text, keysOf(materials))));
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

void SceneTomlContext::applyDefaultMaterial(PrimitiveSet& set) {
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
             fmt::format("object '{}' has triangles and boxes, which Vulkan cannot mix in one acceleration structure",
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
  // An object without a name gets an internal key, which no [[instance]] can refer to.
  const std::string key = name.empty() ? fmt::format("/{}", targets.size()) : name;
  const auto [entry, isNew] = targets.emplace(key, std::move(target));
  if (!isNew) fail(at, fmt::format("the name '{}' is already used in line {}", name, entry->second.line));
}

std::string describeTable(const std::string& key, const TomlValue& table) {
  const TomlValue* name = table.find("name");
  return name && name->kind == TomlValue::Kind::text ? fmt::format("[[{}]] '{}'", key, name->text)
                                                     : fmt::format("[[{}]]", key);
}

vec3 toColor(const TomlReader& reader, const TomlValue& value, std::string_view name, const NumberRange& range) {
  if (value.kind != TomlValue::Kind::text) return reader.toTriple(value, name, range);
  vec3 color(0.0f);
  bool valid = value.text.size() == 7 && value.text[0] == '#';
  for (std::size_t i = 0; valid && i < 3; ++i) {
    const char* digits = value.text.data() + 1 + 2 * i;
    unsigned byte = 0;
    valid = std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2;
    color[i] = io::linearFromSrgb(static_cast<float>(byte) / 255.0f);
  }
  if (!valid) reader.failType(value, name, "three linear numbers or an sRGB color such as \"#ff8000\"");
  return color;
}

vec3 readColor(TomlReader& reader, const std::string& key, const vec3& fallback, const NumberRange& range) {
  const TomlValue* value = reader.find(key);
  return value ? toColor(reader, *value, key, range) : fallback;
}

}  // namespace quintet::scene

// SPDX-License-Identifier: Apache-2.0
// [[instance]]: instances of meshes, primitive sets and glTF files. Then, once at the origin, the objects that no
// instance refers to.
#include <fmt/format.h>

#include <algorithm>

#include "base/suggestion.h"
#include "scene/animation/keyframes.h"
#include "scene/geometry/repair.h"
#include "scene/toml/context.h"
#include "scene/toml/keyframes.h"
#include "scene/toml/transform.h"

namespace quintet::scene {
namespace {

constexpr std::uint32_t kMaxInstances = (1u << 24) - 1;  // Vulkan guarantees at least this
constexpr std::size_t kBytesPerInstance = 3 * sizeof(Instance) + sizeof(Placement);

struct FlagName {
  const char* name;
  std::uint32_t bit;
};
constexpr FlagName kFlags[] = {{"force_opaque", kInstanceForceOpaque},
                               {"force_no_opaque", kInstanceForceNoOpaque},
                               {"cull_disable", kInstanceCullDisable},
                               {"flip_facing", kInstanceFlipFacing}};

std::uint32_t readFlags(TomlReader& reader) {
  std::uint32_t flags = 0;
  std::vector<std::string> names;
  for (const FlagName& flag : kFlags) names.emplace_back(flag.name);
  for (const TomlValue& value : reader.list("flags")) {
    const std::string name = reader.toText(value, "flags");
    const auto found = std::ranges::find(names, name);
    if (found == names.end())
      reader.fail(value, fmt::format("unknown instance flag '{}'{}", name, suggestionOrList(name, names)));
    flags |= kFlags[found - names.begin()].bit;
  }
  if ((flags & kInstanceForceOpaque) && (flags & kInstanceForceNoOpaque))
    reader.fail(*reader.find("flags"), "force_opaque and force_no_opaque are mutually exclusive");
  return flags;
}

// A missing key has its value from the keyframe before; in the first keyframe, from the instance (`start`).
std::vector<Keyframe> readKeyframes(KeyframeList& list, const Keyframe& start) {
  std::vector<Keyframe> keys;
  for (std::size_t i = 0; i < list.size(); ++i) {
    TomlReader& reader = list.table(i);
    Keyframe key = readParts(reader, keys.empty() ? start : keys.back());
    key.frame = list.frame(i);
    if (!keys.empty() && !(key.frame > keys.back().frame))
      reader.fail(fmt::format("{} is too close to the keyframe before", reader.what()));
    checkInvertible(reader, reader.table(), matrixOf(key));
    for (int axis = 0; axis < 3; ++axis)
      if (!keys.empty() && (key.scale[axis] > 0.0f) != (keys.front().scale[axis] > 0.0f))
        reader.fail(fmt::format("{}: 'scale' changes its sign, so that it would pass through 0", reader.what()));
    keys.push_back(key);
  }
  return keys;
}

// Reads the keyframes of an instance, and lists them in the report.
void addKeyframes(SceneTomlContext& context, TomlReader& reader, KeyframeList& list, Instance& instance) {
  instance.keyframes = readKeyframes(list, list.empty() ? Keyframe{} : readParts(reader));
  instance.interpolation = {list.interpolationOf("translate"), list.interpolationOf("rotate"),
                            list.interpolationOf("scale")};
  list.rejectUnknownKeys();
  addSummary(context, reader, list, {"translate", "rotate", "scale"});
}

InstanceTarget& findTarget(SceneTomlContext& context, TomlReader& reader) {
  const TomlValue& value = reader.require("of");
  const std::string name = reader.toText(value, "of");
  const auto found = name.starts_with('/') ? context.targets.end() : context.targets.find(name);
  if (found != context.targets.end()) {
    found->second.placed = true;
    // A file with placed parts is not placed as a whole by default.
    if (const std::size_t slash = name.find('/'); slash != std::string::npos)
      context.targets.at(name.substr(0, slash)).placedByDefault = false;
    return found->second;
  }
  std::vector<std::string> names;
  for (const auto& [known, target] : context.targets)
    if (!known.starts_with('/')) names.push_back(known);
  reader.fail(value, fmt::format("'of' of {}: unknown name '{}'{}", reader.what(), name, suggestion(name, names)));
}

// Adds the lights of a file, which belong to each placement, and its cameras, which belong only to the first one.
void addView(SceneTomlContext& context, const InstanceTarget& target, const mat4& world, const std::string& name,
             bool cameras) {
  for (Light light : target.lights) {
    light.placedFromRoot = world;
    light.position = vec3(world * vec4(light.position, 1.0f));
    light.direction = glm::normalize(mat3(world) * light.direction);
    context.scene.lights.push_back(std::move(light));
  }
  if (!cameras) return;
  for (Camera camera : target.cameras) {
    camera.placedFromRoot = world;
    camera.worldFromCamera = rigidFrame(world * camera.worldFromCamera);
    camera.name = name + "/" + camera.name;
    context.scene.cameras.push_back(std::move(camera));
  }
}

void addInstances(SceneTomlContext& context, const TomlReader& reader, const InstanceTarget& target,
                  const Instance& pattern, const mat4& outer, const Placement* placement) {
  const mat4 inner = placement ? matrixOf(*placement) : mat4(1.0f);
  for (const Instance& part : target.instances) {
    Instance instance = pattern;
    instance.mesh = part.mesh;
    instance.node = part.node;
    instance.visibleNode = part.visibleNode;
    if (target.instances.size() > 1) instance.name += "/" + part.name;
    const bool keyed = !instance.keyframes.empty();
    const mat4 start = keyed ? keyframeMatrixAt(instance.keyframes, 0.0f, instance.interpolation) : outer;
    instance.worldFromObject = start * inner * part.worldFromObject;
    if (part.node != kNone) {
      instance.animatedFromObject = part.animatedFromObject;
      instance.placedFromRoot = keyed ? inner : outer * inner;
    } else if (keyed) {
      instance.animatedFromObject = inner * part.worldFromObject;
    }
    // A moving part can be flattened at frame 0.
    checkInvertible(reader, reader.table(), part.node != kNone ? start * inner : instance.worldFromObject);
    context.scene.instances.push_back(std::move(instance));
  }
}

void readInstance(SceneTomlContext& context, const TomlValue& table) {
  TomlReader reader(table, describeTable("instance", table), context.file);
  InstanceTarget& target = findTarget(context, reader);
  Instance pattern;
  pattern.name = reader.text("name", reader.text("of"));
  pattern.mask = reader.integer("mask", 0xFF, 0, 0xFF);
  pattern.flags = readFlags(reader);
  pattern.customIndex = reader.integer("custom_index", 0, 0, 0xFFFFFF);
  const mat4 outer = readTransform(reader);
  const TomlValue* keyframes = reader.find("keyframes");
  if (keyframes && reader.has("matrix"))
    reader.fail(*keyframes, fmt::format("'matrix' and 'keyframes' of {} are mutually exclusive", reader.what()));
  KeyframeList list(reader, context.options.framesPerSecond);
  addKeyframes(context, reader, list, pattern);
  PlacementOptions options;
  options.sizeKey = "scale";
  options.materials = false;
  options.maxCount = kMaxInstances;
  options.bytesEach = kBytesPerInstance * target.instances.size();
  const std::vector<Placement> placements = readPlacements(context, reader, options);
  reader.rejectUnknownKeys();

  const std::size_t count = std::max<std::size_t>(1, placements.size()) * target.instances.size();
  if (context.scene.instances.size() + count > kMaxInstances)
    reader.fail(table, fmt::format("more than {} instances", kMaxInstances));
  context.budget.take(count * kBytesPerInstance);
  if (placements.empty()) {
    addView(context, target, outer, pattern.name, true);
    return addInstances(context, reader, target, pattern, outer, nullptr);
  }
  const std::string name = pattern.name;
  for (std::size_t i = 0; i < placements.size(); ++i) {
    pattern.name = fmt::format("{}[{}]", name, i);
    addView(context, target, outer * matrixOf(placements[i]), name, i == 0);
    addInstances(context, reader, target, pattern, outer, &placements[i]);
    pattern.customIndex = (pattern.customIndex + 1) & 0xFFFFFF;
  }
}

// Places the remaining objects at the origin, in the order of the file.
void addDefaultInstances(SceneTomlContext& context, const TomlReader& root) {
  std::vector<std::pair<const std::string*, const InstanceTarget*>> rest;
  for (const auto& [name, target] : context.targets)
    if (!target.placed && target.placedByDefault) rest.emplace_back(&name, &target);
  std::ranges::stable_sort(rest, {}, [](const auto& entry) { return entry.second->line; });
  for (const auto& [name, target] : rest) {
    Instance pattern;
    if (!name->starts_with('/')) pattern.name = *name;
    addView(context, *target, mat4(1.0f), *name, true);
    addInstances(context, root, *target, pattern, mat4(1.0f), nullptr);
  }
}

}  // namespace

void readInstances(SceneTomlContext& context, TomlReader& root) {
  for (const TomlValue& table : root.tables("instance")) readInstance(context, table);
  addDefaultInstances(context, root);
}

}  // namespace quintet::scene

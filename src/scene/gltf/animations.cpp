// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/animations.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/plural.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "scene/animation/properties.h"
#include "scene/gltf/accessor.h"
#include "scene/gltf/channel_targets.h"
#include "scene/gltf/extensions.h"

namespace quintet::scene {
namespace {

std::string locationOf(std::size_t animation) { return fmt::format("/animations/{}", animation); }

const tinygltf::Node& nodeAt(const Document& document, int index) {
  return document.model.nodes[static_cast<std::size_t>(index)];
}

// ---- Channels ----

struct PlayingChannel {
  std::size_t index;  // in the animation
  std::vector<ChannelTarget> targets;
};

// The channels of an animation that play; reports the others.
std::vector<PlayingChannel> playingChannels(const Document& document, const std::vector<Material>& materials,
                                            std::size_t index, std::vector<std::string>* ignored) {
  const tinygltf::Animation& animation = document.model.animations[index];
  std::vector<PlayingChannel> playing;
  std::set<ChannelTarget> known;
  for (std::size_t i = 0; i < animation.channels.size(); ++i) {
    ResolvedChannel resolved = resolveChannel(document, materials, animation.channels[i]);
    for (const ChannelTarget& target : resolved.targets)
      if (!known.insert(target).second)
        resolved.problem = fmt::format("{} is already animated", describeTarget(animation.channels[i]));
    if (resolved.problem.empty())
      playing.push_back({i, std::move(resolved.targets)});
    else if (ignored)
      ignored->push_back(
          fmt::format("{}/channels/{}/target{}: {}", locationOf(index), i, resolved.location, resolved.problem));
  }
  return playing;
}

// ---- Samplers ----

const tinygltf::AnimationSampler& samplerOf(const Document& document, std::size_t animation, std::size_t channel) {
  const tinygltf::Animation& from = document.model.animations[animation];
  const int sampler = from.channels[channel].sampler;
  if (static_cast<std::size_t>(sampler) >= from.samplers.size())
    document.fail(fmt::format("{}/channels/{}/sampler", locationOf(animation), channel),
                  fmt::format("sampler {} does not exist; the animation has {}", sampler, from.samplers.size()));
  return from.samplers[static_cast<std::size_t>(sampler)];
}

std::vector<float> readTimes(const Document& document, int accessor, const std::string& location) {
  std::vector<float> times = readFloats(document, accessor, location);
  if (times.empty()) document.fail(location, "has no times");
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i])) document.fail(location, fmt::format("time {} is not finite", i));
    if (i > 0 && !(times[i] > times[i - 1]))
      document.fail(location, fmt::format("time {} is {}, which is not after {}", i, times[i], times[i - 1]));
  }
  return times;
}

template <class Vector>
std::vector<float> flattened(const std::vector<Vector>& values) {
  std::vector<float> floats;
  floats.reserve(values.size() * static_cast<std::size_t>(Vector::length()));
  for (const Vector& value : values)
    for (std::size_t c = 0; c < static_cast<std::size_t>(Vector::length()); ++c) floats.push_back(value[c]);
  return floats;
}

std::vector<float> readValues(const Document& document, int accessor, const std::string& location,
                              const ChannelTarget& target) {
  if (target.object == ChannelTarget::Object::node && target.nodeProperty() == AnimatedProperty::weights)
    return readFloats(document, accessor, location, Integers::unit);
  if (target.object == ChannelTarget::Object::node && target.nodeProperty() == AnimatedProperty::rotation)
    return flattened(readVec4(document, accessor, location, Integers::unit));
  switch (target.size) {
    case 2: return flattened(readVec2(document, accessor, location, Integers::asStated));
    case 3: return flattened(readVec3(document, accessor, location, Integers::asStated));
    case 4: return flattened(readVec4(document, accessor, location, Integers::asStated));
    default: return readFloats(document, accessor, location);
  }
}

AnimationSampler readSampler(const Document& document, const tinygltf::AnimationSampler& from,
                             const std::string& location, const ChannelTarget& target) {
  AnimationSampler sampler;
  if (from.interpolation == "STEP") sampler.interpolation = Interpolation::step;
  if (from.interpolation == "CUBICSPLINE") sampler.interpolation = Interpolation::cubicSpline;
  sampler.times = readTimes(document, from.input, location + "/input");
  const std::string output = location + "/output";
  sampler.valueSize = target.size;
  sampler.values = readValues(document, from.output, output, target);
  const std::size_t perTime = sampler.valueSize * (sampler.interpolation == Interpolation::cubicSpline ? 3 : 1);
  if (sampler.values.size() != sampler.times.size() * perTime)
    document.fail(output, fmt::format("{} for {} with {} each", counted(sampler.values.size(), "number"),
                                      counted(sampler.times.size(), "time"), perTime));
  if (!std::ranges::all_of(sampler.values, [](float v) { return std::isfinite(v); }))
    document.fail(output, "a value is not finite");
  return sampler;
}

std::string samplerLocation(std::size_t animation, int sampler) {
  return fmt::format("{}/samplers/{}", locationOf(animation), sampler);
}

// Reads the samplers and channels of one animation.
class AnimationReader {
 public:
  AnimationReader(const Document& document, std::size_t index, PlayedAnimation& played, NodeAnimation& data)
      : document_(document), index_(index), played_(played), data_(data) {}

  void read(const std::vector<Material>& materials) {
    const tinygltf::Animation& from = document_.model.animations[index_];
    data_.animation.name = from.name;
    for (const PlayingChannel& channel : playingChannels(document_, materials, index_, nullptr))
      for (const ChannelTarget& target : channel.targets) add(target, samplerFor(channel.index, target));
    for (auto& [material, values] : played_.materials) completeEmission(material, values);
    for (auto& [light, values] : played_.lights) completeIntensity(light, values);
  }

 private:
  // Several channels can share a sampler of the file. The size of morph weights depends on the node.
  std::size_t samplerFor(std::size_t channel, const ChannelTarget& target) {
    const tinygltf::AnimationSampler& from = samplerOf(document_, index_, channel);
    const int number = document_.model.animations[index_].channels[channel].sampler;
    const bool rotation =
        target.object == ChannelTarget::Object::node && target.nodeProperty() == AnimatedProperty::rotation;
    const bool weights =
        target.object == ChannelTarget::Object::node && target.nodeProperty() == AnimatedProperty::weights;
    const std::pair<int, std::size_t> key{number, rotation ? 0 : target.size};
    if (const auto found = known_.find(key); found != known_.end() && !weights) return found->second;
    data_.animation.samplers.push_back(readSampler(document_, from, samplerLocation(index_, number), target));
    const std::size_t sampler = data_.animation.samplers.size() - 1;
    if (!weights) known_[key] = sampler;
    return sampler;
  }

  void add(const ChannelTarget& target, std::size_t sampler) {
    switch (target.object) {
      case ChannelTarget::Object::node:
        data_.animation.channels.push_back({target.index, target.nodeProperty(), sampler});
        break;
      case ChannelTarget::Object::material: addValue(played_.materials[target.index], target.property, sampler); break;
      case ChannelTarget::Object::light: addValue(played_.lights[target.index], target.property, sampler); break;
      case ChannelTarget::Object::camera: addValue(played_.cameras[target.index], target.property, sampler); break;
    }
  }

  // Sorted by property, which is the order in which values are set.
  void addValue(std::vector<AnimatedValue>& values, std::size_t property, std::size_t sampler) {
    data_.values.push_back(sampler);
    const auto after = std::ranges::upper_bound(values, property, {}, &AnimatedValue::property);
    values.insert(after, {property, data_.values.size() - 1});
  }

  // A scene has the product of a color and a factor. If one of them is animated, the other one must be known.
  void completeProduct(std::vector<AnimatedValue>& values, std::size_t color, std::size_t factor, const vec3& fileColor,
                       float fileFactor) {
    const auto find = [&](std::size_t property) {
      return std::ranges::find(values, property, &AnimatedValue::property);
    };
    const bool hasColor = find(color) != values.end(), hasFactor = find(factor) != values.end();
    if (hasColor == hasFactor) return;
    AnimationSampler sampler;
    if (hasColor) {
      sampler = data_.animation.samplers[data_.values[find(color)->value]];
      for (float& value : sampler.values) value *= fileFactor;
      data_.animation.samplers.push_back(std::move(sampler));
      data_.values[find(color)->value] = data_.animation.samplers.size() - 1;
      return;
    }
    sampler.times = {0.0f};
    sampler.values = {fileColor.x, fileColor.y, fileColor.z};
    sampler.valueSize = 3;
    data_.animation.samplers.push_back(std::move(sampler));
    addValue(values, color, data_.animation.samplers.size() - 1);
  }

  void completeEmission(int material, std::vector<AnimatedValue>& values) {
    const tinygltf::Material& from = document_.model.materials[static_cast<std::size_t>(material)];
    const std::string extension = "KHR_materials_emissive_strength";
    const tinygltf::Value* strength = findExtension(from.extensions, extension);
    completeProduct(values, findMaterialProperty("emissiveFactor")->index,
                    findMaterialProperty("extensions/" + extension + "/emissiveStrength")->index,
                    vec3(from.emissiveFactor[0], from.emissiveFactor[1], from.emissiveFactor[2]),
                    strength ? static_cast<float>(numberOf(*strength, "emissiveStrength", 1.0)) : 1.0f);
  }

  void completeIntensity(int light, std::vector<AnimatedValue>& values) {
    const tinygltf::Light& from = document_.model.lights[static_cast<std::size_t>(light)];
    const vec3 color = from.color.empty() ? vec3(1.0f) : vec3(from.color[0], from.color[1], from.color[2]);
    completeProduct(values, findLightProperty("color")->index, findLightProperty("intensity")->index, color,
                    static_cast<float>(from.intensity));
  }

  const Document& document_;
  std::size_t index_;
  PlayedAnimation& played_;
  NodeAnimation& data_;
  std::map<std::pair<int, std::size_t>, std::size_t> known_;
};

// ---- The node tree ----

AnimationNode readNode(const Document& document, std::size_t index, int parent) {
  const tinygltf::Node& from = document.model.nodes[index];
  AnimationNode node;
  node.parent = parent;
  if (!from.matrix.empty()) {
    node.matrix = localTransform(document, index);
    node.hasMatrix = true;
  }
  if (const auto& t = from.translation; !t.empty()) node.translation = {t[0], t[1], t[2]};
  if (const auto& s = from.scale; !s.empty()) node.scale = {s[0], s[1], s[2]};
  if (const auto& r = from.rotation; !r.empty()) {
    const glm::dquat q(r[3], r[0], r[1], r[2]);
    if (const double length = glm::length(q); length > 0.0) node.rotation = q / length;
  }
  node.visible = isVisible(document, index);
  const std::size_t targets = morphTargetCount(document, from);
  if (targets == 0) return node;
  const std::vector<double>& weights =
      from.weights.empty() ? document.model.meshes[static_cast<std::size_t>(from.mesh)].weights : from.weights;
  node.weights.assign(weights.begin(), weights.end());
  node.weights.resize(targets, 0.0f);
  return node;
}

Skin readSkin(const Document& document, std::size_t index) {
  const tinygltf::Skin& from = document.model.skins[index];
  return {from.joints, readInverseBindMatrices(document, index)};
}

std::size_t findAnimation(const Document& document, const std::string& name) {
  const auto& animations = document.model.animations;
  if (name.empty()) return 0;
  std::vector<std::string> names;
  for (const tinygltf::Animation& animation : animations) names.push_back(animation.name);
  if (const auto found = std::ranges::find(names, name); found != names.end())
    return static_cast<std::size_t>(found - names.begin());
  std::size_t index = 0;
  const char* const end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data(), end, index);
  if (error == std::errc{} && stop == end && index < animations.size()) return index;
  if (animations.empty())
    throw UsageError(fmt::format("{}: no animation '{}': the file has no animations", document.file.string(), name));
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i].empty()) names[i] = std::to_string(i);
  throw UsageError(printable(fmt::format("{}: no animation '{}'{}; available: {}", document.file.string(), name,
                                         suggestion(name, names), fmt::join(names, ", "))));
}

bool changesTransform(AnimatedProperty property) {
  return property != AnimatedProperty::weights && property != AnimatedProperty::visibility;
}

// The nodes with a channel whose property satisfies the condition, and their descendants.
template <class Condition>
std::vector<bool> findNodes(const NodeAnimation& data, const Condition& condition) {
  std::vector<bool> found(data.nodes.size(), false);
  for (const AnimationChannel& channel : data.animation.channels)
    if (condition(channel.property)) found[static_cast<std::size_t>(channel.node)] = true;
  for (const int node : data.order) {
    const int parent = data.nodes[static_cast<std::size_t>(node)].parent;
    if (parent != kNone && found[static_cast<std::size_t>(parent)]) found[static_cast<std::size_t>(node)] = true;
  }
  return found;
}

}  // namespace

std::vector<AnimationSummary> summarizeAnimations(const Document& document, const std::vector<Material>& materials,
                                                  Report& report) {
  std::vector<AnimationSummary> summaries;
  for (std::size_t a = 0; a < document.model.animations.size(); ++a) {
    const tinygltf::Animation& from = document.model.animations[a];
    AnimationSummary& summary = summaries.emplace_back();
    summary.name = printable(from.name);
    summary.channels = from.channels.size();
    const std::vector<PlayingChannel> playing = playingChannels(document, materials, a, &report.ignored);
    summary.ignored = summary.channels - playing.size();
    try {
      for (const PlayingChannel& channel : playing) {
        const tinygltf::AnimationSampler& sampler = samplerOf(document, a, channel.index);
        const std::string location = samplerLocation(a, from.channels[channel.index].sampler) + "/input";
        summary.seconds = std::max(summary.seconds, double{readTimes(document, sampler.input, location).back()});
      }
    } catch (const FileError& error) {  // the rest pose does not depend on it
      report.ignored.push_back(
          fmt::format("{}: cannot be played: {}: {}", locationOf(a), error.location(), error.problem()));
      summary.ignored = summary.channels;
    }
  }
  return summaries;
}

bool PlayedAnimation::movesSkin(const Document& document, int node) const {
  if (!data) return false;
  const tinygltf::Skin& skin = document.model.skins[static_cast<std::size_t>(nodeAt(document, node).skin)];
  return morphsNode(node) || movesNode(node) || std::ranges::any_of(skin.joints, [&](int j) { return movesNode(j); });
}

std::vector<AnimatedValue> PlayedAnimation::valuesOf(const std::map<int, std::vector<AnimatedValue>>& all, int object) {
  const auto found = all.find(object);
  return found == all.end() ? std::vector<AnimatedValue>() : found->second;
}

PlayedAnimation playAnimation(const Document& document, const NodeTree& tree, const std::vector<Material>& materials,
                              const std::string& name, double framesPerSecond) {
  if (document.model.animations.empty() && name.empty()) return {};
  const std::size_t index = findAnimation(document, name);
  auto data = std::make_shared<NodeAnimation>();
  PlayedAnimation played;
  data->framesPerSecond = framesPerSecond;
  AnimationReader(document, index, played, *data).read(materials);
  if (data->animation.channels.empty() && data->values.empty()) return {};
  for (std::size_t i = 0; i < document.model.nodes.size(); ++i)
    data->nodes.push_back(readNode(document, i, tree.parents[i]));
  data->order = tree.order;
  for (std::size_t i = 0; i < document.model.skins.size(); ++i) data->skins.push_back(readSkin(document, i));
  for (const auto& [material, values] : played.materials) data->materials.push_back({material, values});

  played.moves = findNodes(*data, changesTransform);
  played.toggles = findNodes(*data, [](AnimatedProperty property) { return property == AnimatedProperty::visibility; });
  played.morphs.assign(data->nodes.size(), false);
  for (const AnimationChannel& channel : data->animation.channels)
    if (channel.property == AnimatedProperty::weights) played.morphs[static_cast<std::size_t>(channel.node)] = true;
  played.data = std::move(data);
  played.index = static_cast<int>(index);
  return played;
}

}  // namespace quintet::scene

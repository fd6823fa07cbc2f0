// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/animations.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/plural.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "scene/gltf/accessor.h"

namespace quintet::scene {
namespace {

std::string locationOf(std::size_t animation) { return fmt::format("/animations/{}", animation); }

const tinygltf::Node& nodeAt(const Document& document, int index) {
  return document.model.nodes[static_cast<std::size_t>(index)];
}

std::size_t morphTargetCount(const Document& document, const tinygltf::Node& node) {
  if (node.mesh == kNone) return 0;
  const auto& primitives = document.model.meshes[static_cast<std::size_t>(node.mesh)].primitives;
  return primitives.empty() ? 0 : primitives[0].targets.size();
}

// ---- Channels ----

std::optional<AnimatedProperty> propertyOf(const std::string& path) {
  if (path == "translation") return AnimatedProperty::translation;
  if (path == "rotation") return AnimatedProperty::rotation;
  if (path == "scale") return AnimatedProperty::scale;
  if (path == "weights") return AnimatedProperty::weights;
  return std::nullopt;
}

// Why a channel cannot play; empty if it can.
std::string channelProblem(const Document& document, const tinygltf::AnimationChannel& channel) {
  const std::optional<AnimatedProperty> property = propertyOf(channel.target_path);
  if (!property) return fmt::format("path \"{}\" is not supported", channel.target_path.substr(0, 40));
  if (channel.target_node == kNone) return "no target node";
  const tinygltf::Node& node = nodeAt(document, channel.target_node);
  if (*property != AnimatedProperty::weights)
    return node.matrix.empty() ? ""
                               : fmt::format("node {} has a matrix, which cannot be animated", channel.target_node);
  if (morphTargetCount(document, node) == 0) return fmt::format("node {} has no morph targets", channel.target_node);
  return "";
}

// The channels of an animation that play; reports the others.
std::vector<std::size_t> playingChannels(const Document& document, std::size_t index,
                                         std::vector<std::string>* ignored) {
  const tinygltf::Animation& animation = document.model.animations[index];
  std::vector<std::size_t> playing;
  std::set<std::pair<int, std::string>> targets;
  for (std::size_t i = 0; i < animation.channels.size(); ++i) {
    const tinygltf::AnimationChannel& channel = animation.channels[i];
    std::string problem = channelProblem(document, channel);
    if (problem.empty() && !targets.insert({channel.target_node, channel.target_path}).second)
      problem = fmt::format("the {} of node {} is already animated", channel.target_path, channel.target_node);
    if (problem.empty())
      playing.push_back(i);
    else if (ignored)
      ignored->push_back(fmt::format("{}/channels/{}/target: {}", locationOf(index), i, problem));
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

AnimationSampler readSampler(const Document& document, const tinygltf::AnimationSampler& from,
                             const std::string& location, AnimatedProperty property, std::size_t targetCount) {
  AnimationSampler sampler;
  if (from.interpolation == "STEP") sampler.interpolation = Interpolation::step;
  if (from.interpolation == "CUBICSPLINE") sampler.interpolation = Interpolation::cubicSpline;
  sampler.times = readTimes(document, from.input, location + "/input");
  const std::string output = location + "/output";
  switch (property) {
    case AnimatedProperty::rotation:
      sampler.values = flattened(readVec4(document, from.output, output, Integers::unit));
      sampler.valueSize = 4;
      break;
    case AnimatedProperty::weights:
      sampler.values = readFloats(document, from.output, output, Integers::unit);
      sampler.valueSize = targetCount;
      break;
    default: sampler.values = flattened(readVec3(document, from.output, output)); sampler.valueSize = 3;
  }
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

Animation readAnimation(const Document& document, std::size_t index) {
  const tinygltf::Animation& from = document.model.animations[index];
  Animation animation;
  animation.name = from.name;
  std::map<std::pair<int, AnimatedProperty>, std::size_t> known;  // samplers that several channels share
  for (const std::size_t i : playingChannels(document, index, nullptr)) {
    const tinygltf::AnimationChannel& channel = from.channels[i];
    const tinygltf::AnimationSampler& sampler = samplerOf(document, index, i);
    const AnimatedProperty property = *propertyOf(channel.target_path);
    const std::size_t targets = morphTargetCount(document, nodeAt(document, channel.target_node));
    const auto read = [&] {
      animation.samplers.push_back(
          readSampler(document, sampler, samplerLocation(index, channel.sampler), property, targets));
      return animation.samplers.size() - 1;
    };
    std::size_t at = 0;
    if (property == AnimatedProperty::weights) {  // the size of the value depends on the node
      at = read();
    } else {
      const auto found = known.find({channel.sampler, property});
      at = found != known.end() ? found->second : (known[{channel.sampler, property}] = read());
    }
    animation.channels.push_back({channel.target_node, property, at});
  }
  return animation;
}

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

// A node moves with its ancestors.
std::vector<bool> findMovingNodes(const NodeAnimation& data) {
  std::vector<bool> moves(data.nodes.size(), false);
  for (const AnimationChannel& channel : data.animation.channels)
    if (channel.property != AnimatedProperty::weights) moves[static_cast<std::size_t>(channel.node)] = true;
  for (const int node : data.order) {
    const int parent = data.nodes[static_cast<std::size_t>(node)].parent;
    if (parent != kNone && moves[static_cast<std::size_t>(parent)]) moves[static_cast<std::size_t>(node)] = true;
  }
  return moves;
}

}  // namespace

std::vector<AnimationSummary> summarizeAnimations(const Document& document, Report& report) {
  std::vector<AnimationSummary> summaries;
  for (std::size_t a = 0; a < document.model.animations.size(); ++a) {
    const tinygltf::Animation& from = document.model.animations[a];
    AnimationSummary& summary = summaries.emplace_back();
    summary.name = printable(from.name);
    summary.channels = from.channels.size();
    const std::vector<std::size_t> playing = playingChannels(document, a, &report.ignored);
    summary.ignored = summary.channels - playing.size();
    try {
      for (const std::size_t i : playing) {
        const tinygltf::AnimationSampler& sampler = samplerOf(document, a, i);
        const std::string location = samplerLocation(a, from.channels[i].sampler) + "/input";
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

PlayedAnimation playAnimation(const Document& document, const NodeTree& tree, const std::string& name,
                              double framesPerSecond) {
  if (document.model.animations.empty() && name.empty()) return {};
  const std::size_t index = findAnimation(document, name);
  auto data = std::make_shared<NodeAnimation>();
  data->framesPerSecond = framesPerSecond;
  data->animation = readAnimation(document, index);
  if (data->animation.channels.empty()) return {};
  for (std::size_t i = 0; i < document.model.nodes.size(); ++i)
    data->nodes.push_back(readNode(document, i, tree.parents[i]));
  data->order = tree.order;
  for (std::size_t i = 0; i < document.model.skins.size(); ++i) data->skins.push_back(readSkin(document, i));

  PlayedAnimation played;
  played.moves = findMovingNodes(*data);
  played.morphs.assign(data->nodes.size(), false);
  for (const AnimationChannel& channel : data->animation.channels)
    if (channel.property == AnimatedProperty::weights) played.morphs[static_cast<std::size_t>(channel.node)] = true;
  played.data = std::move(data);
  played.index = static_cast<int>(index);
  return played;
}

}  // namespace quintet::scene

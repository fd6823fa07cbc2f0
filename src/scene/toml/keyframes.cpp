// SPDX-License-Identifier: Apache-2.0
#include "scene/toml/keyframes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace quintet::scene {
namespace {

const std::vector<std::string> kInterpolations{"step", "linear", "cubic"};  // in the order of Interpolation

Interpolation readInterpolation(TomlReader& reader, const std::string& key, Interpolation fallback) {
  return static_cast<Interpolation>(reader.choice(key, kInterpolations, static_cast<std::size_t>(fallback)));
}

vec4 toValue(const TomlReader& reader, const TomlValue& value, const KeyTrack& track) {
  vec4 result(0.0f);
  if (track.property.size == 1) {
    result.x = reader.toNumber(value, track.key);
    return result;
  }
  const std::vector<float> numbers = reader.toNumbers(value, track.key, track.property.size);
  for (std::size_t c = 0; c < numbers.size(); ++c) result[c] = numbers[c];
  return result;
}

// The slope of the line between the neighbors of a keyframe (Catmull and Rom 1974, for times that are not uniform); at
// the ends, that of the line to the only neighbor.
vec4 automaticTangent(const std::vector<float>& seconds, const std::vector<vec4>& values, std::size_t i) {
  const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, values.size() - 1);
  return (values[after] - values[before]) / (seconds[after] - seconds[before]);
}

// Reads a tangent, else the automatic one.
vec4 tangentOf(KeyframeList& list, const KeyTrack& track, const std::vector<float>& seconds, std::size_t i,
               bool outgoing) {
  const TomlValue* const value = list.has(track.key) ? list.tangent(i, track.key, outgoing) : nullptr;
  return value ? toValue(list.table(i), *value, track) : automaticTangent(seconds, track.values, i);
}

// Tangents belong to cubic splines.
void rejectTangents(KeyframeList& list, const KeyTrack& track) {
  for (std::size_t i = 0; i < list.size(); ++i)
    for (const bool outgoing : {false, true})
      if (const TomlValue* const tangent = list.tangent(i, track.key, outgoing))
        list.table(i).fail(*tangent, fmt::format("a tangent of '{}' in {} needs interpolation = \"cubic\"", track.key,
                                                 list.table(i).what()));
}

AnimationSampler samplerOf(KeyframeList& list, const KeyTrack& track) {
  AnimationSampler sampler;
  if (list.has(track.key)) sampler.interpolation = list.interpolationOf(track.key);  // else it is constant
  const bool cubic = sampler.interpolation == Interpolation::cubicSpline;
  if (!cubic && list.has(track.key)) rejectTangents(list, track);
  if (cubic && list.size() == 1) sampler.interpolation = Interpolation::step;  // a spline has two times
  sampler.times = list.seconds();
  sampler.valueSize = track.property.size;
  const auto append = [&](const vec4& value, std::size_t i, const char* problem) {
    const vec4 scaled = track.unit * value;
    if (!isFinite(scaled)) list.table(i).fail(fmt::format("'{}' {} {}", track.key, problem, list.table(i).what()));
    for (std::size_t c = 0; c < track.property.size; ++c)
      sampler.values.push_back(scaled[static_cast<glm::length_t>(c)]);
  };
  const auto appendTangent = [&](std::size_t i, bool outgoing) {
    if (sampler.interpolation == Interpolation::cubicSpline)
      append(tangentOf(list, track, sampler.times, i, outgoing), i, "changes too fast at");
  };
  for (std::size_t i = 0; i < list.size(); ++i)
    if (!isFinite(track.values[i])) append(track.values[i], i, "has no value before; set it in");
  for (std::size_t i = 0; i < list.size(); ++i) {
    appendTangent(i, false);
    append(track.values[i], i, "is too large in");
    appendTangent(i, true);
  }
  return sampler;
}

// The indices of the tracks to add.
std::vector<std::size_t> animatedTracks(KeyframeList& list, const std::vector<KeyTrack>& tracks) {
  std::set<int> groups;
  for (const KeyTrack& track : tracks)
    if (list.has(track.key)) groups.insert(track.group);
  groups.erase(0);
  std::vector<std::size_t> animated;
  for (std::size_t i = 0; i < tracks.size(); ++i)
    if (list.has(tracks[i].key) || groups.contains(tracks[i].group)) animated.push_back(i);
  return animated;
}

}  // namespace

KeyframeList::KeyframeList(TomlReader& object, double framesPerSecond)
    : object_(object), framesPerSecond_(framesPerSecond) {
  const std::vector<TomlValue>& values = object.list("keyframes");
  keyframes_.reserve(values.size());
  for (const TomlValue& value : values) {
    const std::string what = fmt::format("keyframes[{}] of {}", keyframes_.size(), object.what());
    Entry& entry = keyframes_.emplace_back(Entry{.table = TomlReader(value, what, object.file())});
    readTime(entry);
  }
  readInterpolation();
}

void KeyframeList::readTime(Entry& entry) {
  TomlReader& table = entry.table;
  const TomlValue* const value = table.findOneOf({"time", "frame"});
  if (!value) table.fail(fmt::format("{} needs 'time' or 'frame'", table.what()));
  const bool inSeconds = table.has("time");
  const char* const name = inSeconds ? "time" : "frame";
  entry.time = double{table.toNumber(*value, name)};
  if (!std::isfinite(static_cast<float>(inSeconds ? entry.time * framesPerSecond_ : entry.time / framesPerSecond_)))
    table.fail(*value, fmt::format("'{}' of {} is too large", name, table.what()));
  const std::size_t index = keyframes_.size() - 1;
  if (index == 0) inSeconds_ = inSeconds;
  if (inSeconds != inSeconds_)
    table.fail(*value, fmt::format("'time' and 'frame' in the keyframes of {} are mutually exclusive", object_.what()));
  if (index > 0 && !(entry.time > keyframes_[index - 1].time))
    table.fail(*value, fmt::format("'{}' of {} is {:g}, which is not after {:g}; {}s must ascend", name, table.what(),
                                   entry.time, keyframes_[index - 1].time, name));
  const auto addTangent = [&](const char* key, std::vector<TomlReader>& tangent) {
    if (const TomlValue* const found = table.find(key))
      tangent.emplace_back(*found, fmt::format("'{}' of {}", key, table.what()), table.file());
  };
  addTangent("in_tangent", entry.inTangent);
  addTangent("out_tangent", entry.outTangent);
}

void KeyframeList::readInterpolation() {
  const TomlValue* const value = object_.find("interpolation");
  if (!value) return;
  if (empty()) object_.fail(*value, fmt::format("'interpolation' of {} needs 'keyframes'", object_.what()));
  if (value->kind == TomlValue::Kind::table)
    interpolations_.emplace_back(*value, fmt::format("'interpolation' of {}", object_.what()), object_.file());
  else
    interpolation_ = scene::readInterpolation(object_, "interpolation", interpolation_);
}

float KeyframeList::frame(std::size_t i) const {
  return static_cast<float>(inSeconds_ ? keyframes_[i].time * framesPerSecond_ : keyframes_[i].time);
}

std::vector<float> KeyframeList::seconds() const {
  std::vector<float> seconds;
  for (const Entry& entry : keyframes_) {
    seconds.push_back(static_cast<float>(inSeconds_ ? entry.time : entry.time / framesPerSecond_));
    if (seconds.size() > 1 && !(seconds.back() > seconds[seconds.size() - 2]))
      entry.table.fail(fmt::format("{} is too close to the keyframe before", entry.table.what()));
  }
  return seconds;
}

bool KeyframeList::has(const std::string& key) {
  return std::ranges::any_of(keyframes_, [&](Entry& entry) { return entry.table.has(key); });
}

Interpolation KeyframeList::interpolationOf(const std::string& key) {
  return interpolations_.empty() ? interpolation_
                                 : scene::readInterpolation(interpolations_.front(), key, interpolation_);
}

const TomlValue* KeyframeList::tangent(std::size_t i, const std::string& key, bool outgoing) {
  std::vector<TomlReader>& tangent = outgoing ? keyframes_[i].outTangent : keyframes_[i].inTangent;
  return tangent.empty() ? nullptr : tangent.front().find(key);
}

void KeyframeList::rejectUnknownKeys() const {
  for (const Entry& entry : keyframes_) {
    entry.table.rejectUnknownKeys();
    for (const std::vector<TomlReader>* const tangent : {&entry.inTangent, &entry.outTangent})
      for (const TomlReader& reader : *tangent) reader.rejectUnknownKeys();
  }
  for (const TomlReader& reader : interpolations_) reader.rejectUnknownKeys();
}

void addSummary(SceneTomlContext& context, const TomlReader& object, KeyframeList& list,
                const std::vector<std::string>& keys) {
  if (list.empty()) return;
  const std::vector<float> seconds = list.seconds();
  KeyframeSummary summary;
  summary.object = object.what();
  for (const std::string& key : keys)
    if (list.has(key)) summary.keys.push_back({key, list.interpolationOf(key)});
  summary.count = seconds.size();
  summary.firstSeconds = double{seconds.front()};
  summary.lastSeconds = double{seconds.back()};
  context.scene.report.keyframes.push_back(std::move(summary));
}

std::vector<AnimatedValue> addTracks(SceneTomlContext& context, const TomlReader& object, KeyframeList& list,
                                     const std::vector<KeyTrack>& tracks) {
  std::vector<AnimatedValue> values;
  std::vector<std::string> keys;
  Animation& animation = context.animation.animation;
  for (const std::size_t i : animatedTracks(list, tracks)) {
    animation.samplers.push_back(samplerOf(list, tracks[i]));
    context.animation.values.push_back(animation.samplers.size() - 1);
    values.push_back({tracks[i].property.index, context.animation.values.size() - 1});
  }
  for (const KeyTrack& track : tracks) keys.push_back(track.key);
  list.rejectUnknownKeys();
  addSummary(context, object, list, keys);
  std::ranges::sort(values, {}, &AnimatedValue::property);
  return values;
}

}  // namespace quintet::scene

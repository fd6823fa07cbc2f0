// SPDX-License-Identifier: Apache-2.0
// The keys `keyframes` and `interpolation` of an object in a scene file (docs/scenes.md#keyframes).
#ifndef QUINTET_SCENE_TOML_KEYFRAMES_H
#define QUINTET_SCENE_TOML_KEYFRAMES_H

#include <string>
#include <vector>

#include "scene/animation/properties.h"
#include "scene/toml/context.h"

namespace quintet::scene {

// The tables of `keyframes`, with ascending times. Their other keys are those of the object, which reads them.
class KeyframeList {
 public:
  // Reads all times. Without the key `keyframes` the list is empty.
  KeyframeList(TomlReader& object, double framesPerSecond);

  bool empty() const { return keyframes_.empty(); }
  std::size_t size() const { return keyframes_.size(); }
  TomlReader& table(std::size_t i) { return keyframes_[i].table; }
  float frame(std::size_t i) const;
  std::vector<float> seconds() const;  // strictly ascending

  // True if a keyframe has the key.
  bool has(const std::string& key);
  Interpolation interpolationOf(const std::string& key);
  // The derivative of a key before or after keyframe i, in units of the file per second; null if it is not set.
  const TomlValue* tangent(std::size_t i, const std::string& key, bool outgoing);

  // Rejects keys of keyframes, tangents and `interpolation` that were never looked up.
  void rejectUnknownKeys() const;

 private:
  struct Entry {
    TomlReader table;
    double time = 0;                                // in the unit of the list
    std::vector<TomlReader> inTangent, outTangent;  // at most one
  };
  void readTime(Entry&);
  void readInterpolation();

  TomlReader& object_;
  double framesPerSecond_;
  bool inSeconds_ = true;  // the key of all times: `time` in seconds, or `frame`
  std::vector<Entry> keyframes_;
  Interpolation interpolation_ = Interpolation::linear;
  std::vector<TomlReader> interpolations_;  // at most one: of single keys
};

// Lists those of the keys that a keyframe has in the report; nothing if the list is empty.
void addSummary(SceneTomlContext&, const TomlReader& object, KeyframeList&, const std::vector<std::string>& keys);

// The values of one key of an object, one per keyframe.
struct KeyTrack {
  std::string key;
  PropertyInfo property;
  std::vector<vec4> values = {};  // in the unit of the file
  float unit = 1.0f;              // of the file, in that of the property
  int group = 0;                  // tracks of the same group other than 0 are animated together
};

// Adds samplers of the tracks with a key in a keyframe, and of their groups, and lists them in the report. Then rejects
// unknown keys of the list. Returns the values sorted by property; none if the list is empty.
std::vector<AnimatedValue> addTracks(SceneTomlContext&, const TomlReader& object, KeyframeList&,
                                     const std::vector<KeyTrack>&);

}  // namespace quintet::scene
#endif

// SPDX-License-Identifier: Apache-2.0
// Transforms of a scene file: the keys translate, rotate, scale and matrix, and the generators random and grid.
// docs/scenes.md specifies the generators exactly, so that other programs can reproduce them.
#ifndef QUINTET_SCENE_TOML_TRANSFORM_H
#define QUINTET_SCENE_TOML_TRANSFORM_H

#include "scene/toml/context.h"

namespace quintet::scene {

// rotate = [x, y, z] (degrees about x, then y, then z) | { axis = [...], degrees = a } | { quaternion = [x, y, z, w] }
quat readRotation(const TomlReader& reader, const TomlValue& value);

// Reads translate, rotate and scale. Absent keys have the value of `fallback`, as does the frame.
Keyframe readParts(TomlReader& reader, const Keyframe& fallback = {});

// Reads translate · rotate · scale, or matrix; the identity without these keys. The result has a finite inverse.
mat4 readTransform(TomlReader& reader);

// Reports a matrix that is not finite or has no inverse in single precision.
void checkInvertible(const TomlReader& reader, const TomlValue& at, const mat4& matrix);

// One element of random = {...} or grid = {...}.
struct Placement {
  vec3 center{0.0f};
  float size = 1.0f;
  quat rotation{1, 0, 0, 0};
  int material = kNone;
};

// translate(center) · rotation · scale(size).
mat4 matrixOf(const Placement&);

struct PlacementOptions {
  const char* sizeKey = "size";
  float size = 1.0f;      // if the key is absent
  bool turns = true;      // turn = true is allowed
  bool materials = true;  // materials = [...] is allowed
  std::uint32_t maxCount = 1u << 28;
  std::size_t bytesEach = 64;  // for the memory budget
};

// The elements of `random`, then those of `grid`; empty if `reader` has neither.
std::vector<Placement> readPlacements(SceneTomlContext&, TomlReader& reader, const PlacementOptions& options);

}  // namespace quintet::scene
#endif

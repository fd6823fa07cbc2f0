// random = {...} and grid = {...}: many of a thing by one line. docs/scenes.md states the generators exactly, so that
// a program or another tool can repeat them.
#ifndef QUINTET_SCENE_SCENE_TOML_PLACEMENT_H
#define QUINTET_SCENE_SCENE_TOML_PLACEMENT_H

#include <optional>

#include "scene/scene_toml_context.h"

namespace quintet::scene {

struct Placement {
  vec3 center{0.0f};
  float size = 1.0f;
  quat turn{1, 0, 0, 0};
  int material = kNone;
};

mat4 matrixOf(const Placement&);

struct PlacementOptions {
  const char* sizeKey = "size";
  float size = 1.0f;      // if the key is absent
  bool turns = true;      // turn = true is allowed
  bool materials = true;  // materials = [...] is allowed
  std::uint32_t maxCount = 1u << 28;
  std::size_t bytesEach = 64;  // for the memory budget
};

// Those of `random`, then those of `grid`; nothing if `reader` has neither.
std::vector<Placement> readPlacements(SceneTomlContext&, TomlReader& reader, const PlacementOptions& options);

}  // namespace quintet::scene
#endif

// SPDX-License-Identifier: Apache-2.0
// How a scene file is read.
#ifndef QUINTET_SCENE_LOAD_OPTIONS_H
#define QUINTET_SCENE_LOAD_OPTIONS_H

#include <cstddef>
#include <optional>
#include <string>

#include "scene/model/animation.h"

namespace quintet::scene {

enum class MissingTextures {
  error,  // a texture whose image is missing or invalid is an error
  warn,   // the factors of the material are used without it; the report lists it as ignored
};

struct LoadOptions {
  // Index or name of a scene of a glTF file; empty means its default scene, else its first scene, else all root nodes.
  std::string scene;
  std::string variant;  // name of a material variant of a glTF file; empty means the materials of the primitives
  // Name or index of the animation of a glTF file that plays; empty means the first, if the file has one. Unset means
  // the rest pose. The scene is that at 0 seconds.
  std::optional<std::string> animation = {};
  double framesPerSecond = kDefaultFramesPerSecond;  // > 0, of a glTF animation
  bool strict = false;  // anything that is ignored or repaired is an error that lists it all (requireExact)
  MissingTextures missingTextures = MissingTextures::error;
  // Bytes of host memory that the file can request; 0 means 80 % of the machine's memory.
  std::size_t maxMemory = 0;
  // Whether a glTF file can name buffers and images outside of its folder and its subfolders. Symbolic links are followed.
  bool allowExternal = false;
  bool operator==(const LoadOptions&) const = default;
};

}  // namespace quintet::scene
#endif

// SPDX-License-Identifier: Apache-2.0
// Scene files (*.scene.toml), with image.png and part.gltf beside them.
#include "scene/toml/scene_toml.h"
#include "scene_target.h"

namespace quintet::fuzz {

void readInput(Input input) {
  static const InputFile kFile("input.scene.toml");
  acceptErrors([&] {
    scene::LoadOptions options = loadOptions();
    options.animation.reset();
    checkScene(scene::parseSceneToml(textOf(input), kFile.path(), options));
  });
}

}  // namespace quintet::fuzz

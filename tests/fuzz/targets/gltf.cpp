// SPDX-License-Identifier: Apache-2.0
// glTF as JSON, with buffers and images in data URIs or neighbors.
#include "scene/gltf/gltf.h"

#include "scene_target.h"

namespace quintet::fuzz {

void readInput(Input input) {
  static const InputFile kFile("scene.gltf");
  kFile.write(input);
  acceptErrors([] { checkScene(scene::loadGltf(kFile.path(), loadOptions())); });
}

}  // namespace quintet::fuzz

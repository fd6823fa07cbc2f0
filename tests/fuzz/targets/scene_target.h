// SPDX-License-Identifier: Apache-2.0
// What the targets that read scene files share.
#ifndef QUINTET_TESTS_FUZZ_SCENE_TARGET_H
#define QUINTET_TESTS_FUZZ_SCENE_TARGET_H

#include <filesystem>
#include <string>

#include "scene/load_options.h"
#include "scene/model/scene.h"
#include "target.h"

namespace quintet::fuzz {

// A file in a temporary folder of the process, which is removed when the process exits. Inputs can refer to its
// neighbors: image.png, data.bin (256 bytes) and part.gltf.
class InputFile {
 public:
  // `name`: "scene.gltf".
  explicit InputFile(const std::string& name);
  const std::filesystem::path& path() const { return path_; }
  // Replaces the content.
  void write(Input input) const;

 private:
  std::filesystem::path path_;
};

// Plays the first animation and accepts missing textures, so that reading goes as far as possible.
scene::LoadOptions loadOptions();

// Reports a scene that was read without an error, but is not valid, at rest or within its animation.
void checkScene(scene::Scene scene);

}  // namespace quintet::fuzz
#endif

// SPDX-License-Identifier: Apache-2.0
// A scene in the process of loading. Image data is the last part to be decoded; everything else is available before, so
// that a caller can compile shaders for the scene while the images are decoded:
//
//   PendingScene pending = beginLoading(file);
//   if (pending.described()) startCompiling(sceneFeatures(pending.scene()));
//   Scene scene = std::move(pending).finish();
#ifndef QUINTET_SCENE_PENDING_SCENE_H
#define QUINTET_SCENE_PENDING_SCENE_H

#include <functional>
#include <utility>

#include "scene/model/scene.h"

namespace quintet::scene {

class PendingScene {
 public:
  // A complete scene.
  explicit PendingScene(Scene scene) : scene_(std::move(scene)) {}
  // A scene whose images `decode` fills. `described`: the sizes, channels and types of the images are set.
  PendingScene(Scene scene, bool described, std::function<void(Scene&)> decode)
      : scene_(std::move(scene)), described_(described), decode_(std::move(decode)) {}

  // The scene so far. Images can be without data; if described() is false, also without size, channels and type.
  const Scene& scene() const { return scene_; }
  // Whether scene() has the size, channels and type of every image.
  bool described() const { return described_; }

  // Decodes the images and returns the complete scene. Releases the memory of the file. Throws FileError, MemoryError.
  Scene finish() &&;

 private:
  Scene scene_;
  bool described_ = true;
  std::function<void(Scene&)> decode_;  // owns the file's data; empty if the scene is complete
};

}  // namespace quintet::scene
#endif

// SPDX-License-Identifier: Apache-2.0
#include "scene/pending_scene.h"

namespace quintet::scene {

Scene PendingScene::finish() && {
  if (const auto decode = std::exchange(decode_, nullptr)) decode(scene_);
  return std::move(scene_);
}

}  // namespace quintet::scene

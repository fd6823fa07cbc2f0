// SPDX-License-Identifier: Apache-2.0
// Renders several scenes, one after the other, with the devices, the compiled shaders and the pipelines of one engine.
#ifndef QUINTET_JOB_SCENE_BATCH_H
#define QUINTET_JOB_SCENE_BATCH_H

#include <cstddef>
#include <exception>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "job/engine.h"

namespace quintet::job {

enum class SceneEnd { rendered, targetMissed, failed, interrupted };

struct SceneBatch {
  std::size_t count = 0;
  std::size_t first = 0;                                           // earlier ones are not rendered
  std::function<SceneEnd(std::size_t scene)> render;               // throws if the scene cannot be rendered
  std::function<void(std::size_t, const std::exception&)> failed;  // reports what render() threw
};

struct SceneBatchResult {
  std::vector<std::size_t> failed;  // scenes
  bool targetMissed = false;        // of one or more of the others
  bool interrupted = false;         // the last scene that was started; those after it were not rendered
};

// A scene that fails does not stop the others. If it has lost the device, the next scene opens the device again. Throws
// gpu::NoDeviceError, and TimeoutError, after which the device can stay in use forever.
SceneBatchResult renderScenes(Engine& engine, const SceneBatch& batch);

// "2 of 20 scenes failed: a.glb, b.glb"
std::string failedScenesText(std::span<const std::filesystem::path> scenes, std::span<const std::size_t> failed);

}  // namespace quintet::job
#endif

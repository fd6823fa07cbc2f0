// SPDX-License-Identifier: Apache-2.0
#include "job/scene_batch.h"

#include <quintet/device.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/plural.h"
#include "gpu/error.h"

namespace quintet::job {

SceneBatchResult renderScenes(Engine& engine, const SceneBatch& batch) {
  SceneBatchResult result;
  for (std::size_t scene = batch.first; scene < batch.count && !result.interrupted; ++scene) {
    SceneEnd end = SceneEnd::failed;
    try {
      end = batch.render(scene);
    } catch (const gpu::NoDeviceError&) {
      throw;
    } catch (const TimeoutError&) {
      throw;
    } catch (const DeviceLostError& error) {
      batch.failed(scene, error);
      engine.close();
    } catch (const std::exception& error) {
      batch.failed(scene, error);
    }
    if (end == SceneEnd::failed) result.failed.push_back(scene);
    result.targetMissed = result.targetMissed || end == SceneEnd::targetMissed;
    result.interrupted = end == SceneEnd::interrupted;
  }
  return result;
}

std::string failedScenesText(std::span<const std::filesystem::path> scenes, std::span<const std::size_t> failed) {
  std::vector<std::string> names;
  for (const std::size_t scene : failed) names.push_back(scenes[scene].string());
  return fmt::format("{} of {} failed: {}", failed.size(), counted(scenes.size(), "scene"), fmt::join(names, ", "));
}

}  // namespace quintet::job

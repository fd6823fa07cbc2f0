// SPDX-License-Identifier: Apache-2.0
// Reads a scene and decides how it is seen, in the background, while the device opens and shaders compile.
#ifndef QUINTET_JOB_SCENE_LOADING_H
#define QUINTET_JOB_SCENE_LOADING_H

#include <future>
#include <string>

#include "base/cancellation.h"
#include "job/resolve.h"
#include "job/view.h"
#include "render/scene/scene_features.h"

namespace quintet::job {

// A scene in host memory with the decisions that depend on it.
struct LoadedScene {
  scene::Scene scene;
  CameraChoice camera;
  EnvironmentChoice environment;
  uvec2 size{0};                      // of the image, pixels
  std::string hash, environmentHash;  // scene::contentHash
  double seconds = 0;                 // wall clock of everything below
  double hashSeconds = 0;
  double viewSeconds = 0;  // for camera, size and environment
};

class SceneLoading {
 public:
  // Starts two threads: the scene, which has the cancellation of this thread, and tables that do not depend on any scene.
  SceneLoading(const SceneSource& source, const RenderRequest& request);

  // What shaders must know of the scene, available before its images are decoded. Throws if loading failed.
  std::shared_future<render::SceneFeatures> features() const { return features_; }
  // Waits for the scene; call it once. Throws FileError, UsageError, MemoryError, CanceledError.
  LoadedScene finish() { return getUnlessCanceled(scene_); }

 private:
  std::shared_future<render::SceneFeatures> features_;
  std::future<LoadedScene> scene_;
  std::future<void> tables_;
};

}  // namespace quintet::job
#endif

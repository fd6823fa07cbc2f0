// What a rendering needs to know of a scene before the device gets it: read and decided without a device, so that it
// can go on while the driver starts.
#ifndef QUINTET_APP_SCENE_LOADING_H
#define QUINTET_APP_SCENE_LOADING_H

#include <future>
#include <string>

#include "render/scene_features.h"
#include "render_options.h"
#include "scene/scene.h"
#include "scene_setup.h"
#include "scene_source.h"

namespace quintet::app {

struct LoadedScene {
  scene::Scene scene;
  ChosenCamera camera;
  ChosenEnvironment environment;
  uvec2 size{0};
  std::string hash, environmentHash;
  double hashSeconds = 0;
  double viewSeconds = 0;  // camera, size and light decided
  double seconds = 0;      // all together
};

// The same in a thread of its own, together with tables that no scene is in. One at a time.
class SceneLoading {
 public:
  // `options` must outlive the loading. Reads the scene and chooses camera, light and size.
  void start(const SceneSource& source, const RenderOptions& options);
  // What shaders must know of the scene that start() reads, before all of it is read. Has an exception if reading fails: not
  // the one that finish() throws.
  std::shared_future<render::SceneFeatures> features() const { return features_; }
  // Waits for what was started with this source; starts it if nothing was. Throws what reading and choosing throw.
  LoadedScene finish(const SceneSource& source, const RenderOptions& options);

 private:
  SceneSource source_;
  std::shared_future<render::SceneFeatures> features_;
  std::future<LoadedScene> scene_;
  std::future<void> tables_;
};

}  // namespace quintet::app
#endif

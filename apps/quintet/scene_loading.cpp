#include "scene_loading.h"

#include "base/stopwatch.h"
#include "render/albedo_tables.h"
#include "scene/content_hash.h"

namespace quintet::app {

LoadedScene loadForRendering(const SceneSource& source, const RenderOptions& options) {
  const Stopwatch all;
  LoadedScene loaded;
  loaded.scene = loadScene(source);
  Stopwatch watch;
  loaded.hash = scene::contentHash(loaded.scene).hex();
  loaded.hashSeconds = watch.lap();
  const uvec2 asked = options.size;
  const float aspect = asked.y > 0 ? static_cast<float>(asked.x) / static_cast<float>(asked.y) : 0.0f;
  loaded.camera = chooseCamera(loaded.scene, options.camera, aspect);
  loaded.environment = chooseEnvironment(loaded.scene, options.environment);
  loaded.environmentHash = scene::contentHash(loaded.environment.environment).hex();
  loaded.size = chooseSize(asked, loaded.camera.camera);
  loaded.viewSeconds = watch.lap();
  loaded.seconds = all.seconds();
  return loaded;
}

void SceneLoading::start(const SceneSource& source, const RenderOptions& options) {
  source_ = source;
  // The default policy: where no thread can be had, the work is done when it is asked for.
  scene_ = std::async([source, &options] { return loadForRendering(source, options); });
  tables_ = std::async([] { static_cast<void>(render::albedoTables()); });
}

LoadedScene SceneLoading::finish(const SceneSource& source, const RenderOptions& options) {
  if (!scene_.valid() || source != source_) start(source, options);
  return scene_.get();
}

}  // namespace quintet::app

#include "scene_loading.h"

#include "base/stopwatch.h"
#include "render/albedo_tables.h"
#include "scene/content_hash.h"

namespace quintet::app {

namespace {

LoadedScene load(const SceneSource& source, const RenderOptions& options,
                 std::promise<render::SceneFeatures>& features) {
  const Stopwatch all;
  LoadedScene loaded;
  loaded.scene = loadScene(source, [&](const scene::Scene& scene) {
    const Stopwatch choosing;
    loaded.environment = chooseEnvironment(scene, options.environment);
    features.set_value(render::sceneFeatures(scene, loaded.environment.environment));
    loaded.viewSeconds = choosing.seconds();
  });
  Stopwatch watch;
  loaded.hash = scene::contentHash(loaded.scene).hex();
  loaded.hashSeconds = watch.lap();
  const uvec2 asked = options.size;
  const float aspect = asked.y > 0 ? static_cast<float>(asked.x) / static_cast<float>(asked.y) : 0.0f;
  loaded.camera = chooseCamera(loaded.scene, options.camera, aspect);
  loaded.environmentHash = scene::contentHash(loaded.environment.environment).hex();
  loaded.size = chooseSize(asked, loaded.camera.camera);
  loaded.viewSeconds += watch.lap();
  loaded.seconds = all.seconds();
  return loaded;
}

}  // namespace

void SceneLoading::start(const SceneSource& source, const RenderOptions& options) {
  source_ = source;
  // The default policy: where no thread can be had, the work is done when it is asked for.
  std::promise<render::SceneFeatures> features;
  features_ = features.get_future().share();
  scene_ = std::async(
      [source, &options, features = std::move(features)]() mutable { return load(source, options, features); });
  tables_ = std::async([] { static_cast<void>(render::albedoTables()); });
}

LoadedScene SceneLoading::finish(const SceneSource& source, const RenderOptions& options) {
  if (!scene_.valid() || source != source_) start(source, options);
  return scene_.get();
}

}  // namespace quintet::app

// SPDX-License-Identifier: Apache-2.0
#include "job/scene_loading.h"

#include <optional>
#include <utility>

#include "base/cancellation.h"
#include "base/stopwatch.h"
#include "render/scene/albedo_tables.h"
#include "scene/animation/animated_bounds.h"
#include "scene/model/content_hash.h"

namespace quintet::job {
namespace {

LoadedScene load(const SceneSource& source, const RenderRequest& request,
                 std::promise<render::SceneFeatures>& features) {
  const Stopwatch total;
  LoadedScene loaded;
  throwIfCanceled();
  scene::PendingScene pending = beginLoading(source);
  const auto chooseLight = [&](const scene::Scene& scene) {
    const Stopwatch watch;
    loaded.environment = chooseEnvironment(scene, request.environment, request.load.maxMemory);
    features.set_value(render::sceneFeatures(scene, loaded.environment.environment));
    loaded.viewSeconds = watch.seconds();
  };
  // Compiling starts with the features, so they are needed before the images are decoded if possible.
  const bool described = pending.described();
  if (described) chooseLight(pending.scene());
  loaded.scene = std::move(pending).finish();
  if (!described) chooseLight(loaded.scene);
  throwIfCanceled();

  Stopwatch watch;
  loaded.hash = scene::contentHash(loaded.scene).hex();
  loaded.hashSeconds = watch.lap();

  const uvec2 requested = request.size;
  const float aspect = requested.y > 0 ? static_cast<float>(requested.x) / static_cast<float>(requested.y) : 0.0f;
  std::optional<Bounds3> bounds = request.bounds;
  if (!bounds && loaded.scene.nodeAnimation) bounds = scene::animatedBounds(loaded.scene);
  loaded.camera = chooseCamera(loaded.scene, request.camera, aspect, bounds);
  loaded.environmentHash = scene::contentHash(loaded.environment.environment).hex();
  loaded.size = chooseImageSize(requested, loaded.camera.camera);
  loaded.viewSeconds += watch.lap();
  loaded.seconds = total.seconds();
  return loaded;
}

}  // namespace

SceneLoading::SceneLoading(const SceneSource& source, const RenderRequest& request) {
  // The default launch policy: if no thread can be started, the work is done when its result is requested.
  std::promise<render::SceneFeatures> features;
  features_ = features.get_future().share();
  scene_ = std::async([source, request, features = std::move(features), canceled = Cancellation::current()]() mutable {
    const Cancellation::Scope scope(canceled);
    return load(source, request, features);
  });
  tables_ = std::async([] { static_cast<void>(render::albedoTables()); });
}

}  // namespace quintet::job

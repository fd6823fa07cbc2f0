#include "api/impl.h"
#include "render/program_scene.h"
#include "scene/load.h"

namespace quintet {

Scene Scene::load(const std::filesystem::path& file) {
  Scene result;
  result.impl_ = std::make_shared<const Impl>(Impl{scene::loadScene(file)});
  return result;
}

Scene Scene::of(const Program& program) {
  Scene result;
  result.impl_ = std::make_shared<const Impl>(Impl{render::programScene(program.impl_->program)});
  return result;
}

std::string Scene::name() const { return impl_->scene.name; }
std::size_t Scene::instanceCount() const { return impl_->scene.instances.size(); }
std::size_t Scene::cameraCount() const { return impl_->scene.cameras.size(); }

std::array<std::array<float, 3>, 2> Scene::bounds() const {
  const Bounds3 b = scene::worldBounds(impl_->scene);
  return {{{b.min.x, b.min.y, b.min.z}, {b.max.x, b.max.y, b.max.z}}};
}

}  // namespace quintet

// SPDX-License-Identifier: Apache-2.0
#include "scene.h"

#include <algorithm>

#include "harness.h"
#include "rt/acceleration_structure.h"

namespace quintet::oracle {

Triangles triangleAt(float x, float y, float z, float size, bool opaque) {
  return {{{x - size, y - size, z}, {x + size, y - size, z}, {x, y + size, z}}, {{0, 1, 2}}, opaque, false};
}

Bounds3 boxAt(const vec3& center, float halfSize) { return {center - halfSize, center + halfSize}; }

std::size_t Scene::build(const rt::BlasInput& input) {
  rt::BlasBuilder builder(test::testContext());
  blas_.push_back(std::move(builder.build({&input, 1})[0]));
  return blas_.size() - 1;
}

std::size_t Scene::addBlas(const std::vector<Triangles>& geometries) {
  rt::BlasInput input{.geometries = {}, .options = {.keepInputOrder = true, .name = "oracle triangles"}};
  for (const Triangles& g : geometries)
    input.geometries.push_back({.kind = rt::GeometryKind::triangles,
                                .positions = g.positions,
                                .triangles = g.indices,
                                .boxes = {},
                                .opaque = g.opaque,
                                .singleAnyHit = g.singleAnyHit});
  return build(input);
}

std::size_t Scene::addBlas(const std::vector<Boxes>& geometries) {
  rt::BlasInput input{.geometries = {}, .options = {.keepInputOrder = true, .name = "oracle boxes"}};
  for (const Boxes& g : geometries)
    input.geometries.push_back({.kind = rt::GeometryKind::boxes,
                                .positions = {},
                                .triangles = {},
                                .boxes = g.boxes,
                                .opaque = g.opaque,
                                .singleAnyHit = g.singleAnyHit});
  return build(input);
}

void Scene::add(std::size_t blas, rt::InstanceInput instance) {
  instance.blas = &blas_.at(blas);
  instances_.push_back(instance);
}

VkAccelerationStructureKHR Scene::handle() const {
  if (!tlas_) {
    tlas_ =
        std::make_unique<rt::Tlas>(test::testContext(), static_cast<std::uint32_t>(instances_.size()), "oracle tlas");
    tlas_->keepInputOrder(true);
    tlas_->buildAndWait(instances_);
  }
  return tlas_->handle();
}

VkDeviceAddress Scene::address() const { return rt::structureAddress(test::testContext(), handle()); }

}  // namespace quintet::oracle

// SPDX-License-Identifier: Apache-2.0
// Emissive solids whose far side is visible through the near side: light samples and BSDF samples must be weighted
// consistently.
#include <gtest/gtest.h>

#include "probe.h"
#include "render/rendered_image.h"

namespace quintet::test {
namespace {

using scene::PrimitiveType;

const vec3 kFarSideAlbedo(0.8f, 0.5f, 0.2f);

scene::Primitive lampOf(PrimitiveType type, const mat4& place) {
  scene::Primitive lamp;
  lamp.type = type;
  lamp.objectFromPrimitive = place;
  lamp.material = 1;
  return lamp;
}

// Lamps above a floor; the camera sees a small part of the floor. Both materials use the same shaders.
SceneBuilder above(const std::vector<scene::Primitive>& lamps, const scene::Material& material,
                   const scene::Material& other) {
  SceneBuilder scene;
  scene.scene.materials = {lambert(kFarSideAlbedo), material, other};
  scene::Primitive floor = lampOf(PrimitiveType::box, moved(0, -1, 0));
  floor.material = 0;
  for (const auto& solids : {std::vector{floor}, lamps}) {
    scene.scene.instances.emplace_back().mesh = static_cast<int>(scene.scene.meshes.size());
    scene.scene.meshes.emplace_back().primitiveSets.push_back(solidsOf(solids));
  }
  scene.camera(orthographic({0, 0.3f, 0}, vec3(0.0f), 1e-3f));
  return scene;
}

scene::Material veiled(const vec3& radiance) {
  scene::Material m = emitter(radiance);
  m.alphaMode = scene::AlphaMode::blend;
  m.baseColor.a = 0.5f;
  return m;
}

ImageOptions oneBounce(std::uint32_t batches) {
  ImageOptions options;
  options.set = {"bounces=1"};
  options.batches = batches;
  return options;
}

// A large sphere that is half transparent, by alpha or as a pane. Light samples do not sample its far side, but the
// camera sees the part of it that the near side transmits. Relative to an opaque sphere, the light is 1 - (1 - a)² for
// alpha, and 1 + tint for a pane.
TEST(SolidFarSide, ShowsThroughBalls) {
  const float radius = 1.5f;
  const vec3 center(0.6f, 2.0f, -0.3f), radiance(4.0f, 2.0f, 1.0f);
  const float squared = glm::dot(center, center);
  const float irradiance = kPi * radius * radius / squared * center.y / std::sqrt(squared);
  scene::Material pane = clearGlass(1.5f, 0.0f);
  pane.specular = 0.0f;
  pane.baseColor = vec4(vec3(0.5f), 1.0f);
  pane.emissive = radiance;
  const mat4 place = glm::translate(mat4(1.0f), center) * scaled(radius, radius, radius);
  for (const auto& [ball, part] : {std::pair{veiled(radiance), 0.75f}, {pane, 1.5f}}) {
    const SceneBuilder scene =
        above({lampOf(PrimitiveType::sphere, place)}, ball, part < 1.0f ? pane : veiled(radiance));
    expectUniform(renderImage(scene, oneBounce(64)), vec4(part * irradiance / kPi * kFarSideAlbedo * radiance, 1.0f),
                  {.error = 0.015});
  }
}

// For all other solids, light samples also sample the far side, and the near side attenuates it: convex solids of alpha
// a give 1 - (1 - a)² of their light.
TEST(SolidFarSide, ShowsThroughOtherSolids) {
  const mat4 size = glm::rotate(mat4(1.0f), 0.8f, glm::normalize(vec3(1, 2, 0.5f))) * scaled(0.7f, 0.4f, -0.5f);
  const std::vector<scene::Primitive> lamps{lampOf(PrimitiveType::sphere, moved(1, 1.2f, 1) * size),
                                            lampOf(PrimitiveType::box, moved(-1, 1.2f, 1) * size),
                                            lampOf(PrimitiveType::cylinder, moved(1, 1.2f, -1) * size),
                                            lampOf(PrimitiveType::cone, moved(-1, 1.2f, -1) * size)};
  const scene::Material whole = emitter(vec3(3.0f)), half = veiled(vec3(4.0f));
  const RenderedImage a = renderImage(above(lamps, whole, half), oneBounce(96)),
                      b = renderImage(above(lamps, half, whole), oneBounce(96));
  Moments wholeLight, halfLight;
  for (std::uint32_t y = 0; y < a.height(); ++y)
    for (std::uint32_t x = 0; x < a.width(); ++x)
      wholeLight.add(a.at(x, y, 0).mean()), halfLight.add(b.at(x, y, 0).mean());
  EXPECT_GE(pValue(wholeLight, halfLight), 0.01) << wholeLight.mean() << " against " << halfLight.mean();
  EXPECT_LT(halfLight.standardError(), 0.015 * halfLight.mean()) << "too noisy for this test";
}

}  // namespace
}  // namespace quintet::test

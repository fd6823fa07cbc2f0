// A scene on the device: attributes, textures, materials, lights and acceleration structures, uploaded
// once and used by any number of renderers (programs, sizes, cameras).
#ifndef QUINTET_RENDER_DEVICE_SCENE_H
#define QUINTET_RENDER_DEVICE_SCENE_H

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gpu/descriptors.h"
#include "program/link.h"
#include "quintet/shared/frame.h"
#include "rt/acceleration_structure.h"
#include "scene/scene.h"

namespace quintet::render {

struct DeviceSceneOptions {
  bool keepInputOrder = false;  // for benchmarks: no spatial order of primitives and instances
};

struct DeviceSceneStatistics {
  double uploadSeconds = 0;   // attributes, textures, light tables
  rt::BuildStatistics build;  // bottom level
  double topLevelSeconds = 0;
  double lightSeconds = 0;  // of uploadSeconds: light, environment and albedo tables
  std::uint64_t geometryBytes = 0;
  std::uint64_t textureBytes = 0;
  std::uint64_t accelerationBytes = 0;  // bottom and top level
  std::uint64_t primitiveMapBytes = 0;  // where the driver keeps the input order (quirks.md)
  std::uint32_t lightCount = 0;
};

class TextureSlots;

class DeviceScene {
 public:
  // `environment` is the one in use (the scene's own, the user's, or the default). `scene` is needed during
  // construction only.
  DeviceScene(gpu::Context& context, const scene::Scene& scene, const scene::Environment& environment,
              const DeviceSceneOptions& options = {});
  // The same, and frees the scene's attributes and pictures as soon as the device has them: a large scene is in
  // memory once. What is left of `scene` is of no use.
  DeviceScene(gpu::Context& context, scene::Scene&& scene, const scene::Environment& environment,
              const DeviceSceneOptions& options = {});
  ~DeviceScene();
  DeviceScene(const DeviceScene&) = delete;
  DeviceScene& operator=(const DeviceScene&) = delete;

  gpu::Context& context() const;
  const gpu::BindlessSet& set() const;
  TextureSlots& parameterSlots();  // for the images of programs' parameters
  // What the link needs to know; geometries in the order of hit records.
  const program::SceneFacts& facts() const;
  bool hasAlpha() const;  // any geometry whose material needs an alpha test
  // Preprocessor definitions for shaders: QUINTET_NO_… (quintet/features.glsl) and driver workarounds.
  const std::vector<std::pair<std::string, std::string>>& defines() const;
  // The frame's addresses and environment; camera, film and outputs are left for the renderer.
  const shared::Frame& frameTemplate() const;
  const DeviceSceneStatistics& statistics() const;
  const Bounds3& bounds() const;

  // Makes the TLAS fit programs with this many ray types (hit record offsets depend on it). keepInstanceOrder:
  // gl_InstanceID is the instance's index in the scene, at some cost in speed (docs/design/quirks.md).
  void prepareFor(std::uint32_t rayTypeCount, bool keepInstanceOrder = false, bool anyHitForAll = false);

  // Moves the instances that have keyframes (scene.h) to where they are at `frame`: instance table, TLAS, and the
  // tables of lights if any of them emits. Addresses stay: frameTemplate() does not change. Blocks; no launch may be
  // under way. At first it is frame 0.
  void setFrame(float frame);
  bool animated() const;  // any instance has keyframes

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace quintet::render
#endif

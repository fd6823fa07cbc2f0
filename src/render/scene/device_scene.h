// SPDX-License-Identifier: Apache-2.0
// A scene on the device: attributes, textures, materials, lights and acceleration structures. It is uploaded once and
// used by any number of renderers (programs, sizes, cameras).
#ifndef QUINTET_RENDER_SCENE_DEVICE_SCENE_H
#define QUINTET_RENDER_SCENE_DEVICE_SCENE_H

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gpu/descriptors.h"
#include "gpu/uploader.h"
#include "program/hit_group_binding.h"
#include "program/scene_facts.h"
#include "quintet/shared/frame.h"
#include "render/lights/light_table.h"
#include "render/scene/camera_media.h"
#include "render/scene/deformed_meshes.h"
#include "render/scene/geometry_upload.h"
#include "render/scene/merged_instances.h"
#include "render/scene/previous_positions.h"
#include "render/scene/scene_features.h"
#include "render/scene/texture_upload.h"
#include "render/scene/top_level.h"
#include "rt/blas_builder.h"
#include "scene/model/scene.h"

namespace quintet::render {

struct DeviceSceneOptions {
  bool keepInputOrder = false;  // for benchmarks: do not sort primitives and instances spatially
  // Geometry that is built with NO_DUPLICATE_ANY_HIT_INVOCATION.
  program::SingleAnyHit singleAnyHit = program::SingleAnyHit::tinting;
  bool editable = false;  // keep what DeviceScene::setTransforms requires: the emissive geometry in host memory
  // Compiles the passes that deform meshes; used by the constructor only. Null means one without a cache on disk.
  const shader::Compiler* compiler = nullptr;
};

struct InstanceTransform {
  std::size_t instance = 0;    // index in scene.instances
  mat4 worldFromObject{1.0f};  // affine, invertible
};

struct DeviceSceneStatistics {
  double uploadSeconds = 0;   // attributes, textures and light tables
  rt::BuildStatistics build;  // bottom level
  double topLevelSeconds = 0;
  double lightSeconds = 0;  // part of uploadSeconds: light, environment and albedo tables
  std::uint64_t geometryBytes = 0;
  std::uint64_t textureBytes = 0;
  std::uint64_t accelerationBytes = 0;  // bottom and top level
  std::uint64_t primitiveMapBytes = 0;  // only if the driver keeps the input order (quirks.md)
  std::uint32_t lightCount = 0;
  std::uint32_t mergedInstances = 0;  // that share acceleration structures; after prepareFor()
};

// Sums over all frames after the first one. Wall-clock time on the host, with the waits for the device.
struct FrameStatistics {
  double poseSeconds = 0;      // transforms of the nodes
  double topLevelSeconds = 0;  // instances and the TLAS
  double lightSeconds = 0;     // tables of moving lights
};

// Whether DeviceScene::setFrame also updates the previous positions of vertices, if they are kept.
enum class Previous { update, skip };

class DeviceScene {
 public:
  // Consumes `scene`: frees its attributes and images as soon as they are on the device, so that a large scene is in
  // memory once. `environment` is the one in use: the scene's, the user's, or the default.
  DeviceScene(gpu::Context& context, scene::Scene&& scene, const scene::Environment& environment,
              const DeviceSceneOptions& options = {});
  // The same without changing `scene`, which several devices can read at the same time.
  DeviceScene(gpu::Context& context, const scene::Scene& scene, const scene::Environment& environment,
              const DeviceSceneOptions& options = {});
  DeviceScene(const DeviceScene&) = delete;
  DeviceScene& operator=(const DeviceScene&) = delete;

  gpu::Context& context() const { return context_; }
  const gpu::BindlessSet& set() const { return *set_; }
  // Slots for the images of program parameters.
  TextureSlots& parameterSlots() { return *parameterSlots_; }
  // Facts for linking and checking a program; geometries are in the order of hit records.
  const program::SceneFacts& facts() const { return facts_; }
  // Preprocessor definitions for shaders: QUINTET_NO_… (quintet/features.glsl) and driver workarounds.
  const Defines& defines() const { return defines_; }
  // Frame with the scene's addresses and environment. The renderer adds camera, film and outputs.
  const shared::Frame& frameTemplate() const { return frame_; }
  // Changes whenever frameTemplate() or mediaAt() can give other results than before.
  std::uint64_t revision() const { return revision_; }
  const DeviceSceneStatistics& statistics() const { return statistics_; }

  // Builds the TLAS for programs with this number of ray types, which the hit record offsets depend on.
  // keepInstanceOrder makes gl_InstanceID the instance's index in the scene, at some cost in speed
  // (docs/design/quirks.md). mergeInstances permits several instances in one acceleration structure, if the driver gains
  // from it and the other two are false (render/scene/merged_instances.h). Renderers call this when they are made, and it holds until
  // the next call: those of programs that differ in these values cannot take turns with one scene.
  void prepareFor(std::uint32_t rayTypeCount, bool keepInstanceOrder = false, bool anyHitForAll = false,
                  bool mergeInstances = false);

  // Moves the animated instances and lights to `frame`, and deforms meshes: updates vertices, BLASes, the instance
  // table, the TLAS, and the light tables if something that moves emits or an edit changed them. The addresses of moving
  // lights do not change. Blocks; no launch can be under way. The scene starts at frame 0.
  void setFrame(double frame, Previous previous = Previous::update);
  double frame() const { return shownFrame_; }
  // The frame of the previous instances and vertices: one before frame(), but a scene does not move before frame 0.
  double previousFrame() const;
  // From now on, setFrame() also deforms meshes at previousFrame(), and keeps the positions of their vertices on the device
  // (Frame::previousPositions). It then takes about twice the time for deformed meshes. Blocks; no launch can be under way.
  void keepPreviousPositions();

  // Edits. Those of lights take effect in updateLights(), so that several edits build the light tables once. They require
  // DeviceSceneOptions::editable and block; no launch can be under way.
  // Moves instances that are not animated: updates the instance table and the TLAS, and edits the lights that move.
  void setTransforms(std::span<const InstanceTransform> transforms);
  // Replaces a row of the material table. Returns false, and changes nothing, if the material uses a texture that is
  // not on the device. The caller makes sure that everything else that depends on materials stays the same: features,
  // facts and lights.
  bool setMaterial(std::size_t index, const scene::Material& material);
  // Edits of lights. `scene`: with the meshes and instances of the constructor's.
  void setLights(const std::vector<scene::Light>& lights);  // all punctual lights
  void setEmission(const scene::Scene& scene);              // of the materials
  // If `environment` has an image, it must be the one of the constructor's environment. Returns false, and changes
  // nothing, if that image is not on the device, because its intensity was 0.
  bool setEnvironment(const scene::Environment& environment);
  // Builds the light tables if an edit since the last call changes them; frameTemplate() can then change.
  void updateLights();
  // What defines() is made of, after edits.
  void setFeatures(const SceneFeatures& features) { defines_ = shaderDefines(features, context_.info().quirks); }
  // Returns the solids around a point in world space at the current frame, with the current materials.
  Media mediaAt(const vec3& point);
  bool animated() const { return animated_; }  // keyframes, or a glTF animation (scene::isAnimated)
  const FrameStatistics& frameStatistics() const { return frameStatistics_; }
  DeformationStatistics deformationStatistics() const {
    return deformed_ ? deformed_->statistics() : DeformationStatistics{};
  }

 private:
  struct EnvironmentImage {
    std::uint32_t texture = shared::kNoTexture;
    EnvironmentTable table;  // without entries
    gpu::Buffer entries;
    gpu::Buffer balanced;  // none if the table has no balanced entries
  };

  // `consumed`: null, or the scene itself, to be freed.
  DeviceScene(gpu::Context& context, const scene::Scene& scene, scene::Scene* consumed,
              const scene::Environment& environment, const DeviceSceneOptions& options);

  void uploadLights(const scene::Scene& scene, const scene::Environment& environment);
  void showEnvironment(const scene::Environment& environment, const EnvironmentTable& table);
  void moveEnvironment(const scene::Pose& pose);
  void setEnvironmentPower(double integral);  // in the builder
  void showFrame(double frame, bool withPrevious);
  void showDeformation(const scene::Pose& pose);
  void movePunctualLights(const scene::Pose& pose);  // in the builder
  void keepAnimatedMaterials(const scene::Scene& scene);
  bool storeMaterial(std::size_t index, const scene::Material& material);  // as setMaterial()
  void changeMaterials(const scene::Pose& pose);
  void moveEmitters();  // in the builder, to the deformed vertices
  void uploadLightTable(LightTable& table);
  void uploadMaterials(const scene::Scene& scene, scene::Scene* consumed, const scene::Environment& environment,
                       gpu::Uploader& uploader);
  MeshArrays downloadMesh(std::size_t mesh, std::size_t geometry) const;
  bool needsSingleAnyHit(const program::GeometryFacts& geometry) const;
  // Returns the geometries of a mesh. The boxes of primitive sets are stored in `boxes`, which must live until the
  // build ends.
  rt::BlasInput blasInput(const scene::Scene& scene, std::size_t mesh, std::deque<std::vector<Bounds3>>& boxes) const;
  void buildBottomLevel(const scene::Scene& scene);
  void addDeformedMeshes(const scene::Scene& scene, std::span<const rt::BlasInput> inputs,
                         std::span<const std::size_t> meshOfInput);
  void findMergeCandidates(const scene::Scene& scene);
  void uploadTables(const scene::Scene& scene);

  gpu::Context& context_;
  DeviceSceneOptions options_;
  DeviceSceneStatistics statistics_;
  GeometryUpload geometry_;
  std::optional<TextureUpload> textures_;
  std::unique_ptr<gpu::BindlessSet> set_;
  std::optional<TextureSlots> parameterSlots_;
  gpu::Buffer geometryTable_, materialTable_, albedoTable_;
  EnvironmentImage environmentImage_;  // of the constructor's environment
  gpu::Buffer constantEnvironment_;    // table of an environment without an image
  // If the animation changes the environment: without its image, which has the constant 1, and the integral of its table.
  struct AnimatedEnvironment {
    scene::Environment environment;
    double unscaledIntegral = 0;
  };
  std::optional<AnimatedEnvironment> animatedEnvironment_;
  gpu::Buffer lights_, lightTable_, lightNodes_, lightSlots_;
  std::unique_ptr<gpu::Uploader> lightUploader_;   // for light tables that change; new staging memory is slow to fill
  std::vector<std::uint32_t> firstLightSlots_;     // per instance
  std::optional<LightTableBuilder> lightBuilder_;  // only if lights move, or for edits
  LightTable lightTables_;                         // of the last edit, for its memory; empty above kKeptLights
  bool lightsOutdated_ = false;                    // an edit or a frame is not yet in the light tables
  std::vector<rt::Blas> blas_;                     // one per mesh that an instance uses
  std::vector<int> blasOfMesh_;                    // index in blas_; -1 if no instance uses the mesh
  std::uint64_t bottomLevelBytes_ = 0;
  std::vector<MergeCandidate> mergeCandidates_;
  std::optional<MergedInstances> merged_;  // built for the first program that permits it
  std::optional<TopLevel> topLevel_;
  std::shared_ptr<const scene::NodeAnimation> nodeAnimation_;  // null if no glTF animation plays
  std::optional<DeformedMeshes> deformed_;                     // if an animation deforms a mesh
  std::vector<DeformedGeometry> deformedGeometries_;
  std::optional<PreviousPositions> previousPositions_;
  double previousPositionsOf_ = 0;  // frame one after that of the positions
  CameraMedia cameraMedia_;
  std::vector<scene::Light> punctual_;  // at frame 0, if one is animated
  // The materials that the animation changes, with the values that do not change.
  struct AnimatedMaterial {
    scene::AnimatedMaterial animated;
    scene::Material material;
  };
  std::vector<AnimatedMaterial> animatedMaterials_;
  bool animated_ = false;
  double shownFrame_ = 0;
  FrameStatistics frameStatistics_;
  program::SceneFacts facts_;
  shared::Frame frame_{};
  Defines defines_;
  std::uint64_t revision_ = 0;
};

}  // namespace quintet::render
#endif

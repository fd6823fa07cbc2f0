// SPDX-License-Identifier: Apache-2.0
#include "render/scene/device_scene.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/memory.h"
#include "base/stopwatch.h"
#include "check/scene_facts.h"
#include "quintet/shared/radiance.h"
#include "render/scene/albedo_tables.h"
#include "render/scene/material_data.h"
#include "render/scene/procedural_data.h"
#include "scene/animation/keyframes.h"
#include "scene/model/limits.h"

namespace quintet::render {
namespace {

static_assert(sizeof(shared::Launch) <= shared::kPushConstantBytes);

constexpr VkDeviceSize kLightStaging = VkDeviceSize{32} << 20;   // largest staging memory for the tables of lights
constexpr VkDeviceSize kMinLightBuffer = VkDeviceSize{1} << 20;  // buffers up to this size are not shrunk
constexpr std::uint32_t kMinSlots = 1024;                        // of textures; those without a texture are white

static_assert(shared::kMaxRadiance == scene::kMaxRadiance);

// Returns the environment's texels as the device samples them: not negative, and at most the largest radiance.
io::Image cleanEnvironment(const io::Image& image) {
  io::Image clean = io::toChannels(io::toFloat(image), 4);
  for (float& value : clean.samples<float>()) value = value > 0.0f ? std::min(value, scene::kMaxRadiance) : 0.0f;
  return clean;
}

void setScaleAndRotation(shared::EnvironmentData& data, const scene::Environment& environment, const vec3& unscaled) {
  data.scale = environment.intensity * unscaled;
  data.cosRotation = std::cos(environment.rotation);
  data.sinRotation = std::sin(environment.rotation);
}

// Pads the tables of moving lights to their largest sizes. The lights that have power can change with the frame, and
// the buffers must hold all of them.
void padTables(LightTable& table) {
  table.entries.resize(table.lights.size(), shared::AliasEntry{1.0f, 0, 0.0f});
  table.nodes.resize(std::max(table.nodes.size(), 2 * table.lights.size()));
}

}  // namespace

DeviceScene::DeviceScene(gpu::Context& context, scene::Scene&& scene, const scene::Environment& environment,
                         const DeviceSceneOptions& options)
    : DeviceScene(context, scene, &scene, environment, options) {}

DeviceScene::DeviceScene(gpu::Context& context, const scene::Scene& scene, const scene::Environment& environment,
                         const DeviceSceneOptions& options)
    : DeviceScene(context, scene, nullptr, environment, options) {}

DeviceScene::DeviceScene(gpu::Context& context, const scene::Scene& scene, scene::Scene* consumed,
                         const scene::Environment& environment, const DeviceSceneOptions& options)
    : context_(context),
      options_(options),
      nodeAnimation_(scene.nodeAnimation),
      cameraMedia_(scene, [this](std::size_t mesh, std::size_t geometry) { return downloadMesh(mesh, geometry); }),
      animated_(scene::isAnimated(scene)),
      facts_(check::sceneFacts(scene)) {
  const Stopwatch watch;
  keepAnimatedMaterials(scene);
  defines_ = shaderDefines(sceneFeatures(scene, environment), context.info().quirks);
  uploadLights(scene, environment);  // first, because it reads images and attributes that the other uploads free
  statistics_.lightSeconds = watch.seconds();
  {
    // A CPU copies immediately, so a large staging ring would only waste memory.
    const VkDeviceSize limit = VkDeviceSize{context.info().software ? 8u : 64u} << 20;
    const VkDeviceSize bytes = textureUploadBytes(scene) + geometryUploadBytes(context, scene);
    gpu::Uploader uploader(context, std::min(2 * bytes, limit));
    uploadMaterials(scene, consumed, environment, uploader);
    geometry_ = uploadGeometries(context, uploader, scene, consumed);
    uploader.flush();
  }
  releaseFreedMemory();
  statistics_.uploadSeconds = watch.seconds();
  buildBottomLevel(scene);
  uploadTables(scene);
  statistics_.geometryBytes = geometry_.bytes;
  statistics_.textureBytes = textures_->bytes();
}

void DeviceScene::keepAnimatedMaterials(const scene::Scene& scene) {
  if (!nodeAnimation_) return;
  for (const scene::AnimatedMaterial& animated : nodeAnimation_->materials)
    animatedMaterials_.push_back({animated, scene.materials[static_cast<std::size_t>(animated.material)]});
}

void DeviceScene::uploadLights(const scene::Scene& scene, const scene::Environment& environment) {
  LightTableBuilder builder(scene, environment);
  const scene::Pose pose = scene::poseAt(nodeAnimation_.get(), 0.0);
  std::vector<mat4> worldFromObject;
  for (const scene::Instance& instance : scene.instances)
    worldFromObject.push_back(scene::shownTransformAt(instance, pose));
  LightTable table;
  builder.build(worldFromObject, table);
  EnvironmentTable environmentTable = std::move(builder.environment());
  firstLightSlots_ = table.firstSlots;
  if (std::ranges::any_of(scene.lights, &scene::Light::animated)) punctual_ = scene.lights;
  if (builder.hasMovingLights() || options_.editable || !environment.values.empty()) {
    builder.copyGeometry();
    lightBuilder_ = std::move(builder);
  }
  uploadLightTable(table);
  if (environmentTable.width > 0 && !environment.image.empty()) {
    environmentImage_.entries = gpu::makeBufferOf(context_, environmentTable.entries, 0, "environment table");
    if (!environmentTable.balanced.empty())
      environmentImage_.balanced =
          gpu::makeBufferOf(context_, environmentTable.balanced, 0, "balanced environment table");
    environmentTable.entries = {};
    environmentTable.balanced = {};
    environmentImage_.table = environmentTable;
  }
  showEnvironment(environment, environmentTable);
  statistics_.lightCount = frame_.lightCount;

  albedoTable_ = gpu::makeBufferOf(context_, albedoTables(), 0, "albedo tables");
  frame_.albedoTables = albedoTable_.address();
}

void DeviceScene::uploadLightTable(LightTable& table) {
  if (lightBuilder_ && lightBuilder_->hasMovingLights())
    padTables(table);
  else if (table.hasNoPower())
    table.clear();
  const std::array bytes{std::as_bytes(std::span(table.lights)), std::as_bytes(std::span(table.entries)),
                         std::as_bytes(std::span(table.nodes)), std::as_bytes(std::span(table.slots))};
  VkDeviceSize total = 0;
  for (const std::span<const std::byte>& part : bytes) total += part.size();
  std::unique_ptr<gpu::Uploader> uploader = std::move(lightUploader_);
  const VkDeviceSize staging = std::min(2 * total, kLightStaging);
  if (!uploader || uploader->stagingBytes() < staging) uploader = std::make_unique<gpu::Uploader>(context_, staging);
  const auto store = [&](gpu::Buffer& buffer, std::span<const std::byte> data, const char* name) {
    // A buffer is used again unless that wastes much memory: dragging a value edits lights many times a second.
    if (!buffer || buffer.size() < data.size() || buffer.size() > 2 * data.size() + kMinLightBuffer)
      buffer = gpu::Buffer(context_, {.size = data.size(), .name = name});
    uploader->upload(buffer, data);
    return buffer.address();
  };
  frame_.lights = store(lights_, bytes[0], "lights");
  frame_.lightTable = store(lightTable_, bytes[1], "light table");
  frame_.lightNodes = store(lightNodes_, bytes[2], "light nodes");
  frame_.lightSlots = store(lightSlots_, bytes[3], "light slots");
  uploader->flush();
  if (lightBuilder_) lightUploader_ = std::move(uploader);
  frame_.lightCount = static_cast<std::uint32_t>(table.entries.size());
  frame_.environmentLight = table.environmentLight;
}

void DeviceScene::showEnvironment(const scene::Environment& environment, const EnvironmentTable& table) {
  shared::EnvironmentData& data = frame_.environment;
  data.table = data.balancedTable = 0;
  data.width = table.width;
  data.height = table.height;
  if (table.width > 0) {
    if (environment.image.empty())
      constantEnvironment_ = gpu::makeBufferOf(context_, table.entries, 0, "environment table");
    data.table = environment.image.empty() ? constantEnvironment_.address() : environmentImage_.entries.address();
    const bool balanced = !environment.image.empty() && environmentImage_.balanced;
    data.balancedTable = balanced ? environmentImage_.balanced.address() : data.table;
  }
  data.texture = environment.image.empty() ? shared::kNoTexture : environmentImage_.texture;
  const vec3 unscaled = environment.image.empty() ? environment.constant : vec3(1.0f);
  setScaleAndRotation(data, environment, unscaled);
  if (environment.values.empty()) {
    animatedEnvironment_.reset();
    return;
  }
  AnimatedEnvironment animated;
  animated.environment.constant = unscaled;
  animated.environment.values = environment.values;
  animated.environment.animatedIntensityFactor = environment.animatedIntensityFactor;
  animated.environment.animatedRotationOffset = environment.animatedRotationOffset;
  animated.environment.intensity = environment.intensity;
  animated.environment.rotation = environment.rotation;
  animated.unscaledIntegral = table.width > 0 ? table.unscaledIntegral : 0.0;
  animatedEnvironment_ = std::move(animated);
}

void DeviceScene::moveEnvironment(const scene::Pose& pose) {
  scene::Environment& environment = animatedEnvironment_->environment;
  scene::moveEnvironment(environment, pose);
  setScaleAndRotation(frame_.environment, environment, environment.constant);
  setEnvironmentPower(animatedEnvironment_->unscaledIntegral * environment.intensity);
}

void DeviceScene::setEnvironmentPower(double integral) {
  if (integral == lightBuilder_->environmentIntegral()) return;  // it has only turned
  lightBuilder_->setEnvironment(integral);
  lightsOutdated_ = true;
}

void DeviceScene::uploadMaterials(const scene::Scene& scene, scene::Scene* consumed,
                                  const scene::Environment& environment, gpu::Uploader& uploader) {
  textures_.emplace(context_, uploader, scene, consumed);
  const TextureIndex expect = [&](int texture, bool sRgb) { return textures_->expect(texture, sRgb), 0u; };
  for (const scene::Material& material : scene.materials) makeMaterial(material, expect);
  std::vector<shared::MaterialData> materials;
  const TextureIndex textureIndex = [&](int texture, bool sRgb) { return textures_->index(texture, sRgb); };
  for (const scene::Material& material : scene.materials) materials.push_back(makeMaterial(material, textureIndex));
  materials.push_back(makeMaterial(scene::Material{}, textureIndex));
  materialTable_ = gpu::makeBufferOf(context_, materials, 0, "materials");
  frame_.materials = materialTable_.address();

  if (!environment.image.empty())
    environmentImage_.texture = textures_->addEnvironment(cleanEnvironment(environment.image));
  frame_.environment.texture = environmentImage_.texture;

  textures_->addUnused();
  const std::uint32_t slots = textures_->count() + TextureSlots::kCount;
  set_ = std::make_unique<gpu::BindlessSet>(context_, std::max(slots, std::min(kMinSlots, context_.info().maxTextures)),
                                            shared::kPushConstantBytes);
  parameterSlots_.emplace(*set_, textures_->count(), TextureSlots::kCount);
  uploader.flush();
  textures_->bind(*set_);
}

bool DeviceScene::needsSingleAnyHit(const program::GeometryFacts& geometry) const {
  switch (options_.singleAnyHit) {
    case program::SingleAnyHit::tinting: return geometry.tints;
    case program::SingleAnyHit::notOpaque: return geometry.tints || !geometry.opaque();
    case program::SingleAnyHit::all: return true;
  }
  return true;
}

rt::BlasInput DeviceScene::blasInput(const scene::Scene& scene, std::size_t mesh,
                                     std::deque<std::vector<Bounds3>>& boxes) const {
  rt::BlasInput input;
  input.options.name = scene.meshes[mesh].name;
  input.options.keepInputOrder = options_.keepInputOrder;
  input.options.allowUpdate = scene.meshes[mesh].deformation != nullptr;
  std::size_t k = geometry_.firstGeometry[mesh];
  for (std::size_t g = 0; g < scene.meshes[mesh].geometries.size(); ++g, ++k) {
    rt::GeometryInput& part = input.geometries.emplace_back();
    part.positions = geometry_.arrays[k].positions;
    part.triangles = geometry_.arrays[k].triangles;
    part.positionsAddress = geometry_.geometries[k].positions;
    part.trianglesAddress = geometry_.geometries[k].triangles;
    part.opaque = facts_.geometries[k].opaque();
    part.singleAnyHit = needsSingleAnyHit(facts_.geometries[k]);
  }
  for (const scene::PrimitiveSet& primitives : scene.meshes[mesh].primitiveSets) {
    rt::GeometryInput& part = input.geometries.emplace_back();
    part.kind = rt::GeometryKind::boxes;
    part.boxes = boxes.emplace_back(boxesForBuild(primitives));
    part.opaque = facts_.geometries[k].opaque();
    part.singleAnyHit = needsSingleAnyHit(facts_.geometries[k++]);
  }
  return input;
}

void DeviceScene::buildBottomLevel(const scene::Scene& scene) {
  blasOfMesh_.assign(scene.meshes.size(), -1);
  for (const scene::Instance& instance : scene.instances) blasOfMesh_[static_cast<std::size_t>(instance.mesh)] = 0;
  std::vector<rt::BlasInput> inputs;
  std::vector<std::size_t> meshOfInput;
  std::deque<std::vector<Bounds3>> boxes;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (blasOfMesh_[m] < 0) continue;
    blasOfMesh_[m] = static_cast<int>(inputs.size());
    meshOfInput.push_back(m);
    inputs.push_back(blasInput(scene, m, boxes));
  }
  blas_ = rt::BlasBuilder(context_).build(inputs, &statistics_.build);
  for (std::size_t i = 0; i < blas_.size(); ++i) {
    bottomLevelBytes_ += blas_[i].size();
    statistics_.primitiveMapBytes += blas_[i].mapBytes();
    for (std::size_t g = 0; g < inputs[i].geometries.size(); ++g)
      geometry_.geometries[geometry_.firstGeometry[meshOfInput[i]] + g].primitiveMap = blas_[i].primitiveMap(g);
  }
  addDeformedMeshes(scene, inputs, meshOfInput);
}

void DeviceScene::addDeformedMeshes(const scene::Scene& scene, std::span<const rt::BlasInput> inputs,
                                    std::span<const std::size_t> meshOfInput) {
  const scene::Pose pose = scene::poseAt(scene.nodeAnimation.get(), 0.0);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (!scene.meshes[meshOfInput[i]].deformation) continue;
    if (!deformed_) {
      std::optional<shader::Compiler> own;
      if (!options_.compiler) own.emplace(shader::CompilerOptions{});
      deformed_.emplace(context_, *set_, own ? *own : *options_.compiler);
    }
    const std::size_t mesh = meshOfInput[i];
    deformed_->add(scene, mesh, pose, inputs[i], blas_[i], geometry_);
    for (std::size_t g = 0; g < inputs[i].geometries.size(); ++g)
      deformedGeometries_.push_back({geometry_.firstGeometry[mesh] + g, inputs[i].geometries[g].positions.size()});
  }
}

// Static instances with opaque triangles whose mesh no other instance uses. An editable or animated scene has none.
void DeviceScene::findMergeCandidates(const scene::Scene& scene) {
  if (!context_.info().quirks.slowInstances || options_.keepInputOrder || options_.editable || animated_) return;
  std::vector<std::uint32_t> uses(scene.meshes.size(), 0);
  for (const scene::Instance& instance : scene.instances) ++uses[static_cast<std::size_t>(instance.mesh)];
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Instance& instance = scene.instances[i];
    const auto m = static_cast<std::size_t>(instance.mesh);
    const scene::Mesh& mesh = scene.meshes[m];
    const std::span<const program::GeometryFacts> facts =
        std::span(facts_.geometries).subspan(geometry_.firstGeometry[m], mesh.geometries.size());
    if (uses[m] > 1 || mesh.geometries.empty() || !mesh.primitiveSets.empty() || instance.mask != 0xFF ||
        instance.flags != 0 || !std::ranges::all_of(facts, &program::GeometryFacts::opaque))
      continue;
    mergeCandidates_.push_back({static_cast<std::uint32_t>(i), geometry_.firstGeometry[m],
                                static_cast<std::uint32_t>(mesh.geometries.size()), instance.worldFromObject});
  }
}

void DeviceScene::uploadTables(const scene::Scene& scene) {
  geometryTable_ = gpu::makeBufferOf(context_, geometry_.geometries, 0, "geometries");
  frame_.geometries = geometryTable_.address();
  std::vector<InstanceReferences> references;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const auto mesh = static_cast<std::size_t>(scene.instances[i].mesh);
    references.push_back(
        {&blas_[static_cast<std::size_t>(blasOfMesh_[mesh])], geometry_.firstGeometry[mesh], firstLightSlots_[i]});
  }
  findMergeCandidates(scene);
  topLevel_.emplace(context_, scene, references, mergeCandidates_.size() / 2);
  frame_.instances = topLevel_->table();
  frame_.previousInstances = topLevel_->previousTable();
  frame_.instanceCount = static_cast<std::uint32_t>(scene.instances.size());
}

void DeviceScene::prepareFor(std::uint32_t rayTypeCount, bool keepInstanceOrder, bool anyHitForAll,
                             bool mergeInstances) {
  const bool keepOrder = keepInstanceOrder || options_.keepInputOrder;
  const bool merge = mergeInstances && !keepOrder && !anyHitForAll && mergeCandidates_.size() >= 2;
  if (merge && !merged_) {
    merged_.emplace(context_, mergeCandidates_, geometry_.arrays, &statistics_.build);
    topLevel_->setMerged(merged_->clusters());
    bottomLevelBytes_ += merged_->bytes();
  }
  statistics_.mergedInstances = merge ? merged_->instanceCount() : 0;
  const Stopwatch watch;
  if (!topLevel_->prepareFor(rayTypeCount, keepOrder, anyHitForAll, merge)) return;
  set_->setAccelerationStructure(topLevel_->structure().handle());
  statistics_.accelerationBytes = bottomLevelBytes_ + topLevel_->structure().size();
  statistics_.topLevelSeconds = watch.seconds();
}

void DeviceScene::setFrame(double frame, Previous previous) {
  const bool withPrevious = previousPositions_ && previous == Previous::update && frame != previousPositionsOf_;
  if (animated_ && (frame != shownFrame_ || withPrevious)) showFrame(frame, withPrevious);
  updateLights();
}

double DeviceScene::previousFrame() const { return std::max(shownFrame_ - 1.0, std::min(shownFrame_, 0.0)); }

void DeviceScene::keepPreviousPositions() {
  if (previousPositions_ || deformedGeometries_.empty()) return;
  previousPositions_.emplace(context_, deformedGeometries_, geometry_.geometries.size());
  frame_.previousPositions = previousPositions_->table();
  showFrame(shownFrame_, true);
}

void DeviceScene::showFrame(double frame, bool withPrevious) {
  shownFrame_ = frame;
  ++revision_;
  Stopwatch watch;
  const scene::Pose pose = scene::poseAt(nodeAnimation_.get(), frame);
  const scene::Pose before = scene::poseAt(nodeAnimation_.get(), previousFrame());
  frameStatistics_.poseSeconds += watch.lap();
  if (withPrevious) {
    showDeformation(before);
    previousPositions_->copyFrom(geometry_);
    previousPositionsOf_ = frame;
  }
  changeMaterials(pose);
  if (deformed_) showDeformation(pose);
  watch.lap();
  if (deformed_ || topLevel_->animated()) topLevel_->setPose(pose, before);
  frameStatistics_.topLevelSeconds += watch.lap();
  if (animatedEnvironment_) moveEnvironment(pose);
  if (!lightBuilder_ || !lightBuilder_->hasMovingLights()) return;
  moveEmitters();
  if (!punctual_.empty()) movePunctualLights(pose);
  lightsOutdated_ = true;
}

void DeviceScene::changeMaterials(const scene::Pose& pose) {
  for (const AnimatedMaterial& changed : animatedMaterials_)
    storeMaterial(static_cast<std::size_t>(changed.animated.material),
                  scene::materialAt(changed.material, changed.animated.values, pose));
}

void DeviceScene::movePunctualLights(const scene::Pose& pose) {
  std::vector<scene::Light> lights;
  for (const scene::Light& light : punctual_) lights.push_back(scene::lightAt(light, pose));
  lightBuilder_->setPunctualLights(lights);
}

void DeviceScene::moveEmitters() {
  if (!deformed_) return;
  deformed_->forPositions(
      [&](std::size_t mesh, std::size_t geometry) { return lightBuilder_->hasPositions(mesh, geometry); },
      [&](std::size_t mesh, std::size_t geometry, std::span<const vec3> positions) {
        lightBuilder_->setPositions(mesh, geometry, positions);
      });
}

void DeviceScene::showDeformation(const scene::Pose& pose) {
  const auto updateMaps = [&](std::size_t mesh) {
    const std::size_t first = geometry_.firstGeometry[mesh];
    const rt::Blas& blas = blas_[static_cast<std::size_t>(blasOfMesh_[mesh])];
    const std::size_t count = blas.geometryCount();
    for (std::size_t g = 0; g < count; ++g) geometry_.geometries[first + g].primitiveMap = blas.primitiveMap(g);
    geometryTable_.upload(std::as_bytes(std::span(geometry_.geometries).subspan(first, count)),
                          first * sizeof(shared::GeometryData));
  };
  deformed_->setPose(*nodeAnimation_, pose, updateMaps);
  cameraMedia_.deform();
}

MeshArrays DeviceScene::downloadMesh(std::size_t mesh, std::size_t geometry) const {
  const VertexSlots& slots = geometry_.slots[geometry_.firstGeometry[mesh] + geometry];
  const auto copyOf = []<class T>(HostArray<T> array) {
    return array.copy.empty() ? std::vector<T>(array.mapped.begin(), array.mapped.end()) : std::move(array.copy);
  };
  MeshArrays arrays;
  if (slots.positions.bytes > 0) arrays.positions = copyOf(readArray<vec3>(geometry_, slots.positions));
  if (slots.triangles.bytes > 0) arrays.triangles = copyOf(readArray<uvec3>(geometry_, slots.triangles));
  return arrays;
}

Media DeviceScene::mediaAt(const vec3& point) {
  return cameraMedia_.any() ? cameraMedia_.at(point, topLevel_->worldFromObject()) : Media{};
}

void DeviceScene::updateLights() {
  if (!std::exchange(lightsOutdated_, false)) return;
  const Stopwatch watch;
  lightBuilder_->build(topLevel_->worldFromObject(), lightTables_);
  uploadLightTable(lightTables_);
  ++revision_;
  if (lightTables_.slots.size() > kKeptLights || lightTables_.lights.size() > kKeptLights) lightTables_ = {};
  frameStatistics_.lightSeconds += watch.seconds();
}

void DeviceScene::setTransforms(std::span<const InstanceTransform> transforms) {
  assert(options_.editable);
  for (const InstanceTransform& transform : transforms)
    topLevel_->setTransform(transform.instance, transform.worldFromObject);
  topLevel_->update();
  ++revision_;
  if (std::ranges::any_of(transforms, [&](const InstanceTransform& t) { return lightBuilder_->hasLights(t.instance); }))
    lightsOutdated_ = true;
}

void DeviceScene::setLights(const std::vector<scene::Light>& lights) {
  assert(options_.editable);
  lightsOutdated_ = true;
  if (punctual_.empty()) {
    lightBuilder_->setPunctualLights(lights);
    return;
  }
  punctual_ = lights;
  movePunctualLights(scene::poseAt(nodeAnimation_.get(), shownFrame_));
}

void DeviceScene::setEmission(const scene::Scene& scene) {
  assert(options_.editable);
  if (!lightBuilder_->setEmission(scene)) return;
  lightBuilder_->copyGeometry();
  moveEmitters();
  lightsOutdated_ = true;
}

bool DeviceScene::setEnvironment(const scene::Environment& environment) {
  assert(options_.editable);
  EnvironmentTable table;
  if (environment.image.empty()) {
    table = buildEnvironmentTable(environment);
  } else if (environment.intensity > 0.0f || !environment.values.empty()) {
    if (environmentImage_.table.width == 0) return false;
    table = environmentImage_.table;
    table.integral = table.unscaledIntegral * environment.intensity;
  }
  showEnvironment(environment, table);
  ++revision_;
  if (animatedEnvironment_)
    moveEnvironment(scene::poseAt(nodeAnimation_.get(), shownFrame_));
  else
    setEnvironmentPower(table.width > 0 ? table.integral : 0.0);
  return true;
}

bool DeviceScene::setMaterial(std::size_t index, const scene::Material& material) {
  for (AnimatedMaterial& changed : animatedMaterials_) {
    if (static_cast<std::size_t>(changed.animated.material) != index) continue;
    changed.material = material;
    const scene::Pose pose = scene::poseAt(nodeAnimation_.get(), shownFrame_);
    return storeMaterial(index, scene::materialAt(material, changed.animated.values, pose));
  }
  return storeMaterial(index, material);
}

bool DeviceScene::storeMaterial(std::size_t index, const scene::Material& material) {
  bool complete = true;
  const TextureIndex textureIndex = [&](int texture, bool sRgb) {
    const std::optional<std::uint32_t> found = textures_->find(texture, sRgb);
    complete = complete && found;
    return found.value_or(shared::kNoTexture);
  };
  const shared::MaterialData data = makeMaterial(material, textureIndex);
  if (!complete) return false;
  materialTable_.upload(std::as_bytes(std::span(&data, 1)), index * sizeof(data));
  cameraMedia_.setMaterial(index, material);
  ++revision_;
  return true;
}

}  // namespace quintet::render

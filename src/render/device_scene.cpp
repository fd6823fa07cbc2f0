#include "render/device_scene.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

#include "base/memory.h"
#include "base/stopwatch.h"
#include "render/albedo_tables.h"
#include "render/light_table.h"
#include "render/material_data.h"
#include "render/parameter_textures.h"
#include "render/procedural_data.h"
#include "render/scene_facts.h"
#include "render/scene_features.h"
#include "render/scene_upload.h"
#include "render/top_level.h"
#include "scene/keyframes.h"

namespace quintet::render {
namespace {

// The environment's texels as the device may see them: finite, not negative.
io::Image cleanEnvironment(const io::Image& image) {
  io::Image clean = io::toChannels(io::toFloat(image), 4);
  for (float& value : clean.samples<float>()) value = value > 0.0f ? std::min(value, 1e30f) : 0.0f;
  return clean;
}

}  // namespace

struct DeviceScene::Impl {
  gpu::Context& context;
  DeviceSceneOptions options;
  DeviceSceneStatistics statistics;
  Bounds3 bounds;
  GeometryUpload geometry;
  std::optional<TextureUpload> textures;
  std::unique_ptr<gpu::BindlessSet> set;
  std::optional<TextureSlots> parameterSlots;
  gpu::Buffer geometryTable, materialTable, lights, lightTable, lightNodes, lightSlots, environmentTable, albedoTable;
  std::vector<rt::Blas> blas;   // one per used mesh
  std::vector<int> blasOfMesh;  // -1: no instance uses the mesh
  std::uint64_t bottomLevelBytes = 0;
  std::optional<TopLevel> topLevel;
  program::SceneFacts facts;
  shared::Frame frame{};
  Defines defines;

  // `emptied`: null, or the same scene.
  Impl(gpu::Context& gpuContext, const scene::Scene& scene, scene::Scene* emptied,
       const scene::Environment& environment, const DeviceSceneOptions& sceneOptions)
      : context(gpuContext), options(sceneOptions), bounds(scene::worldBounds(scene)), facts(sceneFacts(scene)) {
    const Stopwatch watch;
    defines = shaderDefines(sceneFeatures(scene, environment), context.info().quirks);
    uploadLights(scene, environment);  // first: it reads what is given up below
    statistics.lightSeconds = watch.seconds();
    {
      // A CPU copies at once: a large ring would only be memory.
      const VkDeviceSize limit = VkDeviceSize{context.info().quirks.software ? 8u : 64u} << 20;
      gpu::Uploader uploader(context, std::min(2 * uploadBytes(context, scene), limit));
      uploadMaterials(scene, emptied, environment, uploader);
      geometry = uploadGeometries(context, uploader, scene, emptied);
      uploader.flush();
    }
    if (emptied) returnFreedMemory();
    statistics.uploadSeconds = watch.seconds();
    buildBottomLevel(scene);
    uploadTables(scene);
    statistics.geometryBytes = geometry.bytes;
    statistics.textureBytes = textures->bytes();
  }

  bool hasAlpha() const { return std::ranges::any_of(facts.geometries, &program::GeometryFacts::alpha); }

  void uploadMaterials(const scene::Scene& scene, scene::Scene* emptied, const scene::Environment& environment,
                       gpu::Uploader& uploader) {
    textures.emplace(context, uploader, scene);
    if (emptied) {
      textures->empty(*emptied);
      const TextureIndex expect = [&](int texture, bool sRgb) { return textures->expect(texture, sRgb), 0u; };
      for (const scene::Material& material : scene.materials) makeMaterial(material, expect);
    }
    std::vector<shared::MaterialData> materials;
    const TextureIndex textureIndex = [&](int texture, bool sRgb) { return textures->index(texture, sRgb); };
    for (const scene::Material& material : scene.materials) materials.push_back(makeMaterial(material, textureIndex));
    materials.push_back(makeMaterial(scene::Material{}, textureIndex));
    materialTable = gpu::makeBufferOf(context, materials, 0, "materials");
    frame.materials = materialTable.address();

    shared::EnvironmentData& data = frame.environment;
    data.scale = environment.intensity * (environment.image.empty() ? environment.constant : vec3(1.0f));
    data.texture =
        environment.image.empty() ? shared::kNoTexture : textures->addEnvironment(cleanEnvironment(environment.image));
    data.cosRotation = std::cos(environment.rotation);
    data.sinRotation = std::sin(environment.rotation);

    set = std::make_unique<gpu::BindlessSet>(context, textures->count() + TextureSlots::kCount,
                                             static_cast<std::uint32_t>(sizeof(shared::Launch)));
    parameterSlots.emplace(*set, textures->count(), TextureSlots::kCount);
    uploader.flush();
    textures->bind(*set);
  }

  void uploadLights(const scene::Scene& scene, const scene::Environment& environment) {
    LightTableBuilder builder(scene, environment);
    std::vector<mat4> places;
    for (const scene::Instance& instance : scene.instances) places.push_back(scene::worldFromObjectAt(instance, 0.0f));
    LightTable table = builder.build(places);
    table.environment = std::move(builder.environment());
    if (builder.moves()) {
      makeRoom(table);
      builder.keep();
      movingLights = std::move(builder);
    } else if (table.dark()) {
      table.clear();
    }
    lights = gpu::makeBufferOf(context, table.lights, 0, "lights");
    lightTable = gpu::makeBufferOf(context, table.entries, 0, "light table");
    lightNodes = gpu::makeBufferOf(context, table.nodes, 0, "light nodes");
    lightSlots = gpu::makeBufferOf(context, table.slots, 0, "light slots");
    frame.lights = lights.address();
    frame.lightTable = lightTable.address();
    frame.lightNodes = lightNodes.address();
    frame.lightSlots = lightSlots.address();
    frame.lightCount = static_cast<std::uint32_t>(table.entries.size());
    frame.environmentLight = table.environmentLight;
    if (table.environment.width > 0) {
      environmentTable = gpu::makeBufferOf(context, table.environment.entries, 0, "environment table");
      frame.environment.table = environmentTable.address();
      frame.environment.width = table.environment.width;
      frame.environment.height = table.environment.height;
    }
    statistics.lightCount = frame.lightCount;
    firstLightSlots = table.firstSlots;

    albedoTable = gpu::makeBufferOf(context, albedoTables(), 0, "albedo tables");
    frame.albedoTables = albedoTable.address();
  }

  // Of moving lights some may have no power at a frame, and others none at another: the buffers hold all of them.
  static void makeRoom(LightTable& table) {
    table.entries.resize(table.lights.size(), shared::AliasEntry{1.0f, 0, 0.0f});
    table.nodes.resize(std::max(table.nodes.size(), 2 * table.lights.size()));
  }

  void setFrame(float newFrame) {
    if (!topLevel->setFrame(newFrame) || !movingLights) return;
    LightTable table = movingLights->build(topLevel->places());
    makeRoom(table);
    lights.uploadAs(std::span<const shared::LightData>(table.lights));
    lightTable.uploadAs(std::span<const shared::AliasEntry>(table.entries));
    lightNodes.uploadAs(std::span<const shared::LightNode>(table.nodes));
  }

  void buildBottomLevel(const scene::Scene& scene) {
    blasOfMesh.assign(scene.meshes.size(), -1);
    for (const scene::Instance& instance : scene.instances) blasOfMesh[static_cast<std::size_t>(instance.mesh)] = 0;
    std::vector<rt::BlasInput> inputs;
    std::vector<std::size_t> meshOfInput;
    std::deque<std::vector<Bounds3>> boxes;  // of primitive sets, until the build has ended
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
      if (blasOfMesh[m] < 0) continue;
      blasOfMesh[m] = static_cast<int>(inputs.size());
      meshOfInput.push_back(m);
      rt::BlasInput& input = inputs.emplace_back();
      input.options.name = scene.meshes[m].name;
      input.options.keepInputOrder = options.keepInputOrder;
      std::size_t k = geometry.firstGeometry[m];
      for (std::size_t g = 0; g < scene.meshes[m].geometries.size(); ++g) {
        rt::GeometryInput& part = input.geometries.emplace_back();
        part.positions = geometry.arrays[k].positions;
        part.triangles = geometry.arrays[k].triangles;
        part.positionsAddress = geometry.geometries[k].positions;
        part.trianglesAddress = geometry.geometries[k].triangles;
        part.opaque = facts.geometries[k].opaque();
        part.singleAnyHit = facts.geometries[k++].tints;
      }
      for (const scene::PrimitiveSet& primitives : scene.meshes[m].primitiveSets) {
        rt::GeometryInput& part = input.geometries.emplace_back();
        part.kind = rt::GeometryKind::boxes;
        part.boxes = boxes.emplace_back(boxesForBuild(primitives));
        part.opaque = facts.geometries[k].opaque();
        part.singleAnyHit = facts.geometries[k++].tints;
      }
    }
    blas = rt::BlasBuilder(context).build(inputs, &statistics.build);
    for (std::size_t i = 0; i < blas.size(); ++i) {
      bottomLevelBytes += blas[i].size();
      statistics.primitiveMapBytes += blas[i].mapBytes();
      for (std::size_t g = 0; g < inputs[i].geometries.size(); ++g)
        geometry.geometries[geometry.firstGeometry[meshOfInput[i]] + g].primitiveMap = blas[i].primitiveMap(g);
    }
  }

  void uploadTables(const scene::Scene& scene) {
    geometryTable = gpu::makeBufferOf(context, geometry.geometries, 0, "geometries");
    frame.geometries = geometryTable.address();
    std::vector<InstancePlace> places;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
      const auto mesh = static_cast<std::size_t>(scene.instances[i].mesh);
      places.push_back(
          {&blas[static_cast<std::size_t>(blasOfMesh[mesh])], geometry.firstGeometry[mesh], firstLightSlots[i]});
    }
    topLevel.emplace(context, scene, places);
    frame.instances = topLevel->table();
    frame.previousInstances = topLevel->previousTable();
    frame.instanceCount = static_cast<std::uint32_t>(scene.instances.size());
  }

  void prepareFor(std::uint32_t rayTypeCount, bool keepInstanceOrder, bool anyHitForAll) {
    Stopwatch watch;
    if (!topLevel->prepareFor(rayTypeCount, keepInstanceOrder || options.keepInputOrder, anyHitForAll)) return;
    set->setAccelerationStructure(topLevel->structure().handle());
    statistics.accelerationBytes = bottomLevelBytes + topLevel->structure().size();
    statistics.topLevelSeconds = watch.seconds();
  }

  std::vector<std::uint32_t> firstLightSlots;
  std::optional<LightTableBuilder> movingLights;  // only if an instance with keyframes has lights
};

DeviceScene::DeviceScene(gpu::Context& context, const scene::Scene& scene, const scene::Environment& environment,
                         const DeviceSceneOptions& options)
    : impl_(std::make_unique<Impl>(context, scene, nullptr, environment, options)) {}
DeviceScene::DeviceScene(gpu::Context& context, scene::Scene&& scene, const scene::Environment& environment,
                         const DeviceSceneOptions& options)
    : impl_(std::make_unique<Impl>(context, scene, &scene, environment, options)) {}
DeviceScene::~DeviceScene() = default;

gpu::Context& DeviceScene::context() const { return impl_->context; }
const gpu::BindlessSet& DeviceScene::set() const { return *impl_->set; }
TextureSlots& DeviceScene::parameterSlots() { return *impl_->parameterSlots; }
const program::SceneFacts& DeviceScene::facts() const { return impl_->facts; }
bool DeviceScene::hasAlpha() const { return impl_->hasAlpha(); }
const std::vector<std::pair<std::string, std::string>>& DeviceScene::defines() const { return impl_->defines; }
const shared::Frame& DeviceScene::frameTemplate() const { return impl_->frame; }
const DeviceSceneStatistics& DeviceScene::statistics() const { return impl_->statistics; }
const Bounds3& DeviceScene::bounds() const { return impl_->bounds; }
bool DeviceScene::animated() const { return impl_->topLevel->animated(); }
void DeviceScene::prepareFor(std::uint32_t rayTypeCount, bool keepInstanceOrder, bool anyHitForAll) {
  impl_->prepareFor(rayTypeCount, keepInstanceOrder, anyHitForAll);
}
void DeviceScene::setFrame(float frame) { impl_->setFrame(frame); }

}  // namespace quintet::render

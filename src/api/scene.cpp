// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "api/impl.h"
#include "base/cancellation.h"
#include "base/memory_budget.h"
#include "base/plural.h"
#include "io/codec.h"
#include "job/scene_source.h"
#include "scene/animation/keyframes.h"
#include "scene/defaults/auto_camera.h"
#include "scene/geometry/repair.h"
#include "scene/geometry/tangents.h"
#include "scene/load.h"
#include "scene/model/limits.h"
#include "scene/model/texture_coordinates.h"
#include "scene/model/validate.h"
#include "scene/toml/scene_toml.h"

namespace quintet {
namespace {

// A row per property of a material that the public and the internal struct have in common.
template <class To, class From, class Value, class Use>
void copyMaterial(To& to, const From& from, const Value& value, const Use& use) {
  to.name = from.name;
  value(to.baseColor, from.baseColor);
  use(to.baseColorTexture, from.baseColorTexture);
  to.metallic = from.metallic;
  to.roughness = from.roughness;
  use(to.metallicRoughnessTexture, from.metallicRoughnessTexture);
  use(to.normalTexture, from.normalTexture);
  to.normalScale = from.normalScale;
  value(to.emissive, from.emissive);
  use(to.emissiveTexture, from.emissiveTexture);
  to.alphaMode = static_cast<decltype(to.alphaMode)>(from.alphaMode);
  to.alphaCutoff = from.alphaCutoff;
  to.doubleSided = from.doubleSided;
  to.unlit = from.unlit;
  to.ior = from.ior;
  to.transmission = from.transmission;
  use(to.transmissionTexture, from.transmissionTexture);
  to.thickness = from.thickness;
  to.attenuationDistance = from.attenuationDistance;
  value(to.attenuationColor, from.attenuationColor);
  to.specular = from.specular;
  use(to.specularTexture, from.specularTexture);
  value(to.specularColor, from.specularColor);
  use(to.specularColorTexture, from.specularColorTexture);
  to.clearcoat = from.clearcoat;
  use(to.clearcoatTexture, from.clearcoatTexture);
  to.clearcoatRoughness = from.clearcoatRoughness;
  use(to.clearcoatRoughnessTexture, from.clearcoatRoughnessTexture);
  use(to.clearcoatNormalTexture, from.clearcoatNormalTexture);
  to.clearcoatNormalScale = from.clearcoatNormalScale;
  value(to.sheenColor, from.sheenColor);
  use(to.sheenColorTexture, from.sheenColorTexture);
  to.sheenRoughness = from.sheenRoughness;
  use(to.sheenRoughnessTexture, from.sheenRoughnessTexture);
  to.diffuseTransmission = from.diffuseTransmission;
  use(to.diffuseTransmissionTexture, from.diffuseTransmissionTexture);
  value(to.diffuseTransmissionColor, from.diffuseTransmissionColor);
  use(to.diffuseTransmissionColorTexture, from.diffuseTransmissionColorTexture);
  to.anisotropy = from.anisotropy;
  to.anisotropyRotation = from.anisotropyRotation;
  use(to.anisotropyTexture, from.anisotropyTexture);
  to.iridescence = from.iridescence;
  use(to.iridescenceTexture, from.iridescenceTexture);
  to.iridescenceIor = from.iridescenceIor;
  to.iridescenceThicknessMinimum = from.iridescenceThicknessMinimum;
  to.iridescenceThicknessMaximum = from.iridescenceThicknessMaximum;
  use(to.iridescenceThicknessTexture, from.iridescenceThicknessTexture);
  to.dispersion = from.dispersion;
  value(to.multiscatterColor, from.multiscatterColor);
  to.scatterAnisotropy = from.scatterAnisotropy;
  to.dielectricPriority = from.dielectricPriority;
}

Material toPublic(const scene::Material& material) {
  Material result;
  copyMaterial(
      result, material, [](auto& to, const auto& from) { to = fromGlm(from); },
      [](TextureUse& to, const scene::TextureUse& from) {
        to = {from.texture, from.uvSet, fromGlm(from.offset), fromGlm(from.scale), from.rotation};
      });
  return result;
}

Transform toPublic(const mat4& m) {
  Transform result;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      result.rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = m[column][row];
  return result;
}

template <class T, class V>
std::vector<T> copyOf(std::span<const V> values) {
  std::vector<T> result;
  result.reserve(values.size());
  for (const V& value : values) result.push_back(toGlm(value));
  return result;
}

// "light 'sun'", or "light 2 of the scene in memory" without a name.
std::string objectName(const char* kind, std::size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{} {} of the scene in memory", kind, index) : fmt::format("{} '{}'", kind, name);
}

// Of three vertices per triangle. `mesh`: for messages.
std::vector<uvec3> consecutiveTriangles(std::size_t vertices, const std::string& mesh) {
  if (vertices % 3 != 0)
    throw UsageError(fmt::format("{}: triangles without indices have {}, which is not a multiple of 3", mesh,
                                 counted(vertices, "vertex", "vertices")));
  std::vector<uvec3> result(vertices / 3);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = uvec3(3 * i, 3 * i + 1, 3 * i + 2);
  return result;
}

scene::Geometry toGeometry(const Triangles& triangles, const std::string& mesh) {
  scene::Geometry geometry;
  geometry.positions = copyOf<vec3>(triangles.positions);
  if (triangles.indices.empty()) {
    geometry.triangles = consecutiveTriangles(triangles.positions.size(), mesh);
  } else {
    geometry.triangles.reserve(triangles.indices.size());
    for (const UInt3& t : triangles.indices) geometry.triangles.push_back({t[0], t[1], t[2]});
  }
  geometry.normals = copyOf<vec3>(triangles.normals);
  geometry.tangents = copyOf<vec4>(triangles.tangents);
  geometry.uvs = {copyOf<vec2>(triangles.uv0), copyOf<vec2>(triangles.uv1)};
  geometry.colors = copyOf<vec4>(triangles.colors);
  geometry.material = triangles.material;
  return geometry;
}

io::Image toIo(const Texture& texture, const std::string& name) {
  if (texture.channels < 1 || texture.channels > 4)
    throw UsageError(fmt::format("{}: {} channels, must be 1 to 4", name, texture.channels));
  if (texture.width == 0 || texture.height == 0 || std::max(texture.width, texture.height) > io::kMaxImageSide)
    throw UsageError(fmt::format("{}: {}x{} pixels, must be 1 to {} in each direction", name, texture.width,
                                 texture.height, io::kMaxImageSide));
  constexpr io::PixelType kTypes[] = {io::PixelType::u8, io::PixelType::u16, io::PixelType::f32};
  const io::PixelType type = kTypes[texture.pixels.index()];
  io::Image image = io::makeImage(texture.width, texture.height, texture.channels, type,
                                  type == io::PixelType::f32 ? io::ColorEncoding::linear : io::ColorEncoding::sRgb);
  std::visit(
      [&](const auto& pixels) {
        if (pixels.size() != image.sampleCount())
          throw UsageError(fmt::format("{}: {} for {}x{} pixels of {}", name, counted(pixels.size(), "value"),
                                       texture.width, texture.height, counted(texture.channels, "channel")));
        std::ranges::copy(std::as_bytes(pixels), image.data.begin());
      },
      texture.pixels);
  if (const auto* values = std::get_if<std::span<const float>>(&texture.pixels)) {
    const auto wrong =
        std::ranges::find_if_not(*values, [](float value) { return std::abs(value) <= scene::kMaxRadiance; });
    const auto pixel = static_cast<std::size_t>(wrong - values->begin()) / texture.channels;
    if (wrong != values->end())
      throw UsageError(fmt::format("{}: pixel ({}, {}) is {}", name, pixel % texture.width, pixel / texture.width,
                                   std::isfinite(*wrong) ? fmt::format("{:g}, above {:g}", *wrong, scene::kMaxRadiance)
                                                         : std::string("not finite")));
  }
  return image;
}

// Repairs the values of an image, and adds a line to the report if it changes.
void addRepair(scene::Scene& scene, const std::filesystem::path& file, io::Image& image) {
  if (const std::string repair = scene::repairTexels(image); !repair.empty())
    scene.report.repaired.push_back(fmt::format("{}: {}", file.string(), repair));
}

// Appends `object` and validates it; removes it again if it is invalid.
template <class T>
int append(scene::Scene& scene, std::vector<T>& list, T object, void (*validate)(const scene::Scene&, std::size_t)) {
  list.push_back(std::move(object));
  try {
    validate(scene, list.size() - 1);
  } catch (const Error& error) {
    list.pop_back();
    throw UsageError(error.what());
  }
  return static_cast<int>(list.size() - 1);
}

// Replaces an object by a valid one, or throws UsageError and changes nothing.
template <class T>
void replace(scene::Scene& scene, T& object, T value, std::size_t index,
             void (*validate)(const scene::Scene&, std::size_t)) {
  std::swap(object, value);
  try {
    validate(scene, index);
  } catch (const Error& error) {
    std::swap(object, value);
    throw UsageError(error.what());
  }
}

template <class T>
std::size_t checkedIndex(int index, const std::vector<T>& list, const char* what) {
  if (index < 0 || static_cast<std::size_t>(index) >= list.size())
    throw UsageError(fmt::format("{} {} does not exist; the scene has {}", what, index, list.size()));
  return static_cast<std::size_t>(index);
}

template <class T>
std::optional<int> findByName(const std::vector<T>& list, std::string_view name) {
  const auto found = std::ranges::find(list, name, &T::name);
  return found == list.end() ? std::nullopt : std::optional(static_cast<int>(found - list.begin()));
}

void requireFinite(const Float3& v, const std::string& object, const char* what) {
  if (!isFinite(toGlm(v))) throw UsageError(fmt::format("{}: {} is not finite", object, what));
}

scene::LoadOptions toScene(const LoadOptions& options) {
  if (!(std::isfinite(options.framesPerSecond) && options.framesPerSecond > 0))
    throw UsageError(fmt::format("{} frames per second: the rate must be above 0", options.framesPerSecond));
  scene::LoadOptions load;
  load.scene = options.scene;
  load.variant = options.variant;
  if (options.animation != "none") load.animation = options.animation;
  load.framesPerSecond = options.framesPerSecond;
  load.strict = options.strict;
  if (options.omitTextures) load.missingTextures = scene::MissingTextures::warn;
  load.maxMemory = options.maxMemory;
  load.allowExternal = options.allowExternal;
  return load;
}

}  // namespace

mat4 toGlm(const Transform& transform) {
  mat4 m(1.0f);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      m[column][row] = transform.rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
  return m;
}

scene::Material toScene(const Material& material) {
  scene::Material result;
  copyMaterial(
      result, material, [](auto& to, const auto& from) { to = toGlm(from); },
      [](scene::TextureUse& to, const TextureUse& from) {
        to = {from.texture, from.uvSet, toGlm(from.offset), toGlm(from.scale), from.rotation};
      });
  return result;
}

scene::Camera toScene(const Camera& camera, const std::string& name) {
  requireFinite(camera.lookFrom, name, "lookFrom");
  requireFinite(camera.lookAt, name, "lookAt");
  requireFinite(camera.up, name, "up");
  if (!(camera.verticalFov > 0.0f && camera.verticalFov < kPi))
    throw UsageError(fmt::format("{}: verticalFov {} is not between 0 and pi", name, camera.verticalFov));
  if (!(camera.apertureRadius >= 0.0f && std::isfinite(camera.apertureRadius)))
    throw UsageError(fmt::format("{}: apertureRadius {} is negative or not finite", name, camera.apertureRadius));
  return scene::lookAtCamera(toGlm(camera.lookFrom), toGlm(camera.lookAt), toGlm(camera.up), camera.verticalFov,
                             camera.apertureRadius);
}

Scene::Scene() : impl_(std::make_shared<Impl>()) {}
Scene::Impl& Scene::impl() const { return requireObject(impl_, "Scene"); }

Scene::Impl& Scene::change() {
  // Renderers and copies keep what they have.
  if (impl_.use_count() > 1 || impl().scene.use_count() > 1)
    impl_ = std::make_shared<Impl>(Impl{std::make_shared<scene::Scene>(*impl().scene)});
  // use_count() is a relaxed load: what another thread read through the last other copy must precede the change.
  std::atomic_thread_fence(std::memory_order_acquire);
  return *impl_;
}

Scene Scene::load(const std::filesystem::path& file, const LoadOptions& options) {
  Scene result;
  Cancellation cancellation(options.canceled);
  const Cancellation::Scope scope(&cancellation);
  result.impl_->scene = std::make_shared<scene::Scene>(scene::loadScene(file, toScene(options)));
  throwIfCanceled();
  return result;
}

Scene Scene::fromToml(std::string_view text, const std::filesystem::path& folder, std::size_t maxMemory) {
  Scene result;
  result.impl_->scene =
      std::make_shared<scene::Scene>(scene::parseSceneToml(text, folder / "scene.toml", {.maxMemory = maxMemory}));
  return result;
}

Scene Scene::of(const Program& program) {
  Scene result;
  result.impl_->scene =
      std::make_shared<scene::Scene>(job::loadScene(job::chooseSceneSource({}, program.impl().program)));
  return result;
}

int Scene::addTexture(const Texture& texture) {
  io::Image image = toIo(texture, objectName("texture", impl().scene->textures.size(), texture.name));
  scene::Scene& scene = *change().scene;
  scene.images.push_back({texture.name, std::move(image)});
  scene.textures.push_back({texture.name,
                            static_cast<int>(scene.images.size() - 1),
                            {static_cast<scene::Wrap>(texture.wrapU), static_cast<scene::Wrap>(texture.wrapV),
                             static_cast<scene::Filter>(texture.filter)}});
  return static_cast<int>(scene.textures.size() - 1);
}

int Scene::addTexture(const std::filesystem::path& file, std::size_t maxMemory) {
  MemoryBudget budget(file, maxMemory);
  io::Image image = io::readImage(file, budget);
  scene::Scene& scene = *change().scene;
  addRepair(scene, file, image);
  scene.images.push_back({file.string(), std::move(image)});
  scene.textures.push_back({file.filename().string(), static_cast<int>(scene.images.size() - 1), {}});
  return static_cast<int>(scene.textures.size() - 1);
}

int Scene::addMaterial(const Material& material) {
  scene::Scene& scene = *change().scene;
  return append(scene, scene.materials, toScene(material), scene::validateMaterial);
}

int Scene::addMesh(const Triangles& triangles, const std::string& name) {
  return addMesh(std::span(&triangles, 1), name);
}

int Scene::addMesh(std::span<const Triangles> geometries, const std::string& name) {
  scene::Scene& scene = *change().scene;
  scene::Mesh mesh;
  mesh.name = name;
  const std::string shown = objectName("mesh", scene.meshes.size(), name);
  for (const Triangles& triangles : geometries) mesh.geometries.push_back(toGeometry(triangles, shown));
  scene::requireCoordinates(mesh, shown, scene);
  const int index = append(scene, scene.meshes, std::move(mesh), scene::validateMesh);
  for (scene::Geometry& geometry : scene.meshes.back().geometries) {
    scene::repairNormals(geometry);
    scene::repairTangents(geometry);
    scene::repairUvsAndColors(geometry);
    if (geometry.material != scene::kNone)
      scene::addTangents(geometry, scene.materials[static_cast<std::size_t>(geometry.material)]);
  }
  return index;
}

int Scene::addBoxes(std::span<const Bounds> boxes, int material, const std::string& name) {
  scene::Scene& scene = *change().scene;
  scene::PrimitiveSet set;
  set.name = name;
  set.kind = scene::PrimitiveSetKind::custom;
  set.material = material;
  for (const Bounds& box : boxes) set.boxes.push_back({toGlm(box.min), toGlm(box.max)});
  scene::Mesh mesh;
  mesh.name = name;
  mesh.primitiveSets.push_back(std::move(set));
  return append(scene, scene.meshes, std::move(mesh), scene::validateMesh);
}

int Scene::addInstance(const Instance& instance) {
  scene::Instance added;
  added.name = instance.name;
  added.mesh = instance.mesh;
  added.worldFromObject = toGlm(instance.worldFromObject);
  added.mask = instance.mask;
  added.customIndex = instance.customIndex;
  for (const Keyframe& key : instance.keyframes) {
    const Float4& q = key.rotation;
    added.keyframes.push_back({key.frame, toGlm(key.translation), quat(q[3], q[0], q[1], q[2]), toGlm(key.scale)});
  }
  scene::Scene& scene = *change().scene;
  const int index = append(scene, scene.instances, std::move(added), scene::validateInstance);
  scene::Instance& last = scene.instances.back();
  if (!last.keyframes.empty()) last.worldFromObject = scene::worldFromObjectAt(last, 0.0f);
  return index;
}

int Scene::addLight(const Light& light) {
  scene::Light added;
  added.name = light.name;
  added.type = static_cast<scene::LightType>(light.type);
  added.intensity = toGlm(light.intensity);
  added.position = toGlm(light.position);
  const std::string name = objectName("light", impl().scene->lights.size(), light.name);
  const float length = glm::length(toGlm(light.direction));
  if (light.type != LightType::point && !(length > 0.0f && std::isfinite(length)))
    throw UsageError(name + ": the direction has length 0 or is not finite");
  if (light.type != LightType::point) added.direction = toGlm(light.direction) / length;
  if (light.type == LightType::spot && !(light.innerConeAngle >= 0.0f && light.innerConeAngle < light.outerConeAngle &&
                                         light.outerConeAngle <= 0.5f * kPi + 1e-6f))
    throw UsageError(fmt::format("{}: the cone angles are {} and {}, must be 0 <= inner < outer <= pi/2", name,
                                 light.innerConeAngle, light.outerConeAngle));
  if (glm::any(glm::lessThan(added.intensity, vec3(0.0f)))) throw UsageError(name + ": the intensity is negative");
  added.innerConeAngle = light.innerConeAngle;
  added.outerConeAngle = light.outerConeAngle;
  added.range = light.range;
  scene::Scene& scene = *change().scene;
  return append(scene, scene.lights, std::move(added), scene::validateLight);
}

int Scene::addCamera(const Camera& camera, const std::string& name) {
  scene::Camera added = quintet::toScene(camera, objectName("camera", impl().scene->cameras.size(), name));
  added.name = name;
  scene::Scene& scene = *change().scene;
  return append(scene, scene.cameras, std::move(added), scene::validateCamera);
}

void Scene::setEnvironment(const Environment& environment) {
  scene::Environment added;
  added.present = true;
  added.intensity = environment.intensity;
  added.rotation = environment.rotation;
  added.constant = toGlm(environment.radiance);
  if (!isFinite(added.constant) || glm::any(glm::lessThan(added.constant, vec3(0.0f))) ||
      !(environment.intensity >= 0.0f) || !std::isfinite(environment.intensity + environment.rotation))
    throw UsageError("environment: radiance and intensity must be finite and not negative, the rotation finite");
  if (!glm::all(glm::lessThanEqual(added.constant, vec3(scene::kMaxRadiance))))
    throw UsageError(fmt::format("environment: the radiance must be at most {:g}", scene::kMaxRadiance));
  if (!environment.pixels.empty()) {
    const std::span<const float> values(environment.pixels.front().data(), 3 * environment.pixels.size());
    added.image = toIo({"", environment.width, environment.height, 3, values}, "environment");
  }
  change().scene->environment = std::move(added);
}

void Scene::setEnvironment(const std::filesystem::path& file, std::size_t maxMemory) {
  MemoryBudget budget(file, maxMemory);
  scene::Environment added;
  added.present = true;
  added.name = file.string();
  added.image = io::readRadiance(file, budget);
  scene::Scene& scene = *change().scene;
  addRepair(scene, file, added.image);
  scene.environment = std::move(added);
}

void Scene::setMaterial(int index, const Material& material) {
  const std::size_t i = checkedIndex(index, impl().scene->materials, "material");
  scene::Scene& scene = *change().scene;
  scene::requireCoordinates(scene, i, toScene(material));
  replace(scene, scene.materials[i], toScene(material), i, scene::validateMaterial);
  scene::addTangents(scene, i);
}

void Scene::setTransform(int instance, const Transform& worldFromObject) {
  const std::size_t i = checkedIndex(instance, impl().scene->instances, "instance");
  scene::Scene& scene = *change().scene;
  scene::Instance moved = scene.instances[i];
  moved.worldFromObject = toGlm(worldFromObject);
  moved.keyframes.clear();
  moved.node = scene::kNone;
  replace(scene, scene.instances[i], std::move(moved), i, scene::validateInstance);
}

std::string Scene::name() const { return impl().scene->name; }
std::size_t Scene::meshCount() const { return impl().scene->meshes.size(); }
std::size_t Scene::materialCount() const { return impl().scene->materials.size(); }
std::size_t Scene::instanceCount() const { return impl().scene->instances.size(); }
std::size_t Scene::lightCount() const { return impl().scene->lights.size(); }
std::size_t Scene::cameraCount() const { return impl().scene->cameras.size(); }

Material Scene::material(int index) const {
  return toPublic(impl().scene->materials[checkedIndex(index, impl().scene->materials, "material")]);
}

Transform Scene::transform(int instance) const {
  return toPublic(impl().scene->instances[checkedIndex(instance, impl().scene->instances, "instance")].worldFromObject);
}

std::optional<int> Scene::findInstance(std::string_view name) const {
  return findByName(impl().scene->instances, name);
}
std::optional<int> Scene::findMaterial(std::string_view name) const {
  return findByName(impl().scene->materials, name);
}

SceneReport Scene::report() const {
  SceneReport result;
  for (const scene::Feature& from : impl().scene->report.features)
    result.features.push_back(
        {from.kind, from.name, static_cast<FeatureUse>(from.use), from.count, from.location, from.reason});
  result.ignored = impl().scene->report.ignored;
  result.repaired = impl().scene->report.repaired;
  for (const scene::MetadataEntry& from : impl().scene->report.metadata)
    result.metadata.push_back({from.object, from.name, from.value});
  return result;
}

Bounds Scene::bounds() const {
  const Bounds3 b = scene::worldBounds(*impl().scene);
  return {fromGlm(b.min), fromGlm(b.max)};
}

}  // namespace quintet

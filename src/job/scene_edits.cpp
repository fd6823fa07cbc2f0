// SPDX-License-Identifier: Apache-2.0
// Edits of a job between two renders (RenderJob::setCamera and others). An edit changes the copy of the scene in host
// memory and, if possible, only the affected table on the device. Everything else of the scene is rebuilt from the
// copy.
#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "check/scene_facts.h"
#include "job/identity.h"
#include "job/render_job.h"
#include "scene/animation/pose.h"
#include "scene/geometry/tangents.h"
#include "scene/model/content_hash.h"
#include "scene/model/validate.h"

namespace quintet::job {
namespace {

// What shaders and acceleration structures were made for.
struct DeviceForm {
  render::SceneFeatures features;
  program::SceneFacts facts;
  bool operator==(const DeviceForm&) const = default;
};

DeviceForm deviceForm(const scene::Scene& scene) {
  // Materials do not affect what depends on the environment alone. They add or remove the light tree only together with
  // lights of triangles.
  return {render::sceneFeatures(scene, scene::Environment{}), check::sceneFacts(scene)};
}

// What the animation of a scene sets at a frame, in objects that are visible at that frame or not.
scene::Pose poseOfAllObjects(const scene::Scene& scene, double frame) {
  scene::Pose pose = scene::poseAt(scene.nodeAnimation.get(), frame);
  pose.visible.assign(pose.visible.size(), true);
  return pose;
}

// The values of material `index` that change.
std::span<const scene::AnimatedValue> valuesOfMaterial(const scene::Scene& scene, std::size_t index) {
  if (!scene.nodeAnimation) return {};
  const auto& animated = scene.nodeAnimation->materials;
  const auto found = std::ranges::find(animated, static_cast<int>(index), &scene::AnimatedMaterial::material);
  return found == animated.end() ? std::span<const scene::AnimatedValue>() : found->values;
}

// An edit whose result the animation replaces would have no effect.
[[noreturn]] void failAnimated(const char* kind, const std::string& name) {
  throw UsageError(fmt::format("the animation of {} '{}' sets the value that this edit changes", kind, name));
}

}  // namespace

scene::Scene& RenderJob::editedScene() {
  assert(job_.request.editable && job_.scene.loaded);
  if (!editedScene_) editedScene_ = std::make_shared<scene::Scene>(*job_.scene.loaded);
  return *editedScene_;
}

void RenderJob::restart() {
  if (!team_) return;  // update() failed and is repeated by the next run()
  team_->restart();
  if (prints_) prints_->restart();
  forgetSamples();
}

void RenderJob::forgetSamples() {
  start_ = {};
  started_ = false;
  nextFrame_ = 0;
}

void RenderJob::changeScenes(const std::function<void(render::DeviceScene&)>& change) {
  if (team_) return team_->change([&](TeamMember& member) { change(*member.scene); });
  change(*scene_->onDevice);
  for (const auto& scene : scene_->onFurther) change(*scene);
}

void RenderJob::changeRenderers(const std::function<void(render::Renderer&)>& change) {
  team_->change([&](TeamMember& member) { change(*member.renderer); });
}

void RenderJob::setCamera(const CameraRequest& camera) {
  const uvec2 size = scene_ ? scene_->size : job_.request.size;
  const float aspect = size.y > 0 ? static_cast<float>(size.x) / static_cast<float>(size.y) : 0.0f;
  CameraChoice chosen = scene_ && !scene_->movingCameras.empty()
                            ? chooseMovingCamera(camera, shownFrame())
                            : chooseCamera(hostScene(), camera, aspect, job_.request.bounds);
  job_.request.camera = camera;
  if (!team_) return;  // update() failed and is repeated by the next run()
  scene_->camera = chosen.camera;
  scene_->cameraDescription = std::move(chosen.description);
  restart();
  changeRenderers([&](render::Renderer& renderer) { renderer.setCamera(scene_->camera); });
  provenanceOutdated_ = true;
}

void RenderJob::setParameters(const std::vector<std::string>& assignments) {
  RenderRequest request;
  request.parameterFile = job_.request.parameterFile;
  request.assignments = assignments;
  program::ParameterValues values = parameterValues(job_.program, request);
  if (team_) changeRenderers([&](render::Renderer& renderer) { renderer.setParameters(values); });
  job_.parameters = std::move(values);
  job_.request.assignments = assignments;
  restart();
  provenanceOutdated_ = true;
}

void RenderJob::setTransform(std::size_t instance, const mat4& worldFromObject) {
  scene::Scene& scene = editedScene();
  if (instance >= scene.instances.size())
    throw UsageError(fmt::format("instance {} does not exist; the scene has {}", instance, scene.instances.size()));
  scene::Instance& edited = scene.instances[instance];
  if (edited.animated())
    throw UsageError(fmt::format("instance {} is animated by {}, which set its transform", instance,
                                 edited.keyframes.empty() ? "the channels of the glTF file" : "keyframes"));
  const mat4 before = std::exchange(edited.worldFromObject, worldFromObject);
  try {
    scene::validateInstance(scene, instance);
  } catch (const Error& error) {
    edited.worldFromObject = before;
    throw UsageError(error.what());
  }
  movedInstances_[instance] = worldFromObject;
  sceneEdited_ = true;
  restart();
}

void RenderJob::setMaterial(std::size_t index, const scene::Material& material) {
  scene::Scene& scene = editedScene();
  if (index >= scene.materials.size())
    throw UsageError(fmt::format("material {} does not exist; the scene has {}", index, scene.materials.size()));
  const DeviceForm form = deviceForm(scene);
  const scene::Material before = std::exchange(scene.materials[index], material);
  try {
    scene::validateMaterial(scene, index);
    const std::span<const scene::AnimatedValue> values = valuesOfMaterial(scene, index);
    const scene::Pose pose = poseOfAllObjects(scene, shownFrame());
    if (material != before && materialAt(material, values, pose) == materialAt(before, values, pose))
      failAnimated("material", material.name);
  } catch (const Error& error) {
    scene.materials[index] = before;
    throw UsageError(error.what());
  }
  sceneEdited_ = true;
  restart();
  const DeviceForm edited = deviceForm(scene);
  const bool newTangents = scene::addTangents(scene, index);
  sceneOutdated_ = sceneOutdated_ || newTangents || edited.facts != form.facts;
  if (!sceneOutdated_) {
    std::atomic<bool> complete{true};
    changeScenes([&](render::DeviceScene& device) {
      if (!device.setMaterial(index, material)) complete = false;
    });
    sceneOutdated_ = !complete;
  }
  emissionOutdated_ = true;
  programOutdated_ = programOutdated_ || edited.features != form.features;
}

void RenderJob::setPlannedSamples(std::uint32_t count) {
  job_.request.limits.samples = count;
  job_.request.frames.accumulated = count;
  if (!team_) return;  // update() failed and is repeated by the next run()
  changeRenderers([&](render::Renderer& renderer) { renderer.setPlannedSamples(count); });
  restart();
  provenanceOutdated_ = true;
}

void RenderJob::setFrame(double frame) {
  if (job_.accumulatesFrames())
    throw UsageError(fmt::format("the program '{}' counts its frames itself", job_.program.name));
  if (!std::isfinite(frame)) throw UsageError(fmt::format("frame {} is not finite", frame));
  if (frame != 0 && scene_) requireFrames();
  frame_ = frame;
  frameOutdated_ = true;
  restart();
}

const scene::Environment& RenderJob::environmentInUse() const {
  return plainEnvironment_ ? plainEnvironment_->environment : scene_->environmentInUse.environment;
}

void RenderJob::setLight(std::size_t index, const scene::Light& light) {
  scene::Scene& scene = editedScene();
  if (index >= scene.lights.size())
    throw UsageError(fmt::format("light {} does not exist; the scene has {}", index, scene.lights.size()));
  const scene::Light before = std::exchange(scene.lights[index], light);
  try {
    scene::validateLight(scene, index);
    const scene::Pose pose = poseOfAllObjects(scene, shownFrame());
    if (light != before && lightAt(light, pose) == lightAt(before, pose)) failAnimated("light", light.name);
  } catch (const Error& error) {
    scene.lights[index] = before;
    throw UsageError(error.what());
  }
  sceneEdited_ = lightsOutdated_ = true;
  restart();
}

void RenderJob::setEnvironment(const EnvironmentRequest& environment) {
  std::optional<EnvironmentChoice> plain;
  bool rebuild = !scene_;
  if (!rebuild && environment.source != scene_->environmentSource) {
    plain = chooseEnvironment(hostScene(), environment, job_.request.load.maxMemory);
    rebuild = !plain->environment.image.empty();
  }
  job_.request.environment = environment;
  restart();
  sceneOutdated_ = sceneOutdated_ || rebuild;
  if (sceneOutdated_) return;
  const auto isBlack = [&] {
    const scene::Environment& e = environmentInUse();
    return (!(e.intensity > 0.0f) && e.values.empty()) || (e.image.empty() && e.constant == vec3(0.0f));
  };
  const bool wasBlack = isBlack();
  plainEnvironment_ = std::move(plain);
  if (!plainEnvironment_) adjust(scene_->environmentInUse, environment);
  scene_->environment = plainEnvironment_ ? plainEnvironment_->description : scene_->environmentInUse.description;
  environmentOutdated_ = environmentEdited_ = true;
  programOutdated_ = programOutdated_ || isBlack() != wasBlack;
}

const EnvironmentRequest& RenderJob::keepEnvironment() {
  std::string& source = job_.request.environment.source;
  if (source.empty() && !hostScene().environment.present)
    source = scene_->environmentSource = scene_->environmentInUse.isFallback() ? "default" : "none";
  return job_.request.environment;
}

void RenderJob::update(Observer& observer) {
  if (!sceneOutdated_ && environmentOutdated_) {
    std::atomic<bool> complete{true};
    changeScenes([&](render::DeviceScene& device) {
      if (!device.setEnvironment(environmentInUse())) complete = false;
    });
    sceneOutdated_ = !complete;
  }
  if (sceneOutdated_) {
    rebuildScene(observer);
    updateFrame();
  } else {
    editDevice();
    updateFrame();
    changeScenes([](render::DeviceScene& device) { device.updateLights(); });  // once for all edits
    if (programOutdated_) relink(observer);
  }
  sceneOutdated_ = programOutdated_ = emissionOutdated_ = lightsOutdated_ = environmentOutdated_ = false;
  movedInstances_.clear();
}

// Edits the transforms, materials and lights of the scene on the device.
void RenderJob::editDevice() {
  if (!movedInstances_.empty()) {
    std::vector<render::InstanceTransform> transforms;
    for (const auto& [instance, worldFromObject] : movedInstances_) transforms.push_back({instance, worldFromObject});
    changeScenes([&](render::DeviceScene& device) { device.setTransforms(transforms); });
  }
  if (emissionOutdated_) changeScenes([&](render::DeviceScene& device) { device.setEmission(*editedScene_); });
  if (lightsOutdated_) changeScenes([&](render::DeviceScene& device) { device.setLights(editedScene_->lights); });
}

void RenderJob::updateFrame() {
  if (!std::exchange(frameOutdated_, false)) return;
  changeScenes([&](render::DeviceScene& device) { device.setFrame(shownFrame()); });
  if (!scene_->movingCameras.empty()) {
    scene_->camera = chooseMovingCamera(job_.request.camera, shownFrame()).camera;
    changeRenderers([&](render::Renderer& renderer) { renderer.setCamera(scene_->camera); });
  }
  moveShutter();
  provenanceOutdated_ = true;
}

void RenderJob::releaseDevice() {
  assert(job_.request.editable);
  if (editedScene_) job_.scene.loaded = editedScene_;
  // The image keeps the size that was chosen for the first camera.
  if (scene_) job_.request.size = scene_->size;
  team_.reset();
  complete_.reset();
  prints_.reset();
  scene_.reset();
  plainEnvironment_.reset();
  start_ = {};
  started_ = false;
  nextFrame_ = 0;
  sceneOutdated_ = true;
}

void RenderJob::rebuildScene(Observer& observer) {
  releaseDevice();
  prepare(observer);
  sceneEdited_ = environmentEdited_ = false;  // prepare() has computed the hashes
  frameOutdated_ = true;                      // a new scene shows frame 0
}

// Compiles the program for the features of the edited scene.
void RenderJob::relink(Observer& observer) {
  const render::SceneFeatures features = render::sceneFeatures(hostScene(), environmentInUse());
  changeScenes([&](render::DeviceScene& device) { device.setFeatures(features); });
  observer.stage(kCompilingStage);
  try {
    link(program::compile(job_.program, engine_.compiler(),
                          render::renderDefines(scene_->onDevice->defines(), job_.request.outputs)),
         observer);
  } catch (...) {  // the old program does not fit the scene
    team_.reset();
    complete_.reset();
    sceneOutdated_ = true;
    throw;
  }
  provenanceOutdated_ = true;
}

void RenderJob::describeEdits() const {
  if (!provenanceOutdated_ && !sceneEdited_ && !environmentEdited_) return;
  if (sceneEdited_) scene_->hash = scene::contentHash(*editedScene_).hex();
  if (environmentEdited_) scene_->environmentHash = scene::contentHash(environmentInUse()).hex();
  provenanceOutdated_ = sceneEdited_ = environmentEdited_ = false;
  provenance_ = makeProvenance();
}

}  // namespace quintet::job

// SPDX-License-Identifier: Apache-2.0
// Edits of a job between two renders (RenderJob::setCamera and others). An edit changes the copy of the scene in host memory
// and, if possible, only the affected table on the device. Everything else of the scene is rebuilt from the copy.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "check/scene_facts.h"
#include "job/identity.h"
#include "job/render_job.h"
#include "scene/geometry/tangents.h"
#include "scene/model/content_hash.h"
#include "scene/model/validate.h"

namespace quintet::job {
namespace {

// True if lights depend on the difference between the materials.
bool emissionDiffers(const scene::Material& a, const scene::Material& b) {
  const auto emits = [](const scene::Material& m) { return glm::any(glm::greaterThan(m.emissive, vec3(0.0f))); };
  if (!emits(a) && !emits(b)) return a.unlit != b.unlit;
  return !(a.emissive == b.emissive && a.emissiveTexture == b.emissiveTexture && a.unlit == b.unlit &&
           a.doubleSided == b.doubleSided && a.alphaMode == b.alphaMode && a.baseColor.a == b.baseColor.a &&
           a.baseColorTexture == b.baseColorTexture && a.alphaCutoff == b.alphaCutoff);
}

// What shaders and acceleration structures were made for.
struct DeviceForm {
  render::SceneFeatures features;
  program::SceneFacts facts;
  bool operator==(const DeviceForm&) const = default;
};

DeviceForm deviceForm(const scene::Scene& scene) {
  // Materials do not affect what depends on the environment.
  return {render::sceneFeatures(scene, scene::Environment{}), check::sceneFacts(scene)};
}

}  // namespace

scene::Scene& RenderJob::editedScene() {
  assert(job_.request.editable && job_.scene.loaded);
  if (!editedScene_) editedScene_ = std::make_shared<scene::Scene>(*job_.scene.loaded);
  return *editedScene_;
}

void RenderJob::restart() {
  if (!renderer_) return;  // applyEdits() failed and is repeated by the next run()
  renderer_->restart();
  if (prints_) prints_->restart();
  start_ = {};
  started_ = false;
  nextFrame_ = 0;
}

void RenderJob::setCamera(const CameraRequest& camera) {
  const uvec2 size = scene_ ? scene_->size : job_.request.size;
  const float aspect = size.y > 0 ? static_cast<float>(size.x) / static_cast<float>(size.y) : 0.0f;
  CameraChoice chosen = chooseCamera(editedScene(), camera, aspect);
  job_.request.camera = camera;
  if (!renderer_) return;  // applyEdits() failed and is repeated by the next run()
  scene_->camera = chosen.camera;
  scene_->cameraDescription = std::move(chosen.description);
  restart();
  renderer_->setCamera(scene_->camera);
  provenance_ = makeProvenance();
}

void RenderJob::setParameters(const std::vector<std::string>& assignments) {
  RenderRequest request;
  request.parameterFile = job_.request.parameterFile;
  request.assignments = assignments;
  program::ParameterValues values = parameterValues(job_.program, request);
  if (renderer_) renderer_->setParameters(values);
  job_.parameters = std::move(values);
  job_.request.assignments = assignments;
  restart();
  if (renderer_) provenance_ = makeProvenance();
}

void RenderJob::setTransform(std::size_t instance, const mat4& worldFromObject) {
  scene::Scene& scene = editedScene();
  if (instance >= scene.instances.size())
    throw UsageError(fmt::format("instance {} does not exist; the scene has {}", instance, scene.instances.size()));
  scene::Instance& edited = scene.instances[instance];
  if (!edited.keyframes.empty())
    throw UsageError(fmt::format("instance {} is animated by keyframes, which set its transform", instance));
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
  } catch (const Error& error) {
    scene.materials[index] = before;
    throw UsageError(error.what());
  }
  sceneEdited_ = true;
  restart();
  const bool newTangents = scene::addTangents(scene, index);
  sceneOutdated_ = sceneOutdated_ || newTangents || emissionDiffers(before, material) || deviceForm(scene) != form ||
                   !scene_->onDevice->setMaterial(index, material);  // last, because it changes the device
}

void RenderJob::setFrame(float frame) {
  if (job_.accumulatesFrames())
    throw UsageError(fmt::format("the program '{}' counts its frames itself", job_.program.name));
  if (!std::isfinite(frame)) throw UsageError(fmt::format("frame {} is not finite", frame));
  frame_ = frame;
  frameOutdated_ = true;
  restart();
}

void RenderJob::applyEdits(Observer& observer) {
  if (sceneOutdated_) {
    job_.scene.loaded = editedScene_;
    renderer_.reset();
    scene_.reset();
    prepare(observer);
    frameOutdated_ = true;  // a new scene shows frame 0
  } else if (!movedInstances_.empty()) {
    std::vector<render::InstanceTransform> transforms;
    for (const auto& [instance, worldFromObject] : movedInstances_) transforms.push_back({instance, worldFromObject});
    scene_->onDevice->setTransforms(transforms);
    renderer_->sceneChanged();
  }
  if (sceneEdited_) scene_->hash = scene::contentHash(*editedScene_).hex();
  if (frameOutdated_)
    showFrame();
  else if (sceneEdited_)
    provenance_ = makeProvenance();
  sceneOutdated_ = sceneEdited_ = frameOutdated_ = false;
  movedInstances_.clear();
}

}  // namespace quintet::job

// SPDX-License-Identifier: Apache-2.0
#include "render/scene/top_level.h"

#include <algorithm>
#include <cassert>

#include "scene/animation/keyframes.h"

namespace quintet::render {
namespace {

void storeTransform(shared::InstanceData& data, const mat4& worldFromObject) {
  const mat4 forward = glm::transpose(worldFromObject);
  const mat4 backward = glm::transpose(glm::inverse(worldFromObject));
  for (int i = 0; i < 3; ++i) {
    data.worldFromObject[i] = forward[i];
    data.objectFromWorld[i] = backward[i];
  }
  data.flags &= ~shared::kInstanceMirrored;
  if (glm::determinant(mat3(worldFromObject)) < 0.0f) data.flags |= shared::kInstanceMirrored;
}

}  // namespace

TopLevel::TopLevel(gpu::Context& context, const scene::Scene& scene, std::span<const InstanceReferences> references,
                   std::size_t maxClusters)
    : context_(context) {
  const scene::Pose pose = scene::poseAt(scene.nodeAnimation.get(), 0.0);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Instance& instance = scene.instances[i];
    const mat4 worldFromObject = scene::shownTransformAt(instance, pose);
    if (instance.animated()) {
      moving_.push_back(instance);
      before_.push_back(scene::worldFromObjectAt(instance, pose));
      movingIndex_.push_back(static_cast<std::uint32_t>(i));
    }
    shared::InstanceData& data = data_.emplace_back();
    data.firstGeometry = references[i].firstGeometry;
    data.firstLightSlot = references[i].firstLightSlot;
    data.customIndex = instance.customIndex;
    data.flags = (instance.flags & scene::kInstanceForceOpaque) != 0 ? shared::kInstanceOpaque : 0;
    storeTransform(data, worldFromObject);
    rt::InstanceInput& input = inputs_.emplace_back();
    input.worldFromObject = worldFromObject;
    input.blas = references[i].blas;
    input.customIndex = static_cast<std::uint32_t>(i);
    input.mask = instance.mask;
    input.flags = instance.flags;
  }
  data_.resize(inputs_.size() + maxClusters);
  table_ = gpu::makeBufferOf(context, data_, 0, "instances");
  if (animated()) previousTable_ = gpu::makeBufferOf(context, data_, 0, "instances before");
}

bool TopLevel::prepareFor(std::uint32_t rayTypeCount, bool keepOrder, bool anyHitForAll, bool merge) {
  if (tlas_ && rayTypeCount == rayTypeCount_ && keepOrder == keepOrder_ && anyHitForAll == anyHitForAll_ &&
      merge == merge_)
    return false;
  merge_ = merge;
  rayTypeCount_ = rayTypeCount;
  anyHitForAll_ = anyHitForAll;
  keepOrder_ = keepOrder;
  build();
  return true;
}

void TopLevel::setMerged(std::span<const MergedCluster> clusters) {
  assert(mergedInputs_.empty() && inputs_.size() + clusters.size() <= data_.size());
  inCluster_.assign(inputs_.size(), false);
  for (const MergedCluster& cluster : clusters) {
    for (const std::uint32_t instance : cluster.instances) inCluster_[instance] = true;
    const std::uint32_t first = cluster.instances.front();
    rt::InstanceInput input = inputs_[first];
    input.blas = cluster.blas;
    input.customIndex = static_cast<std::uint32_t>(inputs_.size() + mergedInputs_.size());
    shared::InstanceData& data = data_[input.customIndex];
    data = data_[first];
    data.firstGeometry = static_cast<std::uint32_t>(cluster.indices);
    data.firstLightSlot = static_cast<std::uint32_t>(cluster.indices >> 32);
    data.flags |= shared::kInstanceMerged;
    mergedGeometry_.push_back(data_[first].firstGeometry);
    mergedInputs_.push_back(input);
  }
  table_.upload(std::as_bytes(std::span(data_)));
}

void TopLevel::setPose(const scene::Pose& pose, const scene::Pose& before) {
  for (std::size_t k = 0; k < moving_.size(); ++k) {
    setTransform(movingIndex_[k], scene::shownTransformAt(moving_[k], pose));
    before_[k] = scene::worldFromObjectAt(moving_[k], before);
  }
  update();
}

void TopLevel::setTransform(std::size_t instance, const mat4& worldFromObject) {
  storeTransform(data_[instance], worldFromObject);
  inputs_[instance].worldFromObject = worldFromObject;
}

void TopLevel::update() {
  table_.upload(std::as_bytes(std::span(data_)));
  if (animated()) {
    std::vector<shared::InstanceData> before = data_;
    for (std::size_t k = 0; k < moving_.size(); ++k) storeTransform(before[movingIndex_[k]], before_[k]);
    previousTable_.upload(std::as_bytes(std::span(before)));
  }
  if (tlas_) build();
}

std::vector<mat4> TopLevel::worldFromObject() const {
  std::vector<mat4> result;
  for (const rt::InstanceInput& input : inputs_) result.push_back(input.worldFromObject);
  return result;
}

void TopLevel::build() {
  for (std::size_t i = 0; i < inputs_.size(); ++i) inputs_[i].recordOffset = data_[i].firstGeometry * rayTypeCount_;
  if (!tlas_) tlas_ = std::make_unique<rt::Tlas>(context_, static_cast<std::uint32_t>(inputs_.size()));
  tlas_->keepInputOrder(keepOrder_);
  std::vector<rt::InstanceInput> inputs;
  for (std::size_t i = 0; i < inputs_.size(); ++i)
    if (!merge_ || inCluster_.empty() || !inCluster_[i]) inputs.push_back(inputs_[i]);
  for (std::size_t k = 0; merge_ && k < mergedInputs_.size(); ++k) {
    mergedInputs_[k].recordOffset = mergedGeometry_[k] * rayTypeCount_;
    inputs.push_back(mergedInputs_[k]);
  }
  for (rt::InstanceInput& input : inputs)
    if (anyHitForAll_ && (input.flags & scene::kInstanceForceOpaque) == 0) input.flags |= scene::kInstanceForceNoOpaque;
  tlas_->buildAndWait(inputs);
}

}  // namespace quintet::render

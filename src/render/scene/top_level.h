// SPDX-License-Identifier: Apache-2.0
// The instances of a scene on the device: the instance table, which shaders index by gl_InstanceCustomIndexEXT, and the
// top-level acceleration structure. It is rebuilt for a different number of ray types, order, or frame of the
// animation.
#ifndef QUINTET_RENDER_SCENE_TOP_LEVEL_H
#define QUINTET_RENDER_SCENE_TOP_LEVEL_H

#include <memory>
#include <span>
#include <vector>

#include "quintet/shared/frame.h"
#include "rt/tlas.h"
#include "scene/animation/pose.h"
#include "scene/model/scene.h"

namespace quintet::render {

// The parts of a scene's arrays that an instance refers to.
struct InstanceReferences {
  const rt::Blas* blas = nullptr;
  std::uint32_t firstGeometry = 0;
  std::uint32_t firstLightSlot = 0;
};

// Instances with the same transform, mask and flags that one BLAS contains.
struct MergedCluster {
  const rt::Blas* blas = nullptr;
  shared::Address indices = 0;           // shared::kInstanceMerged
  std::vector<std::uint32_t> instances;  // ascending
};

class TopLevel {
 public:
  // `references` has one entry per instance. `scene` is used during construction only. Starts at frame 0.
  // `maxClusters`: of setMerged().
  TopLevel(gpu::Context& context, const scene::Scene& scene, std::span<const InstanceReferences> references,
           std::size_t maxClusters = 0);

  shared::Address table() const { return table_.address(); }  // shared::InstanceData[]; the same for all frames
  // Returns the table of the frame before the current one; at frame 0, of frame 0. 0 if no instance is animated.
  shared::Address previousTable() const { return animated() ? previousTable_.address() : 0; }
  std::vector<mat4> worldFromObject() const;  // transforms of the instances at the current frame
  bool animated() const { return !moving_.empty(); }

  // Builds the structure so that the hit record of geometry k and ray type r is k · rayTypeCount + r. keepOrder makes
  // gl_InstanceID the instance's index in the scene. With anyHitForAll only instances that are forced to be opaque are
  // opaque. With `merge` the clusters of setMerged() replace their instances. Blocks. Returns false if the structure
  // already fits.
  bool prepareFor(std::uint32_t rayTypeCount, bool keepOrder, bool anyHitForAll, bool merge = false);
  // Adds the clusters to the instance table, after the instances of the scene; once. Blocks. The BLASes must outlive this.
  void setMerged(std::span<const MergedCluster> clusters);
  // Moves an instance to a transform, which must be affine and invertible; update() uploads it. One that is not
  // animated was there in the previous frame, too.
  void setTransform(std::size_t instance, const mat4& worldFromObject);
  // Uploads the instance tables and rebuilds the structure. Blocks; the device must not be tracing.
  void update();
  // Moves the animated instances, and rebuilds the structure over BLASes that may have changed. `before`: one frame
  // earlier. Blocks; the device must not be tracing.
  void setPose(const scene::Pose& pose, const scene::Pose& before);

  const rt::Tlas& structure() const { return *tlas_; }  // after prepareFor

 private:
  void build();

  gpu::Context& context_;
  std::vector<scene::Instance> moving_;     // animated instances
  std::vector<std::uint32_t> movingIndex_;  // their indices in the scene
  std::vector<mat4> before_;                // their transforms one frame earlier
  std::vector<shared::InstanceData> data_;
  std::vector<rt::InstanceInput> inputs_;
  std::vector<rt::InstanceInput> mergedInputs_;  // of the clusters; entries of the table after those of inputs_
  std::vector<std::uint32_t> mergedGeometry_;    // per cluster: a geometry with the hit records of all
  std::vector<bool> inCluster_;                  // per instance, if there are clusters
  gpu::Buffer table_, previousTable_;
  std::unique_ptr<rt::Tlas> tlas_;
  std::uint32_t rayTypeCount_ = 0;
  bool keepOrder_ = false;
  bool anyHitForAll_ = false;
  bool merge_ = false;
};

}  // namespace quintet::render
#endif

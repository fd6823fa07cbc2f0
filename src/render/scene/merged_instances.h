// SPDX-License-Identifier: Apache-2.0
// Acceleration structures that contain several instances of a scene. They serve drivers that traverse in software
// (docs/design/quirks.md), where a ray is slow if it enters the trees of several meshes that fill the same space.
// Hits have the same values as without merging, because all instances of a cluster have the same transform. Only
// programs that identify triangles by triangleHit() can use them (program::Program::mergesInstances).
#ifndef QUINTET_RENDER_SCENE_MERGED_INSTANCES_H
#define QUINTET_RENDER_SCENE_MERGED_INSTANCES_H

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "gpu/buffer.h"
#include "render/scene/geometry_upload.h"
#include "render/scene/top_level.h"
#include "rt/blas_builder.h"

namespace quintet::render {

// An instance that does not move, with opaque triangles only, the default mask and no flags.
struct MergeCandidate {
  std::uint32_t instance = 0;       // index in the scene
  std::uint32_t firstGeometry = 0;  // of its mesh, in the order of hit records
  std::uint32_t geometryCount = 0;
  mat4 worldFromObject{1.0f};
};

class MergedInstances {
 public:
  // Decides which candidates are merged (rt/merge_clusters.h), and builds. `arrays`: per geometry. Scenes with more than a
  // million triangles in candidates are not merged, because the separate structures stay in memory for other programs.
  // Blocks.
  MergedInstances(gpu::Context& context, std::span<const MergeCandidate> candidates,
                  std::span<const GeometryArrays> arrays, rt::BuildStatistics* statistics = nullptr);

  std::span<const MergedCluster> clusters() const { return clusters_; }
  std::uint32_t instanceCount() const;  // of all clusters
  std::uint64_t bytes() const;          // of the acceleration structures

 private:
  std::vector<rt::Blas> blas_;
  std::deque<gpu::Buffer> indices_;
  std::vector<MergedCluster> clusters_;
};

}  // namespace quintet::render
#endif

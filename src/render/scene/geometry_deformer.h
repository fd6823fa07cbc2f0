// SPDX-License-Identifier: Apache-2.0
// Deforms the vertices of one geometry on the device, by morph targets and a skin (shaders/quintet/passes/deform_*.glsl).
// scene::deformGeometry() is the reference.
#ifndef QUINTET_RENDER_SCENE_GEOMETRY_DEFORMER_H
#define QUINTET_RENDER_SCENE_GEOMETRY_DEFORMER_H

#include <memory>
#include <span>

#include "gpu/compute.h"
#include "gpu/uploader.h"
#include "quintet/shared/deform.h"
#include "quintet/shared/frame.h"
#include "scene/model/animation.h"
#include "shader/compiler.h"

namespace quintet::render {

// The pipelines of all geometries.
struct DeformPasses {
  DeformPasses(gpu::Context& context, const gpu::BindlessSet& set, const shader::Compiler& compiler);
  std::unique_ptr<gpu::ComputePipeline> winding, vertices, repair;
};

// Where the values of the frame are on the device.
struct PoseAddresses {
  shared::Address weights = 0;   // float[], one per morph target
  shared::Address matrices = 0;  // shared::DeformMatrix[]; 0 means that no matrix applies
};

class GeometryDeformer {
 public:
  // Uploads the undeformed attributes, morph targets and skin sets. `target`: the geometry whose arrays are written.
  // `triangles`: its triangles on the host. The data are on the device after uploader.flush().
  GeometryDeformer(gpu::Context& context, gpu::Uploader& uploader, const scene::GeometryDeformation& deformation,
                   std::span<const uvec3> triangles, const shared::GeometryData& target, const PoseAddresses& pose);

  // Records the pass that turns the triangles of mirrored parts, if a matrix applies. The BLAS must then be built again.
  void recordWinding(gpu::Commands& commands, const DeformPasses& passes) const;
  // Records the first pass of the vertices: positions, and normals and tangents as far as they have a direction.
  void recordVertices(gpu::Commands& commands, const DeformPasses& passes) const;
  // Records the second pass, after a barrier of the stage compute.
  void recordRepair(gpu::Commands& commands, const DeformPasses& passes) const;
  VkDeviceSize bytes() const { return arrays_.size(); }  // of device memory

 private:
  gpu::Buffer arrays_;
  shared::DeformPass pass_{};
  std::uint32_t vertexCount_ = 0;
  std::uint32_t triangleCount_ = 0;
  bool hasNormals_ = false;
  bool hasMatrices_ = false;
};

}  // namespace quintet::render
#endif

// SPDX-License-Identifier: Apache-2.0
// The meshes that an animation deforms. Compute passes write their vertices at each frame into the buffers that shaders
// and BLASes read; only joint matrices and morph weights come from the host. The BLASes are refitted, or built again if
// the tree has become bad (rt/refit_quality.h). scene::deformGeometry() is the reference of the vertices.
#ifndef QUINTET_RENDER_SCENE_DEFORMED_MESHES_H
#define QUINTET_RENDER_SCENE_DEFORMED_MESHES_H

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "gpu/timer.h"
#include "render/scene/geometry_deformer.h"
#include "render/scene/geometry_upload.h"
#include "render/scene/tree_cost.h"
#include "rt/blas_builder.h"
#include "rt/blas_refit.h"
#include "scene/animation/pose.h"

namespace quintet::render {

// Sums over all frames after the first one. Device times are 0 for devices without timestamps.
struct DeformationStatistics {
  double poseSeconds = 0;    // joint matrices and weights, on the host
  double deformSeconds = 0;  // vertices, on the device
  double costSeconds = 0;    // quality of the trees, on the device
  double refitSeconds = 0;   // on the device
  double buildSeconds = 0;   // builds of trees that have decayed, wall-clock time
  std::uint64_t refits = 0;  // frames · meshes, without those that were built again
  std::uint64_t builds = 0;
};

class DeformedMeshes {
 public:
  // Compiles the passes. `set` must exist as long as this object.
  DeformedMeshes(gpu::Context& context, const gpu::BindlessSet& set, const shader::Compiler& compiler);

  // Adds a mesh of the scene that has a deformation, after its BLAS was built from `input` with allowUpdate. Copies
  // what it needs to the device. `pose`: that of the scene. A mesh without triangles is not added. `blas` and `upload`
  // must exist as long as this object.
  void add(const scene::Scene& scene, std::size_t mesh, const scene::Pose& pose, const rt::BlasInput& input,
           rt::Blas& blas, GeometryUpload& upload);

  // Deforms all meshes and updates their BLASes. Blocks; the device must not be tracing. Calls `rebuilt` with the index
  // in the scene of each mesh whose BLAS was built again: its address and its primitive maps have changed.
  void setPose(const scene::NodeAnimation& animation, const scene::Pose& pose,
               const std::function<void(std::size_t mesh)>& rebuilt);
  // Calls visit(mesh, geometry, positions) for each geometry for which wanted(mesh, geometry) is true. Blocks: reads the
  // positions from the device.
  using Wanted = std::function<bool(std::size_t mesh, std::size_t geometry)>;
  using Visit = std::function<void(std::size_t mesh, std::size_t geometry, std::span<const vec3> positions)>;
  void forPositions(const Wanted& wanted, const Visit& visit) const;

  const DeformationStatistics& statistics() const { return statistics_; }

 private:
  // The joint matrices and morph weights of a mesh: written by the host into `staging`, then copied.
  struct PoseBuffer {
    gpu::Buffer staging, device;
    std::size_t weightOffset = 0;  // bytes; the matrices are first
    std::size_t weightCount = 0;
  };
  struct Mesh {
    std::size_t index;    // in the scene
    int node, skin;       // of the deformation
    rt::BlasInput input;  // with addresses; the host arrays are set for builds only
    rt::Blas* blas;
    GeometryUpload* upload;
    PoseBuffer pose;
    std::vector<bool> mirrored;  // per matrix: it mirrors, and the triangles in memory are wound for that
    bool turns = false;          // the frame to be shown changes `mirrored`, so that triangles change their winding
    std::vector<GeometryDeformer> geometries;
    rt::BlasRefit refit;
    TreeCost cost;
  };
  static PoseBuffer makePoseBuffer(gpu::Context& context, const scene::MeshDeformation& mesh, std::size_t jointCount);
  static void writePose(Mesh& mesh, const scene::NodeAnimation& animation, const scene::Pose& pose);
  void prepareUpdates(Mesh& mesh);
  void record(gpu::Commands& commands);
  void recordCosts(gpu::Commands& commands) const;
  void build(Mesh& mesh);

  gpu::Context& context_;
  DeformPasses passes_;
  std::unique_ptr<gpu::ComputePipeline> costPass_;
  std::vector<Mesh> meshes_;
  gpu::Buffer roots_;  // shared::TreeCostNode per mesh, of the frame
  gpu::Timer timer_;
  DeformationStatistics statistics_;
};

}  // namespace quintet::render
#endif

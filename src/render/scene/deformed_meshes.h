// SPDX-License-Identifier: Apache-2.0
// The meshes that an animation deforms: their vertices at each frame, on the host (scene::deformGeometry) and on the
// device, and their BLASes, which are refitted, or built again if the tree has become bad (rt/refit_quality.h).
#ifndef QUINTET_RENDER_SCENE_DEFORMED_MESHES_H
#define QUINTET_RENDER_SCENE_DEFORMED_MESHES_H

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "render/scene/geometry_upload.h"
#include "rt/blas_builder.h"
#include "rt/refit_quality.h"
#include "scene/animation/pose.h"

namespace quintet::render {

// Sums over all frames after the first one.
struct DeformationStatistics {
  double deformSeconds = 0;  // on the host
  double uploadSeconds = 0;
  double buildSeconds = 0;  // refits and builds
  std::uint64_t refits = 0;
  std::uint64_t builds = 0;
};

class DeformedMeshes {
 public:
  explicit DeformedMeshes(gpu::Context& context) : context_(context) {}

  // Adds a mesh of the scene that has a deformation, after its BLAS was built from `input` with allowUpdate. Copies
  // what it needs of the mesh. `blas` and `upload` must exist as long as this object.
  void add(const scene::Scene& scene, std::size_t mesh, const rt::BlasInput& input, rt::Blas& blas,
           GeometryUpload& upload);
  bool empty() const { return meshes_.empty(); }

  // Deforms all meshes, uploads their vertices and updates their BLASes. Blocks; the device must not be tracing. Calls
  // `rebuilt` with the index in the scene of each mesh whose BLAS was built again: its address and its primitive maps
  // have changed.
  void setPose(const scene::NodeAnimation& animation, const scene::Pose& pose,
               const std::function<void(std::size_t mesh)>& rebuilt);
  // Calls visit(mesh, geometry, positions) for each geometry.
  using Visit = std::function<void(std::size_t mesh, std::size_t geometry, std::span<const vec3> positions)>;
  void forPositions(const Visit& visit) const;

  const DeformationStatistics& statistics() const { return statistics_; }

 private:
  struct Mesh {
    Mesh(const scene::Scene& scene, std::size_t indexInScene, const rt::BlasInput& built, rt::Blas& blasOfMesh,
         GeometryUpload& uploaded);
    std::size_t index;  // in the scene
    std::shared_ptr<const scene::MeshDeformation> deformation;
    std::vector<scene::Geometry> geometries;  // with the arrays of the current pose, and triangles
    rt::BlasInput input;                      // refers to `geometries`
    rt::Blas* blas;
    GeometryUpload* upload;
    rt::RefitQuality quality;
  };
  void upload(const Mesh& mesh, gpu::Uploader& uploader) const;
  bool updateBlas(Mesh& mesh);  // returns whether it was built again

  gpu::Context& context_;
  std::vector<std::unique_ptr<Mesh>> meshes_;  // do not move, because of `input`
  DeformationStatistics statistics_;
};

}  // namespace quintet::render
#endif

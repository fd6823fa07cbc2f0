// SPDX-License-Identifier: Apache-2.0
#include "render/scene/deformed_meshes.h"

#include <algorithm>
#include <utility>

#include "base/stopwatch.h"

namespace quintet::render {
namespace {

constexpr VkDeviceSize kStagingBytes = VkDeviceSize{32} << 20;

// The arrays of `geometries` instead of those that the BLAS was built from.
rt::BlasInput withArrays(rt::BlasInput input, const std::vector<scene::Geometry>& geometries) {
  for (std::size_t g = 0; g < geometries.size(); ++g) {
    input.geometries[g].positions = geometries[g].positions;
    input.geometries[g].triangles = geometries[g].triangles;
  }
  return input;
}

}  // namespace

DeformedMeshes::Mesh::Mesh(const scene::Scene& scene, std::size_t indexInScene, const rt::BlasInput& built,
                           rt::Blas& blasOfMesh, GeometryUpload& uploaded)
    : index(indexInScene),
      deformation(scene.meshes[indexInScene].deformation),
      blas(&blasOfMesh),
      upload(&uploaded),
      quality(built) {
  for (const rt::GeometryInput& from : built.geometries) {
    scene::Geometry& geometry = geometries.emplace_back();
    geometry.positions.assign(from.positions.begin(), from.positions.end());
    geometry.triangles.assign(from.triangles.begin(), from.triangles.end());
  }
  input = withArrays(built, geometries);
}

void DeformedMeshes::add(const scene::Scene& scene, std::size_t index, const rt::BlasInput& input, rt::Blas& blas,
                         GeometryUpload& upload) {
  meshes_.push_back(std::make_unique<Mesh>(scene, index, input, blas, upload));
}

void DeformedMeshes::upload(const Mesh& mesh, gpu::Uploader& uploader) const {
  const std::size_t first = mesh.upload->firstGeometry[mesh.index];
  for (std::size_t g = 0; g < mesh.geometries.size(); ++g) {
    const scene::Geometry& geometry = mesh.geometries[g];
    const GeometrySlots& slots = mesh.upload->slots[first + g];
    replaceArray(*mesh.upload, slots.positions, std::as_bytes(std::span(geometry.positions)), uploader);
    replaceArray(*mesh.upload, slots.normals, std::as_bytes(std::span(geometry.normals)), uploader);
    replaceArray(*mesh.upload, slots.tangents, std::as_bytes(std::span(geometry.tangents)), uploader);
  }
}

bool DeformedMeshes::updateBlas(Mesh& mesh) {
  mesh.input = withArrays(std::move(mesh.input), mesh.geometries);  // vectors can have moved
  rt::BlasBuilder builder(context_);
  if (mesh.quality.growth(mesh.input) <= rt::kMaxRefitGrowth) {
    builder.refit(*mesh.blas, mesh.input);
    ++statistics_.refits;
    return false;
  }
  *mesh.blas = std::move(builder.build({&mesh.input, 1}).front());
  mesh.quality = rt::RefitQuality(mesh.input);
  ++statistics_.builds;
  return true;
}

void DeformedMeshes::setPose(const scene::NodeAnimation& animation, const scene::Pose& pose,
                             const std::function<void(std::size_t mesh)>& rebuilt) {
  if (meshes_.empty()) return;
  Stopwatch watch;
  VkDeviceSize bytes = 0;
  for (const std::unique_ptr<Mesh>& mesh : meshes_)
    for (std::size_t g = 0; g < mesh->geometries.size(); ++g) {
      scene::deformGeometry(*mesh->deformation, g, animation, pose, mesh->geometries[g]);
      bytes += mesh->geometries[g].positions.size() * (2 * sizeof(vec3) + sizeof(vec4));
    }
  statistics_.deformSeconds += watch.lap();
  gpu::Uploader uploader(context_, std::min(2 * bytes, kStagingBytes));
  for (const std::unique_ptr<Mesh>& mesh : meshes_) upload(*mesh, uploader);
  uploader.flush();
  statistics_.uploadSeconds += watch.lap();
  for (const std::unique_ptr<Mesh>& mesh : meshes_)
    if (updateBlas(*mesh)) rebuilt(mesh->index);
  statistics_.buildSeconds += watch.lap();
}

void DeformedMeshes::forPositions(const Visit& visit) const {
  for (const std::unique_ptr<Mesh>& mesh : meshes_)
    for (std::size_t g = 0; g < mesh->geometries.size(); ++g) visit(mesh->index, g, mesh->geometries[g].positions);
}

}  // namespace quintet::render

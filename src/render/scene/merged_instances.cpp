// SPDX-License-Identifier: Apache-2.0
#include "render/scene/merged_instances.h"

#include <algorithm>
#include <cassert>

#include "base/stopwatch.h"
#include "rt/merge_clusters.h"
#include "rt/spatial_order.h"

namespace quintet::render {
namespace {

constexpr std::size_t kMaxTriangles = 1000000;  // of all candidates
constexpr std::size_t kSample = 32768;          // triangles of all candidates that decide

// A triangle of a candidate with its bounds in object space.
struct Triangle {
  uvec3 vertices;  // in MergedMesh::positions
  uvec3 indices;   // instance, geometry, primitive
  Bounds3 bounds;
};

// The triangles of several candidates.
struct MergedMesh {
  std::vector<vec3> positions;
  std::vector<uvec3> triangles;
  std::vector<uvec3> indices;  // parallel to `triangles`
};

std::span<const GeometryArrays> geometriesOf(const MergeCandidate& candidate, std::span<const GeometryArrays> arrays) {
  return arrays.subspan(candidate.firstGeometry, candidate.geometryCount);
}

Bounds3 boundsOf(const GeometryArrays& arrays, const uvec3& triangle) {
  Bounds3 bounds;
  for (glm::length_t k = 0; k < 3; ++k) bounds.extend(arrays.positions[triangle[k]]);
  return bounds;
}

bool isFiniteTriangle(const GeometryArrays& arrays, const uvec3& triangle) {
  return isFinite(arrays.positions[triangle.x]) && isFinite(arrays.positions[triangle.y]) &&
         isFinite(arrays.positions[triangle.z]);
}

// Every `stride`-th triangle.
std::vector<Bounds3> sampleOf(std::span<const GeometryArrays> geometries, std::size_t stride) {
  std::vector<Bounds3> sample;
  for (const GeometryArrays& arrays : geometries)
    for (std::size_t i = 0; i < arrays.triangles.size(); i += stride)
      if (isFiniteTriangle(arrays, arrays.triangles[i])) sample.push_back(boundsOf(arrays, arrays.triangles[i]));
  return sample;
}

// Copies the finite triangles in the spatial order.
MergedMesh merge(std::span<const MergeCandidate* const> members, std::span<const GeometryArrays> arrays) {
  MergedMesh mesh;
  std::vector<Triangle> triangles;
  for (const MergeCandidate* member : members) {
    std::uint32_t g = 0;
    for (const GeometryArrays& geometry : geometriesOf(*member, arrays)) {
      const auto base = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.insert(mesh.positions.end(), geometry.positions.begin(), geometry.positions.end());
      for (std::size_t i = 0; i < geometry.triangles.size(); ++i) {
        const uvec3& triangle = geometry.triangles[i];
        if (isFiniteTriangle(geometry, triangle))
          triangles.push_back({triangle + base, uvec3(member->instance, g, static_cast<std::uint32_t>(i)),
                               boundsOf(geometry, triangle)});
      }
      ++g;
    }
  }
  std::vector<Bounds3> bounds;
  for (const Triangle& triangle : triangles) bounds.push_back(triangle.bounds);
  for (const std::uint32_t k : rt::spatialOrder(bounds)) {
    mesh.triangles.push_back(triangles[k].vertices);
    mesh.indices.push_back(triangles[k].indices);
  }
  return mesh;
}

bool beforeByTransform(const MergeCandidate* a, const MergeCandidate* b) {
  for (glm::length_t column = 0; column < 4; ++column)
    for (glm::length_t row = 0; row < 4; ++row)
      if (a->worldFromObject[column][row] != b->worldFromObject[column][row])
        return a->worldFromObject[column][row] < b->worldFromObject[column][row];
  return false;
}

// The candidates by their transforms, because merging keeps object space; in the order of the scene within a group.
std::vector<std::vector<const MergeCandidate*>> byTransform(std::span<const MergeCandidate> candidates) {
  std::vector<const MergeCandidate*> sorted;
  for (const MergeCandidate& candidate : candidates)
    if (isFinite(candidate.worldFromObject)) sorted.push_back(&candidate);
  std::ranges::stable_sort(sorted, beforeByTransform);
  std::vector<std::vector<const MergeCandidate*>> groups;
  for (const MergeCandidate* candidate : sorted) {
    if (groups.empty() || beforeByTransform(groups.back().front(), candidate)) groups.emplace_back();
    groups.back().push_back(candidate);
  }
  return groups;
}

}  // namespace

MergedInstances::MergedInstances(gpu::Context& context, std::span<const MergeCandidate> candidates,
                                 std::span<const GeometryArrays> arrays, rt::BuildStatistics* statistics) {
  const Stopwatch watch;
  std::size_t total = 0;
  for (const MergeCandidate& candidate : candidates)
    for (const GeometryArrays& geometry : geometriesOf(candidate, arrays)) total += geometry.triangles.size();
  if (total > kMaxTriangles) return;
  const rt::TreeBuilder builder =
      context.info().quirks.keepsPrimitiveOrder ? rt::TreeBuilder::halving : rt::TreeBuilder::surfaceArea;
  std::vector<MergedMesh> meshes;
  for (const std::vector<const MergeCandidate*>& group : byTransform(candidates)) {
    if (group.size() < 2) continue;
    std::vector<std::vector<Bounds3>> samples;
    for (const MergeCandidate* candidate : group)
      samples.push_back(sampleOf(geometriesOf(*candidate, arrays), std::max<std::size_t>(total / kSample, 1)));
    for (const std::vector<std::uint32_t>& cluster : rt::mergeClusters(samples, builder)) {
      std::vector<const MergeCandidate*> members;
      MergedCluster& merged = clusters_.emplace_back();
      for (const std::uint32_t k : cluster) {
        members.push_back(group[k]);
        merged.instances.push_back(group[k]->instance);
      }
      meshes.push_back(merge(members, arrays));
    }
  }
  std::vector<rt::BlasInput> inputs;
  for (const MergedMesh& mesh : meshes) {
    rt::BlasInput& input = inputs.emplace_back();
    input.options.name = "merged instances";
    input.options.keepInputOrder = true;  // it is the spatial one
    input.geometries.push_back({.positions = mesh.positions, .triangles = mesh.triangles});
  }
  if (statistics) statistics->orderSeconds += watch.seconds();
  const Stopwatch buildWatch;
  blas_ = rt::BlasBuilder(context).build(inputs);
  for (std::size_t k = 0; k < blas_.size(); ++k) {
    assert(blas_[k].primitiveMap(0) == 0);
    indices_.push_back(gpu::makeBufferOf(context, meshes[k].indices, 0, "merged instances"));
    clusters_[k].blas = &blas_[k];
    clusters_[k].indices = indices_.back().address();
  }
  if (statistics) statistics->buildSeconds += buildWatch.seconds();
}

std::uint32_t MergedInstances::instanceCount() const {
  std::uint32_t count = 0;
  for (const MergedCluster& cluster : clusters_) count += static_cast<std::uint32_t>(cluster.instances.size());
  return count;
}

std::uint64_t MergedInstances::bytes() const {
  std::uint64_t bytes = 0;
  for (const rt::Blas& blas : blas_) bytes += blas.size();
  return bytes;
}

}  // namespace quintet::render

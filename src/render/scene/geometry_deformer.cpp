// SPDX-License-Identifier: Apache-2.0
#include "render/scene/geometry_deformer.h"

#include <map>
#include <vector>

#include "quintet/shared/frame.h"
#include "render/compute_pass.h"

namespace quintet::render {

static_assert(sizeof(shared::DeformPass) <= shared::kPushConstantBytes);
namespace {

constexpr VkDeviceSize kArrayAlignment = 16;

// Arrays of one buffer. First all arrays are added, then the buffer is created; then addresses are known, which other
// arrays can contain; then all are uploaded.
class PackedArrays {
 public:
  // `values` must exist, and keep its size, until upload().
  template <class T>
  void add(const std::vector<T>& values) {
    if (values.empty()) return;
    offsets_[values.data()] = size_;
    arrays_.push_back(std::as_bytes(std::span(values)));
    size_ += (arrays_.back().size() + kArrayAlignment - 1) / kArrayAlignment * kArrayAlignment;
  }
  void create(gpu::Context& context) {
    buffer_ = gpu::Buffer(context, {.size = size_,
                                    .alignment = kArrayAlignment,
                                    .name = "undeformed vertices",
                                    .purpose = gpu::Purpose::geometry});
  }
  // 0 for an empty array.
  template <class T>
  shared::Address addressOf(const std::vector<T>& values) const {
    return values.empty() ? 0 : buffer_.address() + offsets_.at(values.data());
  }
  gpu::Buffer upload(gpu::Uploader& uploader) {
    for (const std::span<const std::byte> array : arrays_) uploader.upload(buffer_, array, offsets_.at(array.data()));
    return std::move(buffer_);
  }

 private:
  std::map<const void*, VkDeviceSize> offsets_;
  std::vector<std::span<const std::byte>> arrays_;
  VkDeviceSize size_ = 0;
  gpu::Buffer buffer_;
};

// The triangles around each vertex, ascending.
struct Corners {
  std::vector<std::uint32_t> first;      // per vertex, and the end of the last one
  std::vector<std::uint32_t> triangles;  // three per triangle
};

Corners cornersOf(std::span<const uvec3> triangles, std::size_t vertexCount) {
  Corners corners;
  corners.first.assign(vertexCount + 1, 0);
  for (const uvec3& triangle : triangles)
    for (glm::length_t c = 0; c < 3; ++c) ++corners.first[triangle[c] + std::size_t{1}];
  for (std::size_t i = 0; i < vertexCount; ++i) corners.first[i + 1] += corners.first[i];
  corners.triangles.resize(3 * triangles.size());
  std::vector<std::uint32_t> next(corners.first.begin(), corners.first.end() - 1);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (glm::length_t c = 0; c < 3; ++c) corners.triangles[next[triangles[t][c]]++] = static_cast<std::uint32_t>(t);
  return corners;
}

}  // namespace

DeformPasses::DeformPasses(gpu::Context& context, const gpu::BindlessSet& set, const shader::Compiler& compiler)
    : winding(makePass(context, set, compiler, "deform_winding")),
      vertices(makePass(context, set, compiler, "deform_vertices")),
      repair(makePass(context, set, compiler, "deform_repair")) {}

GeometryDeformer::GeometryDeformer(gpu::Context& context, gpu::Uploader& uploader,
                                   const scene::GeometryDeformation& deformation, std::span<const uvec3> triangles,
                                   const shared::GeometryData& target, const PoseAddresses& pose)
    : vertexCount_(static_cast<std::uint32_t>(deformation.positions.size())),
      triangleCount_(static_cast<std::uint32_t>(triangles.size())),
      hasNormals_(!deformation.normals.empty()),
      hasMatrices_(pose.matrices != 0) {
  Corners corners;
  if (hasNormals_) corners = cornersOf(triangles, deformation.positions.size());
  std::vector<shared::DeformTarget> targets(deformation.targets.size());
  std::vector<shared::DeformSkinSet> skinSets(deformation.skinSets.size());
  std::vector<shared::DeformGeometry> geometry(1);

  PackedArrays arrays;
  const auto addAll = [&](const auto&... values) { (arrays.add(values), ...); };
  addAll(geometry, targets, skinSets, corners.first, corners.triangles);
  addAll(deformation.positions, deformation.normals, deformation.tangents);
  for (const scene::MorphTarget& from : deformation.targets) addAll(from.positions, from.normals, from.tangents);
  for (const scene::SkinSet& from : deformation.skinSets) addAll(from.joints, from.weights);
  arrays.create(context);

  for (std::size_t i = 0; i < targets.size(); ++i) {
    const scene::MorphTarget& from = deformation.targets[i];
    targets[i] = {arrays.addressOf(from.positions), arrays.addressOf(from.normals), arrays.addressOf(from.tangents)};
  }
  for (std::size_t i = 0; i < skinSets.size(); ++i)
    skinSets[i] = {arrays.addressOf(deformation.skinSets[i].joints), arrays.addressOf(deformation.skinSets[i].weights)};
  geometry[0] = {.positions = arrays.addressOf(deformation.positions),
                 .normals = arrays.addressOf(deformation.normals),
                 .tangents = arrays.addressOf(deformation.tangents),
                 .deformedPositions = target.positions,
                 .deformedNormals = target.normals,
                 .deformedTangents = target.tangents,
                 .targets = arrays.addressOf(targets),
                 .skinSets = arrays.addressOf(skinSets),
                 .triangles = target.triangles,
                 .firstCorners = arrays.addressOf(corners.first),
                 .corners = arrays.addressOf(corners.triangles),
                 .weights = pose.weights,
                 .matrices = pose.matrices,
                 .vertexCount = vertexCount_,
                 .targetCount = static_cast<std::uint32_t>(targets.size()),
                 .skinSetCount = static_cast<std::uint32_t>(skinSets.size()),
                 .flags = deformation.faceNormals ? shared::kDeformFaceNormals : 0,
                 .triangleCount = triangleCount_};
  pass_.geometry = arrays.addressOf(geometry);
  arrays_ = arrays.upload(uploader);
}

void GeometryDeformer::recordWinding(gpu::Commands& commands, const DeformPasses& passes) const {
  if (hasMatrices_) dispatchPass(*passes.winding, commands, std::as_bytes(std::span(&pass_, 1)), triangleCount_);
}

void GeometryDeformer::recordVertices(gpu::Commands& commands, const DeformPasses& passes) const {
  dispatchPass(*passes.vertices, commands, std::as_bytes(std::span(&pass_, 1)), vertexCount_);
}

void GeometryDeformer::recordRepair(gpu::Commands& commands, const DeformPasses& passes) const {
  if (hasNormals_) dispatchPass(*passes.repair, commands, std::as_bytes(std::span(&pass_, 1)), vertexCount_);
}

}  // namespace quintet::render

// SPDX-License-Identifier: Apache-2.0
#include "render/scene/deformed_meshes.h"

#include <algorithm>
#include <cstring>

#include "base/stopwatch.h"
#include "render/compute_pass.h"
#include "scene/animation/deform.h"

namespace quintet::render {
namespace {

constexpr VkDeviceSize kStagingBytes = VkDeviceSize{32} << 20;

// Marks of the timer.
enum Mark : std::uint32_t { kStart, kDeformed, kMeasured, kRefitted, kMarkCount };

shared::DeformMatrix rowsOf(const mat4& matrix, std::uint32_t flags) {
  const mat4 rows = glm::transpose(matrix);
  return {{rows[0], rows[1], rows[2]}, flags};
}

// Of the joints, and of the node, which geometries without skin sets follow. None without a skin.
std::vector<mat4> matricesOf(int skin, int node, const scene::NodeAnimation& animation, const scene::Pose& pose) {
  if (skin == scene::kNone) return {};
  std::vector<mat4> matrices = scene::jointMatrices(animation.skins[static_cast<std::size_t>(skin)], pose);
  matrices.push_back(pose.worldFromNode[static_cast<std::size_t>(node)]);
  return matrices;
}

std::vector<shared::TreeCostGeometry> costGeometries(const rt::BlasInput& input) {
  std::vector<shared::TreeCostGeometry> geometries;
  std::size_t first = 0;
  for (const rt::GeometryInput& geometry : input.geometries) {
    geometries.push_back({geometry.positionsAddress, geometry.trianglesAddress, static_cast<std::uint32_t>(first), 0});
    first += geometry.triangles.size();
  }
  return geometries;
}

}  // namespace

DeformedMeshes::DeformedMeshes(gpu::Context& context, const gpu::BindlessSet& set, const shader::Compiler& compiler)
    : context_(context),
      passes_(context, set, compiler),
      costPass_(makePass(context, set, compiler, "tree_cost")),
      timer_(context, kMarkCount) {}

DeformedMeshes::PoseBuffer DeformedMeshes::makePoseBuffer(gpu::Context& context, const scene::MeshDeformation& mesh,
                                                          std::size_t jointCount) {
  PoseBuffer pose;
  for (const scene::GeometryDeformation& geometry : mesh.geometries)
    pose.weightCount = std::max(pose.weightCount, geometry.targets.size());
  // The transform of the node follows the joints.
  if (mesh.skin != scene::kNone) pose.weightOffset = (jointCount + 1) * sizeof(shared::DeformMatrix);
  gpu::BufferOptions options{.size = pose.weightOffset + pose.weightCount * sizeof(float), .name = "pose"};
  pose.device = gpu::Buffer(context, options);
  options.memory = gpu::Memory::upload;
  options.name = "pose staging";
  options.purpose = gpu::Purpose::staging;
  pose.staging = gpu::Buffer(context, options);
  return pose;
}

void DeformedMeshes::add(const scene::Scene& scene, std::size_t index, const scene::Pose& pose,
                         const rt::BlasInput& input, rt::Blas& blas, GeometryUpload& upload) {
  if (std::ranges::all_of(input.geometries, [](const auto& geometry) { return geometry.triangles.empty(); })) return;
  const scene::MeshDeformation& from = *scene.meshes[index].deformation;
  const std::vector<mat4> matrices = matricesOf(from.skin, from.node, *scene.nodeAnimation, pose);
  const std::size_t jointCount = matrices.empty() ? 0 : matrices.size() - 1;
  Mesh& mesh = meshes_.emplace_back();
  mesh.index = index;
  mesh.node = from.node;
  mesh.skin = from.skin;
  mesh.input = input;
  mesh.blas = &blas;
  mesh.upload = &upload;
  mesh.pose = makePoseBuffer(context_, from, jointCount);
  for (const mat4& matrix : matrices) mesh.mirrored.push_back(scene::mirrors(matrix));
  gpu::Uploader uploader(context_, kStagingBytes);
  const std::size_t first = upload.firstGeometry[index];
  for (std::size_t g = 0; g < from.geometries.size(); ++g) {
    PoseAddresses addresses;
    addresses.weights = mesh.pose.device.address() + mesh.pose.weightOffset;
    if (from.skin != scene::kNone) {
      addresses.matrices = mesh.pose.device.address();
      if (from.geometries[g].skinSets.empty()) addresses.matrices += jointCount * sizeof(shared::DeformMatrix);
    }
    mesh.geometries.emplace_back(context_, uploader, from.geometries[g], input.geometries[g].triangles,
                                 upload.geometries[first + g], addresses);
  }
  uploader.flush();
  prepareUpdates(mesh);
  roots_ = gpu::Buffer(
      context_,
      {.size = meshes_.size() * sizeof(shared::TreeCostNode), .memory = gpu::Memory::readback, .name = "tree roots"});
}

// After a build from mesh.input with its host arrays, which are not used afterwards.
void DeformedMeshes::prepareUpdates(Mesh& mesh) {
  mesh.refit = rt::BlasRefit(context_, *mesh.blas, mesh.input);
  mesh.cost = TreeCost(context_, mesh.input, costGeometries(mesh.input));
  for (rt::GeometryInput& geometry : mesh.input.geometries) geometry.positions = {}, geometry.triangles = {};
}

void DeformedMeshes::writePose(Mesh& mesh, const scene::NodeAnimation& animation, const scene::Pose& pose) {
  auto* to = reinterpret_cast<shared::DeformMatrix*>(mesh.pose.staging.mapped());
  mesh.turns = false;
  const std::vector<mat4> matrices = matricesOf(mesh.skin, mesh.node, animation, pose);
  for (std::size_t i = 0; i < matrices.size(); ++i) {
    const bool mirrors = scene::mirrors(matrices[i]);
    to[i] =
        rowsOf(matrices[i], (mirrors ? shared::kDeformMirrors : 0) | (mesh.mirrored[i] ? shared::kDeformMirrored : 0));
    mesh.turns = mesh.turns || mirrors != mesh.mirrored[i];
    mesh.mirrored[i] = mirrors;
  }
  auto* weights = reinterpret_cast<float*>(mesh.pose.staging.mapped() + mesh.pose.weightOffset);
  const std::vector<float>& values = pose.weights[static_cast<std::size_t>(mesh.node)];
  for (std::size_t i = 0; i < mesh.pose.weightCount; ++i) weights[i] = i < values.size() ? values[i] : 0.0f;
}

void DeformedMeshes::recordCosts(gpu::Commands& commands) const {
  std::size_t levels = 0;
  for (const Mesh& mesh : meshes_) levels = std::max(levels, mesh.cost.levelCount());
  for (std::size_t level = 0; level < levels; ++level) {
    commands.barrier(gpu::Stage::compute, gpu::Stage::compute);
    for (std::size_t m = 0; m < meshes_.size(); ++m)
      if (level < meshes_[m].cost.levelCount())
        meshes_[m].cost.record(commands, *costPass_, level, roots_.address() + m * sizeof(shared::TreeCostNode));
  }
}

void DeformedMeshes::record(gpu::Commands& commands) {
  timer_.reset(commands);
  timer_.mark(commands, kStart);
  commands.barrier(gpu::Stage::all, gpu::Stage::transfer);
  for (const Mesh& mesh : meshes_) commands.copy(mesh.pose.staging, mesh.pose.device, mesh.pose.staging.size());
  commands.barrier(gpu::Stage::all, gpu::Stage::compute);
  for (const Mesh& mesh : meshes_)
    for (const GeometryDeformer& geometry : mesh.geometries) {
      if (mesh.turns) geometry.recordWinding(commands, passes_);
      geometry.recordVertices(commands, passes_);
    }
  commands.barrier(gpu::Stage::compute, gpu::Stage::compute);
  for (const Mesh& mesh : meshes_)
    for (const GeometryDeformer& geometry : mesh.geometries) geometry.recordRepair(commands, passes_);
  timer_.mark(commands, kDeformed);
  recordCosts(commands);
  timer_.mark(commands, kMeasured);
  commands.barrier(gpu::Stage::compute, gpu::Stage::accelerationStructureBuild);
  for (const Mesh& mesh : meshes_)
    if (!mesh.turns) mesh.refit.record(commands);
  timer_.mark(commands, kRefitted);
  commands.barrier(gpu::Stage::all, gpu::Stage::all);
  commands.toHost(gpu::Stage::compute);
}

// Builds the BLAS again, from the vertices of the frame.
void DeformedMeshes::build(Mesh& mesh) {
  const std::size_t first = mesh.upload->firstGeometry[mesh.index];
  std::vector<HostArray<vec3>> positions;
  std::vector<HostArray<uvec3>> triangles;
  for (std::size_t g = 0; g < mesh.input.geometries.size(); ++g) {
    const VertexSlots& slots = mesh.upload->slots[first + g];
    positions.push_back(readArray<vec3>(*mesh.upload, slots.positions));
    triangles.push_back(readArray<uvec3>(*mesh.upload, slots.triangles));
    mesh.input.geometries[g].positions = positions.back().values();
    mesh.input.geometries[g].triangles = triangles.back().values();
  }
  *mesh.blas = std::move(rt::BlasBuilder(context_).build({&mesh.input, 1}).front());
  prepareUpdates(mesh);
}

void DeformedMeshes::setPose(const scene::NodeAnimation& animation, const scene::Pose& pose,
                             const std::function<void(std::size_t mesh)>& rebuilt) {
  Stopwatch watch;
  for (Mesh& mesh : meshes_) writePose(mesh, animation, pose);
  statistics_.poseSeconds += watch.lap();
  context_.submitAndWait([&](gpu::Commands& commands) { record(commands); });
  statistics_.deformSeconds += timer_.seconds(kStart, kDeformed);
  statistics_.costSeconds += timer_.seconds(kDeformed, kMeasured);
  statistics_.refitSeconds += timer_.seconds(kMeasured, kRefitted);
  watch.lap();
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    Mesh& mesh = meshes_[m];
    shared::TreeCostNode root;
    std::memcpy(&root, roots_.mapped() + m * sizeof(root), sizeof(root));
    if (!mesh.turns && mesh.cost.growth(root) <= rt::kMaxRefitGrowth) {
      mesh.blas->setBounds({root.low, root.high});
      ++statistics_.refits;
      continue;
    }
    build(mesh);
    rebuilt(mesh.index);
    ++statistics_.builds;
  }
  statistics_.buildSeconds += watch.lap();
}

void DeformedMeshes::forPositions(const Wanted& wanted, const Visit& visit) const {
  for (const Mesh& mesh : meshes_)
    for (std::size_t g = 0; g < mesh.geometries.size(); ++g) {
      if (!wanted(mesh.index, g)) continue;
      const VertexSlots& slots = mesh.upload->slots[mesh.upload->firstGeometry[mesh.index] + g];
      visit(mesh.index, g, readArray<vec3>(*mesh.upload, slots.positions).values());
    }
}

}  // namespace quintet::render

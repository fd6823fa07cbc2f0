// SPDX-License-Identifier: Apache-2.0
#include "render/scene/geometry_upload.h"

#include <algorithm>
#include <cassert>

#include "base/parallel.h"
#include "gpu/image.h"
#include "render/scene/procedural_data.h"

namespace quintet::render {
namespace {

constexpr VkDeviceSize kBufferAlignment = 16;
constexpr VkDeviceSize kArenaBytes = VkDeviceSize{256} << 20;

VkDeviceSize aligned(VkDeviceSize size) { return (size + kBufferAlignment - 1) / kBufferAlignment * kBufferAlignment; }

// An array on the device and its host view: mapped device memory, or the scene's array.
template <class T>
struct UploadedArray {
  shared::Address address = 0;
  std::span<const T> host;
  ArraySlot slot;
};

// Suballocates a few large buffers in the order of `sizes`, which are aligned and not 0. On a CPU the buffers are
// mapped and written directly.
class Arena {
 public:
  Arena(gpu::Context& context, gpu::Uploader& uploader, GeometryUpload& target, std::vector<VkDeviceSize> sizes)
      : context_(context), uploader_(uploader), target_(target), sizes_(std::move(sizes)) {}

  // Uploads the array. The address of an empty array is 0.
  template <class T>
  UploadedArray<T> add(const std::vector<T>& data) {
    if (data.empty()) return {};
    if (used_ == capacity_) grow();
    gpu::Buffer& buffer = target_.buffers.back();
    UploadedArray<T> uploaded{
        buffer.address() + used_, data, {target_.buffers.size() - 1, used_, data.size() * sizeof(T)}};
    if (std::byte* mapped = buffer.mapped()) {
      parallelCopy(mapped + used_, std::as_bytes(std::span(data)));
      uploaded.host = {reinterpret_cast<const T*>(mapped + used_), data.size()};
    } else {
      uploader_.upload(buffer, std::as_bytes(std::span(data)), used_);
    }
    used_ += aligned(data.size() * sizeof(T));
    assert(used_ <= capacity_);
    ++next_;
    return uploaded;
  }

 private:
  // Adds a buffer that the next arrays fill exactly.
  void grow() {
    gpu::BufferOptions options;
    for (std::size_t i = next_; i < sizes_.size() && (i == next_ || options.size + sizes_[i] <= kArenaBytes); ++i)
      options.size += sizes_[i];
    options.memory = context_.info().software ? gpu::Memory::upload : gpu::Memory::device;
    options.usage = VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR;
    options.alignment = kBufferAlignment;
    options.name = "geometry attributes";
    options.purpose = gpu::Purpose::geometry;
    target_.buffers.emplace_back(context_, options);
    target_.bytes += options.size;
    capacity_ = options.size;
    used_ = 0;
  }

  gpu::Context& context_;
  gpu::Uploader& uploader_;
  GeometryUpload& target_;
  std::vector<VkDeviceSize> sizes_;
  std::size_t next_ = 0;  // index in sizes_ of the next array
  VkDeviceSize capacity_ = 0;
  VkDeviceSize used_ = 0;
};

// Calls visit(values) for each array in the order in which it is uploaded.
template <class Geometry, class Visit>
void forArrays(Geometry& g, const Visit& visit) {
  visit(g.positions), visit(g.triangles), visit(g.normals), visit(g.tangents);
  visit(g.uvs[0]), visit(g.uvs[1]), visit(g.colors);
}

// Returns the sizes of all arrays in the order in which they are uploaded.
std::vector<VkDeviceSize> arraySizes(const scene::Scene& scene) {
  std::vector<VkDeviceSize> sizes;
  const auto add = [&](VkDeviceSize size) {
    if (size > 0) sizes.push_back(aligned(size));
  };
  for (const scene::Mesh& mesh : scene.meshes) {
    for (const scene::Geometry& geometry : mesh.geometries)
      forArrays(geometry, [&](const auto& values) { add(values.size() * sizeof(values[0])); });
    for (const scene::PrimitiveSet& set : mesh.primitiveSets) {
      add(scene::boxCount(set) * sizeof(shared::BoxData));
      add(set.primitives.size() * sizeof(shared::PrimitiveData));
      add(set.nodes.size() * sizeof(shared::CsgNodeData));
      add(set.trees.size() * sizeof(shared::CsgTreeData));
    }
  }
  return sizes;
}

shared::GeometryData uploadTriangles(Arena& arena, const scene::Scene& scene, const scene::Geometry& g,
                                     GeometryArrays& arrays, VertexSlots& slots) {
  shared::GeometryData data{};
  const UploadedArray<vec3> positions = arena.add(g.positions);
  const UploadedArray<uvec3> triangles = arena.add(g.triangles);
  arrays = {positions.host, triangles.host};
  data.positions = positions.address;
  data.triangles = triangles.address;
  slots = {positions.slot, triangles.slot};
  data.normals = arena.add(g.normals).address;
  data.tangents = arena.add(g.tangents).address;
  data.uvs[0] = arena.add(g.uvs[0]).address;
  data.uvs[1] = arena.add(g.uvs[1]).address;
  data.colors = arena.add(g.colors).address;
  data.material = materialIndex(scene, g.material);
  data.triangleCount = static_cast<std::uint32_t>(g.triangles.size());
  data.kind = shared::kGeometryTriangles;
  return data;
}

// Frees the arrays of a geometry that `arrays` does not refer to.
void freeArrays(scene::Geometry& g, const GeometryArrays& arrays) {
  forArrays(g, [&](auto& values) {
    const void* data = values.data();
    if (data == arrays.positions.data() || data == arrays.triangles.data()) return;
    std::remove_reference_t<decltype(values)>().swap(values);
  });
}

std::uint32_t geometryKind(scene::PrimitiveSetKind kind) {
  switch (kind) {
    case scene::PrimitiveSetKind::solids: return shared::kGeometrySolids;
    case scene::PrimitiveSetKind::csg: return shared::kGeometryCsg;
    case scene::PrimitiveSetKind::custom: break;
  }
  return shared::kGeometryCustom;
}

shared::GeometryData uploadPrimitives(Arena& arena, const scene::Scene& scene, const scene::PrimitiveSet& set) {
  shared::GeometryData data{};
  data.boxes = arena.add(makeBoxes(set)).address;
  data.primitives = arena.add(makePrimitives(scene, set)).address;
  data.nodes = arena.add(makeNodes(set)).address;
  data.trees = arena.add(makeTrees(set)).address;
  data.material = materialIndex(scene, set.material);
  data.triangleCount = static_cast<std::uint32_t>(scene::boxCount(set));
  data.kind = geometryKind(set.kind);
  return data;
}

}  // namespace

VkDeviceSize geometryUploadBytes(const gpu::Context& context, const scene::Scene& scene) {
  if (context.info().software) return 0;
  VkDeviceSize bytes = 0;
  for (const VkDeviceSize size : arraySizes(scene)) bytes += size;
  return bytes;
}

GeometryUpload uploadGeometries(gpu::Context& context, gpu::Uploader& uploader, const scene::Scene& scene,
                                scene::Scene* consumed) {
  GeometryUpload upload;
  Arena arena(context, uploader, upload, arraySizes(scene));
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const scene::Mesh& mesh = scene.meshes[m];
    upload.firstGeometry.push_back(static_cast<std::uint32_t>(upload.geometries.size()));
    for (std::size_t g = 0; g < mesh.geometries.size(); ++g) {
      GeometryArrays& arrays = upload.arrays.emplace_back();
      upload.geometries.push_back(
          uploadTriangles(arena, scene, mesh.geometries[g], arrays, upload.slots.emplace_back()));
      if (consumed) freeArrays(consumed->meshes[m].geometries[g], arrays);
    }
    for (const scene::PrimitiveSet& set : mesh.primitiveSets) {
      upload.arrays.emplace_back();
      upload.slots.emplace_back();
      upload.geometries.push_back(uploadPrimitives(arena, scene, set));
    }
  }
  return upload;
}

}  // namespace quintet::render

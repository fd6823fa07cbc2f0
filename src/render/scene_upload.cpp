#include "render/scene_upload.h"

#include <algorithm>
#include <cassert>

#include "base/parallel.h"
#include "render/procedural_data.h"

namespace quintet::render {
namespace {

constexpr VkDeviceSize kAlignment = 16;
constexpr VkDeviceSize kArenaBytes = VkDeviceSize{256} << 20;

VkDeviceSize aligned(VkDeviceSize size) { return (size + kAlignment - 1) / kAlignment * kAlignment; }

template <class T>
void clear(std::vector<T>& values) {
  std::vector<T>().swap(values);
}

// An array on the device, and where the host can read it: there, or where it came from.
template <class T>
struct Placed {
  shared::Address address = 0;
  std::span<const T> host;
};

// Hands out parts of a few large buffers, in the order of `sizes`, which are aligned and not 0. On a CPU they are
// mapped and written directly.
class Arena {
 public:
  Arena(gpu::Context& context, gpu::Uploader& uploader, GeometryUpload& target, std::vector<VkDeviceSize> sizes)
      : context_(context), uploader_(uploader), target_(target), sizes_(std::move(sizes)) {}

  // Uploads the array; address 0 for an empty one.
  template <class T>
  Placed<T> add(const std::vector<T>& data) {
    if (data.empty()) return {};
    if (used_ == capacity_) grow();
    gpu::Buffer& buffer = target_.buffers.back();
    Placed<T> placed{buffer.address() + used_, data};
    if (std::byte* mapped = buffer.mapped()) {
      parallelCopy(mapped + used_, std::as_bytes(std::span(data)));
      placed.host = {reinterpret_cast<const T*>(mapped + used_), data.size()};
    } else {
      uploader_.upload(buffer, std::as_bytes(std::span(data)), used_);
    }
    used_ += aligned(data.size() * sizeof(T));
    assert(used_ <= capacity_);
    ++next_;
    return placed;
  }

 private:
  // A buffer that the next arrays fill exactly.
  void grow() {
    gpu::BufferOptions options;
    for (std::size_t i = next_; i < sizes_.size() && (i == next_ || options.size + sizes_[i] <= kArenaBytes); ++i)
      options.size += sizes_[i];
    options.memory = context_.info().quirks.software ? gpu::Memory::upload : gpu::Memory::device;
    options.usage = VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR;
    options.alignment = kAlignment;
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
  std::size_t next_ = 0;  // in sizes_
  VkDeviceSize capacity_ = 0;
  VkDeviceSize used_ = 0;
};

// Calls visit(values) for each array in the order in which it is uploaded.
template <class Geometry, class Visit>
void forArrays(Geometry& g, const Visit& visit) {
  visit(g.positions), visit(g.triangles), visit(g.normals), visit(g.tangents);
  visit(g.uvs[0]), visit(g.uvs[1]), visit(g.colors);
}

// Of all arrays, in the order in which they are uploaded.
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
                                     GeometryArrays& arrays) {
  shared::GeometryData data{};
  const Placed<vec3> positions = arena.add(g.positions);
  const Placed<uvec3> triangles = arena.add(g.triangles);
  arrays = {positions.host, triangles.host};
  data.positions = positions.address;
  data.triangles = triangles.address;
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

// What the device has now; the arrays that are still read stay.
void giveUp(scene::Geometry& g, const GeometryArrays& arrays) {
  const bool positions = arrays.positions.data() == g.positions.data(),
             triangles = arrays.triangles.data() == g.triangles.data();
  forArrays(g, [&](auto& values) {
    const void* own = values.data();
    if ((positions && own == arrays.positions.data()) || (triangles && own == arrays.triangles.data())) return;
    clear(values);
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

VkSamplerAddressMode addressMode(scene::Wrap wrap) {
  switch (wrap) {
    case scene::Wrap::repeat: return VK_SAMPLER_ADDRESS_MODE_REPEAT;
    case scene::Wrap::mirroredRepeat: return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
    case scene::Wrap::clampToEdge: return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  }
  return VK_SAMPLER_ADDRESS_MODE_REPEAT;
}

VkFormat textureFormat(io::PixelType type, bool sRgb) {
  switch (type) {
    case io::PixelType::u8: return sRgb ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM;
    case io::PixelType::u16: return VK_FORMAT_R16G16B16A16_UNORM;
    case io::PixelType::f32: return VK_FORMAT_R32G32B32A32_SFLOAT;
  }
  return VK_FORMAT_UNDEFINED;
}

}  // namespace

VkDeviceSize uploadBytes(const gpu::Context& context, const scene::Scene& scene) {
  VkDeviceSize bytes = 0;
  for (const scene::NamedImage& image : scene.images)
    bytes += 4 * image.image.pixelCount() * io::bytesPerSample(image.image.type);
  if (context.info().quirks.software) return bytes;
  for (const VkDeviceSize size : arraySizes(scene)) bytes += size;
  return bytes;
}

GeometryUpload uploadGeometries(gpu::Context& context, gpu::Uploader& uploader, const scene::Scene& scene,
                                scene::Scene* emptied) {
  GeometryUpload upload;
  Arena arena(context, uploader, upload, arraySizes(scene));
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const scene::Mesh& mesh = scene.meshes[m];
    upload.firstGeometry.push_back(static_cast<std::uint32_t>(upload.geometries.size()));
    for (std::size_t g = 0; g < mesh.geometries.size(); ++g) {
      GeometryArrays& arrays = upload.arrays.emplace_back();
      upload.geometries.push_back(uploadTriangles(arena, scene, mesh.geometries[g], arrays));
      if (emptied) giveUp(emptied->meshes[m].geometries[g], arrays);
    }
    for (const scene::PrimitiveSet& set : mesh.primitiveSets) {
      upload.arrays.emplace_back();
      upload.geometries.push_back(uploadPrimitives(arena, scene, set));
    }
  }
  return upload;
}

TextureUpload::TextureUpload(gpu::Context& context, gpu::Uploader& uploader, const scene::Scene& scene)
    : context_(context), uploader_(uploader), scene_(scene) {}

void TextureUpload::expect(int texture, bool sRgb) {
  const int image = scene_.textures[static_cast<std::size_t>(texture)].image;
  if (image != scene::kNone) expected_.insert({image, sRgb});
}

void TextureUpload::giveUp(int image, bool sRgb) {
  expected_.erase({image, sRgb});
  if (emptied_ && !expected_.contains({image, !sRgb}))
    clear(emptied_->images[static_cast<std::size_t>(image)].image.data);
}

std::uint32_t TextureUpload::index(int texture, bool sRgb) {
  const auto known = indexByTexture_.find({texture, sRgb});
  if (known != indexByTexture_.end()) return known->second;
  const scene::Texture& t = scene_.textures[static_cast<std::size_t>(texture)];
  if (t.image == scene::kNone) return shared::kNoTexture;
  const gpu::Image*& image = imageByKey_[{t.image, sRgb}];
  if (!image) {
    const scene::NamedImage& source = scene_.images[static_cast<std::size_t>(t.image)];
    if (source.image.empty()) return shared::kNoTexture;
    image = &upload(source.image, sRgb, source.name);
    giveUp(t.image, sRgb);
  }
  gpu::SamplerOptions options;
  options.filter = t.sampler.filter == scene::Filter::nearest ? VK_FILTER_NEAREST : VK_FILTER_LINEAR;
  options.addressU = addressMode(t.sampler.wrapU);
  options.addressV = addressMode(t.sampler.wrapV);
  entries_.push_back({image, &sampler(options)});
  return indexByTexture_[{texture, sRgb}] = count() - 1;
}

std::uint32_t TextureUpload::addEnvironment(const io::Image& image) {
  gpu::SamplerOptions options;
  options.addressV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  entries_.push_back({&upload(image, false, "environment"), &sampler(options)});
  return count() - 1;
}

void TextureUpload::bind(gpu::BindlessSet& set) const {
  for (std::uint32_t i = 0; i < count(); ++i) set.setTexture(i, *entries_[i].image, *entries_[i].sampler);
}

gpu::Image& addTexture(std::deque<gpu::Image>& textures, gpu::Context& context, gpu::Uploader& uploader,
                       const io::Image& source, bool sRgb, const std::string& name) {
  // The device has no sRGB format of 16 bits: those are decoded here.
  const bool decoded = sRgb && source.type == io::PixelType::u16;
  const io::Image linear = decoded ? io::toFloat(source) : io::Image{};
  const io::Image& image = decoded ? linear : source;
  gpu::ImageOptions options;
  options.width = image.width;
  options.height = image.height;
  options.format = textureFormat(image.type, sRgb);
  options.name = name;
  gpu::Image& texture = textures.emplace_back(context, options);
  uploader.upload(texture,
                  [&](std::uint32_t first, std::span<std::byte> rows) { io::writeChannels(image, 4, first, rows); });
  return texture;
}

const gpu::Image& TextureUpload::upload(const io::Image& source, bool sRgb, const std::string& name) {
  const gpu::Image& image = addTexture(images_, context_, uploader_, source, sRgb, name);
  bytes_ += image.byteSize();
  return image;
}

const gpu::Sampler& TextureUpload::sampler(const gpu::SamplerOptions& options) {
  const auto found =
      std::find_if(samplers_.begin(), samplers_.end(), [&](const auto& entry) { return entry.first == options; });
  if (found != samplers_.end()) return found->second;
  samplers_.emplace_back(options, gpu::Sampler(context_, options));
  return samplers_.back().second;
}

}  // namespace quintet::render

#include "render/scene_upload.h"

#include <algorithm>

#include "render/procedural_data.h"

namespace quintet::render {
namespace {

constexpr VkDeviceSize kAlignment = 16;
constexpr VkDeviceSize kArenaBytes = VkDeviceSize{256} << 20;

VkDeviceSize aligned(VkDeviceSize size) { return (size + kAlignment - 1) / kAlignment * kAlignment; }

// Hands out parts of a few large buffers.
class Arena {
 public:
  Arena(gpu::Context& context, gpu::Uploader& uploader, GeometryUpload& target, VkDeviceSize totalBytes)
      : context_(context), uploader_(uploader), target_(target), remaining_(totalBytes) {}

  // Uploads the array and returns its address; 0 for an empty one.
  template <class T>
  shared::Address add(const std::vector<T>& data) {
    if (data.empty()) return 0;
    const VkDeviceSize size = aligned(data.size() * sizeof(T));
    if (used_ + size > capacity_) grow(size);
    gpu::Buffer& buffer = target_.buffers.back();
    uploader_.upload(buffer, std::as_bytes(std::span(data)), used_);
    const shared::Address address = buffer.address() + used_;
    used_ += size;
    remaining_ -= std::min(remaining_, size);
    return address;
  }

 private:
  void grow(VkDeviceSize least) {
    gpu::BufferOptions options;
    options.size = std::max(least, std::min(remaining_, kArenaBytes));
    options.alignment = kAlignment;
    options.name = "geometry attributes";
    target_.buffers.emplace_back(context_, options);
    target_.bytes += options.size;
    capacity_ = options.size;
    used_ = 0;
  }

  gpu::Context& context_;
  gpu::Uploader& uploader_;
  GeometryUpload& target_;
  VkDeviceSize remaining_;
  VkDeviceSize capacity_ = 0;
  VkDeviceSize used_ = 0;
};

VkDeviceSize attributeBytes(const scene::Geometry& g) {
  return aligned(g.positions.size() * sizeof(vec3)) + aligned(g.triangles.size() * sizeof(uvec3)) +
         aligned(g.normals.size() * sizeof(vec3)) + aligned(g.tangents.size() * sizeof(vec4)) +
         aligned(g.uvs[0].size() * sizeof(vec2)) + aligned(g.uvs[1].size() * sizeof(vec2)) + aligned(g.colors.size() * sizeof(vec4));
}

VkDeviceSize attributeBytes(const scene::PrimitiveSet& set) {
  return aligned(set.primitives.size() * sizeof(shared::PrimitiveData)) + aligned(set.nodes.size() * sizeof(shared::CsgNodeData)) +
         aligned(set.trees.size() * sizeof(shared::CsgTreeData)) + aligned(scene::boxCount(set) * sizeof(shared::BoxData));
}

shared::GeometryData uploadTriangles(Arena& arena, const scene::Scene& scene, const scene::Geometry& g) {
  shared::GeometryData data{};
  data.positions = arena.add(g.positions);
  data.triangles = arena.add(g.triangles);
  data.normals = arena.add(g.normals);
  data.tangents = arena.add(g.tangents);
  data.uvs[0] = arena.add(g.uvs[0]);
  data.uvs[1] = arena.add(g.uvs[1]);
  data.colors = arena.add(g.colors);
  data.material = materialIndex(scene, g.material);
  data.triangleCount = static_cast<std::uint32_t>(g.triangles.size());
  data.kind = shared::kGeometryTriangles;
  return data;
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
  data.boxes = arena.add(makeBoxes(set));
  data.primitives = arena.add(makePrimitives(scene, set));
  data.nodes = arena.add(makeNodes(set));
  data.trees = arena.add(makeTrees(set));
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

GeometryUpload uploadGeometries(gpu::Context& context, gpu::Uploader& uploader, const scene::Scene& scene) {
  VkDeviceSize total = 0;
  for (const scene::Mesh& mesh : scene.meshes) {
    for (const scene::Geometry& geometry : mesh.geometries) total += attributeBytes(geometry);
    for (const scene::PrimitiveSet& set : mesh.primitiveSets) total += attributeBytes(set);
  }

  GeometryUpload upload;
  Arena arena(context, uploader, upload, total);
  for (const scene::Mesh& mesh : scene.meshes) {
    upload.firstGeometry.push_back(static_cast<std::uint32_t>(upload.geometries.size()));
    for (const scene::Geometry& g : mesh.geometries) upload.geometries.push_back(uploadTriangles(arena, scene, g));
    for (const scene::PrimitiveSet& set : mesh.primitiveSets) upload.geometries.push_back(uploadPrimitives(arena, scene, set));
  }
  return upload;
}

TextureUpload::TextureUpload(gpu::Context& context, gpu::Uploader& uploader, const scene::Scene& scene)
    : context_(context), uploader_(uploader), scene_(scene) {}

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

gpu::Image& addTexture(std::deque<gpu::Image>& textures, gpu::Context& context, gpu::Uploader& uploader, const io::Image& source, bool sRgb,
                       const std::string& name) {
  // The device has no sRGB format of 16 bits: those are decoded here.
  io::Image image = sRgb && source.type == io::PixelType::u16 ? io::toFloat(source) : source;
  if (image.channels != 4) image = io::toChannels(image, 4);
  gpu::ImageOptions options;
  options.width = image.width;
  options.height = image.height;
  options.format = textureFormat(image.type, sRgb);
  options.name = name;
  gpu::Image& texture = textures.emplace_back(context, options);
  uploader.upload(texture, image.data);
  return texture;
}

const gpu::Image& TextureUpload::upload(const io::Image& source, bool sRgb, const std::string& name) {
  const gpu::Image& image = addTexture(images_, context_, uploader_, source, sRgb, name);
  bytes_ += image.byteSize();
  return image;
}

const gpu::Sampler& TextureUpload::sampler(const gpu::SamplerOptions& options) {
  const auto found = std::find_if(samplers_.begin(), samplers_.end(), [&](const auto& entry) { return entry.first == options; });
  if (found != samplers_.end()) return found->second;
  samplers_.emplace_back(options, gpu::Sampler(context_, options));
  return samplers_.back().second;
}

}  // namespace quintet::render

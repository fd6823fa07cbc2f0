// The parts of a scene's upload: attribute arrays in few large buffers, and textures.
#ifndef QUINTET_RENDER_SCENE_UPLOAD_H
#define QUINTET_RENDER_SCENE_UPLOAD_H

#include <deque>
#include <map>
#include <set>
#include <span>
#include <tuple>
#include <vector>

#include "gpu/descriptors.h"
#include "gpu/image.h"
#include "quintet/shared/frame.h"
#include "scene/scene.h"

namespace quintet::render {

// Where the host reads what an acceleration structure is built from: mapped device memory, or the scene.
struct GeometryArrays {
  std::span<const vec3> positions;
  std::span<const uvec3> triangles;
};

// Vertex attributes and triangles of all geometries, and the arrays of all primitive sets, in the order of hit
// records. Addresses of primitive maps are left for the caller.
struct GeometryUpload {
  std::deque<gpu::Buffer> buffers;
  std::vector<shared::GeometryData> geometries;
  std::vector<GeometryArrays> arrays;        // parallel to `geometries`; empty for primitive sets
  std::vector<std::uint32_t> firstGeometry;  // per mesh
  std::uint64_t bytes = 0;
};
// What goes through the uploader for a scene: pictures, each in one form, and arrays unless they are written directly.
VkDeviceSize uploadBytes(const gpu::Context& context, const scene::Scene& scene);
// `emptied`: null, or the same scene, whose arrays are freed as soon as they are uploaded and `arrays` does not need them.
GeometryUpload uploadGeometries(gpu::Context& context, gpu::Uploader& uploader, const scene::Scene& scene,
                                scene::Scene* emptied);

// Appends a picture of any type as a texture of 4 channels. `sRgb`: integer colours are decoded when they are read.
// A deque: the uploader keeps the texture's address until it is flushed.
gpu::Image& addTexture(std::deque<gpu::Image>& textures, gpu::Context& context, gpu::Uploader& uploader,
                       const io::Image& image, bool sRgb, const std::string& name);

// Textures on the device, one for each (image, encoding, sampler) that is asked for.
class TextureUpload {
 public:
  TextureUpload(gpu::Context& context, gpu::Uploader& uploader, const scene::Scene& scene);
  // Says before the first index() which ones will come, so that empty() knows when a picture has done its duty.
  void expect(int texture, bool sRgb);
  // Frees the pictures of `scene`, the same one, as soon as they are uploaded in every form that is expected.
  void empty(scene::Scene& scene) { emptied_ = &scene; }
  // Bindless index of a texture of the scene; uploads it the first time.
  std::uint32_t index(int texture, bool sRgb);
  // An image that is not the scene's (the environment), repeated in u, clamped in v.
  std::uint32_t addEnvironment(const io::Image& image);

  std::uint32_t count() const { return static_cast<std::uint32_t>(entries_.size()); }
  void bind(gpu::BindlessSet& set) const;
  std::uint64_t bytes() const { return bytes_; }

 private:
  struct Entry {
    const gpu::Image* image;
    const gpu::Sampler* sampler;
  };
  const gpu::Image& upload(const io::Image& image, bool sRgb, const std::string& name);
  void giveUp(int image, bool sRgb);
  const gpu::Sampler& sampler(const gpu::SamplerOptions& options);

  gpu::Context& context_;
  gpu::Uploader& uploader_;
  const scene::Scene& scene_;
  scene::Scene* emptied_ = nullptr;
  std::set<std::pair<int, bool>> expected_;
  std::deque<gpu::Image> images_;
  std::deque<std::pair<gpu::SamplerOptions, gpu::Sampler>> samplers_;
  std::map<std::pair<int, bool>, const gpu::Image*> imageByKey_;
  std::map<std::pair<int, bool>, std::uint32_t> indexByTexture_;
  std::vector<Entry> entries_;
  std::uint64_t bytes_ = 0;
};

}  // namespace quintet::render
#endif

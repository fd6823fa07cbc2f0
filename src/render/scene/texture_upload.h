// SPDX-License-Identifier: Apache-2.0
// Uploads images as textures: those of a scene's materials, its environment, and the images of program parameters.
#ifndef QUINTET_RENDER_SCENE_TEXTURE_UPLOAD_H
#define QUINTET_RENDER_SCENE_TEXTURE_UPLOAD_H

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gpu/descriptors.h"
#include "gpu/image.h"
#include "gpu/uploader.h"
#include "scene/model/scene.h"

namespace quintet::render {

// Appends an image of any type as a texture of 4 channels. `sRgb` means that integer colors are decoded when they are
// sampled. A deque, because the uploader holds the texture's address until it is flushed.
gpu::Image& addTexture(std::deque<gpu::Image>& textures, gpu::Context& context, gpu::Uploader& uploader,
                       const io::Image& image, bool sRgb, const std::string& name);

// Returns the bytes that TextureUpload transfers for the scene's images, each in one encoding.
VkDeviceSize textureUploadBytes(const scene::Scene& scene);

// The textures of a scene on the device: one for each requested combination of image, encoding and sampler.
class TextureUpload {
 public:
  // `consumed`: null, or the scene itself: then the pixels of each image are freed once they are uploaded in all encodings that
  // expect() announced.
  TextureUpload(gpu::Context& context, gpu::Uploader& uploader, const scene::Scene& scene, scene::Scene* consumed);
  // Announces a later index(). All announcements come before the first index().
  void expect(int texture, bool sRgb);
  // Returns the bindless index of a texture of the scene; uploads its image on the first call.
  std::uint32_t index(int texture, bool sRgb);
  // Returns the index if index() was called for this texture and encoding before.
  std::optional<std::uint32_t> find(int texture, bool sRgb) const;
  // Uploads the environment, which is repeated in u and clamped in v. Returns its bindless index.
  std::uint32_t addEnvironment(const io::Image& image);

  // Uploads a white texture for the slots that have no other. A program with a wrong index then reads it instead of a
  // descriptor that was never written: undefined in Vulkan, and a crash of lavapipe.
  void addUnused();

  std::uint32_t count() const { return static_cast<std::uint32_t>(entries_.size()); }  // without the unused slots
  void bind(gpu::BindlessSet& set) const;
  std::uint64_t bytes() const { return bytes_; }

 private:
  struct Entry {
    const gpu::Image* image;
    const gpu::Sampler* sampler;
  };
  const gpu::Image& upload(const io::Image& image, bool sRgb, const std::string& name);
  // Frees the pixels of an image unless they are expected in the other encoding, too.
  void freeImage(int image, bool sRgb);
  const gpu::Sampler& sampler(const gpu::SamplerOptions& options);

  gpu::Context& context_;
  gpu::Uploader& uploader_;
  const scene::Scene& scene_;
  scene::Scene* consumed_;
  std::set<std::pair<int, bool>> expected_;
  std::deque<gpu::Image> images_;
  std::deque<std::pair<gpu::SamplerOptions, gpu::Sampler>> samplers_;
  std::map<std::pair<int, bool>, const gpu::Image*> imageByKey_;
  std::map<std::pair<int, bool>, std::uint32_t> indexByTexture_;
  std::vector<Entry> entries_;
  Entry unused_{nullptr, nullptr};
  std::uint64_t bytes_ = 0;
};

// Bindless slots after the scene's textures, shared by the parameter images of all renderers that use the scene.
class TextureSlots {
 public:
  // 64 for each of three renderers: that of a job, and two that explain a sample (job/pixel_explainer.h).
  static constexpr std::uint32_t kCount = 192;

  // Manages slots [first, first + count) of `set`, which must outlive this object.
  TextureSlots(gpu::BindlessSet& set, std::uint32_t first, std::uint32_t count);

  gpu::BindlessSet& set() { return set_; }
  // Throws UsageError if fewer slots are free.
  std::vector<std::uint32_t> acquire(std::size_t count);
  void release(std::span<const std::uint32_t> slots);

 private:
  gpu::BindlessSet& set_;
  std::vector<std::uint32_t> free_;  // a stack: the last slot is used next
};

}  // namespace quintet::render
#endif

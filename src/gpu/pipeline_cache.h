// VkPipelineCache kept on disk, one file per device and driver version. Broken or foreign files are
// ignored; writing is atomic; a folder that cannot be written costs nothing but the cache.
#ifndef QUINTET_GPU_PIPELINE_CACHE_H
#define QUINTET_GPU_PIPELINE_CACHE_H

#include <filesystem>

#include "gpu/context.h"

namespace quintet::gpu {

class PipelineCache {
 public:
  // `folder` empty: memory only.
  PipelineCache(Context& context, const std::filesystem::path& folder);
  ~PipelineCache();  // saves if it has grown
  PipelineCache(const PipelineCache&) = delete;
  PipelineCache& operator=(const PipelineCache&) = delete;
  VkPipelineCache handle() const { return handle_; }
  void save();

 private:
  Context& context_;
  std::filesystem::path file_;
  VkPipelineCache handle_ = VK_NULL_HANDLE;
  std::size_t savedBytes_ = 0;
};

}  // namespace quintet::gpu
#endif

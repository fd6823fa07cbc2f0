// SPDX-License-Identifier: Apache-2.0
// A VkPipelineCache that is stored in one file per device and driver version. Corrupt files and files of different
// devices are ignored. Files are written atomically, and a folder that cannot be written only disables the cache.
#ifndef QUINTET_GPU_PIPELINE_CACHE_H
#define QUINTET_GPU_PIPELINE_CACHE_H

#include <cstddef>
#include <filesystem>

#include "gpu/context.h"

namespace quintet::gpu {

class PipelineCache {
 public:
  // An empty `folder` keeps the cache in memory only.
  PipelineCache(Context& context, const std::filesystem::path& folder);
  ~PipelineCache();  // calls save()
  PipelineCache(const PipelineCache&) = delete;
  PipelineCache& operator=(const PipelineCache&) = delete;
  VkPipelineCache handle() const { return handle_; }
  void save();  // writes the file if the cache has grown

 private:
  Context& context_;
  std::filesystem::path file_;
  VkPipelineCache handle_ = VK_NULL_HANDLE;
  std::size_t savedBytes_ = 0;
};

}  // namespace quintet::gpu
#endif

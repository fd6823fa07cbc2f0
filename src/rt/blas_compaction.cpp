// Compaction: the device tells how small each structure can be, and copies it into one of that size.
#include <utility>

#include "gpu/error.h"
#include "rt/blas_batch.h"

namespace quintet::rt {
namespace {

class SizeQueries {
 public:
  SizeQueries(gpu::Context& context, std::uint32_t count) : context_(context) {
    VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    info.queryType = VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR;
    info.queryCount = count;
    gpu::check(context.vk().vkCreateQueryPool(context.device(), &info, nullptr, &pool_),
               "create the compaction queries");
  }
  ~SizeQueries() {
    context_.retire(
        [&context = context_, pool = pool_] { context.vk().vkDestroyQueryPool(context.device(), pool, nullptr); });
  }
  SizeQueries(const SizeQueries&) = delete;
  SizeQueries& operator=(const SizeQueries&) = delete;
  VkQueryPool pool() const { return pool_; }

 private:
  gpu::Context& context_;
  VkQueryPool pool_ = VK_NULL_HANDLE;
};

}  // namespace

std::vector<VkDeviceSize> BlasBatch::compactedSizes(std::span<Blas* const> structures) const {
  const auto count = static_cast<std::uint32_t>(structures.size());
  std::vector<VkAccelerationStructureKHR> handles;
  for (const Blas* blas : structures) handles.push_back(blas->handle_);
  const SizeQueries queries(context_, count);
  const VolkDeviceTable& vk = context_.vk();
  context_.submitAndWait([&](gpu::Commands& commands) {
    vk.vkCmdResetQueryPool(commands.handle(), queries.pool(), 0, count);
    vk.vkCmdWriteAccelerationStructuresPropertiesKHR(commands.handle(), count, handles.data(),
                                                     VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR,
                                                     queries.pool(), 0);
  });
  std::vector<VkDeviceSize> sizes(count);
  gpu::check(
      vk.vkGetQueryPoolResults(context_.device(), queries.pool(), 0, count, sizes.size() * sizeof(VkDeviceSize),
                               sizes.data(), sizeof(VkDeviceSize), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
      "read the compacted sizes");
  return sizes;
}

void BlasBatch::compact(std::span<Blas* const> structures) const {
  struct Copy {
    Blas* original;
    Blas smaller;  // owns the old structure in the end
  };
  std::vector<Copy> copies;
  const std::vector<VkDeviceSize> sizes = compactedSizes(structures);
  for (std::size_t k = 0; k < structures.size(); ++k) {
    Blas& blas = *structures[k];
    if (sizes[k] == 0 || sizes[k] >= blas.builtSize_) continue;
    Blas& smaller = copies.emplace_back(Copy{&blas, {}}).smaller;
    smaller.context_ = &context_;
    smaller.handle_ = createStructure(context_, smaller.storage_, sizes[k],
                                      VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, blas.options_.name);
  }
  context_.submitAndWait([&](gpu::Commands& commands) {
    for (const Copy& copy : copies) {
      VkCopyAccelerationStructureInfoKHR info{VK_STRUCTURE_TYPE_COPY_ACCELERATION_STRUCTURE_INFO_KHR};
      info.src = copy.original->handle_;
      info.dst = copy.smaller.handle_;
      info.mode = VK_COPY_ACCELERATION_STRUCTURE_MODE_COMPACT_KHR;
      context_.vk().vkCmdCopyAccelerationStructureKHR(commands.handle(), &info);
    }
  });
  for (Copy& copy : copies) {
    std::swap(copy.original->handle_, copy.smaller.handle_);
    std::swap(copy.original->storage_, copy.smaller.storage_);
    copy.original->address_ = structureAddress(context_, copy.original->handle_);
  }
}

}  // namespace quintet::rt

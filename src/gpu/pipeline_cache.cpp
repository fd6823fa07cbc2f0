// SPDX-License-Identifier: Apache-2.0
// File format: 8 bytes with magic and version, 16 bytes with the hash of the data, then the data of the driver. Drivers
// check only their header of 32 bytes; the hash protects them from corrupt files.
#include "gpu/pipeline_cache.h"

#include <array>
#include <cstring>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "base/file.h"
#include "base/hash.h"
#include "gpu/error.h"

namespace quintet::gpu {
namespace {

constexpr std::array<char, 8> kMagic = {'Q', 'T', 'P', 'C', '0', '0', '0', '1'};
constexpr std::size_t kPrefixBytes = kMagic.size() + sizeof(Hash);

std::filesystem::path fileIn(const std::filesystem::path& folder, const Context& context) {
  if (folder.empty()) return {};
  const DeviceInfo& info = context.info();
  const Hash name = Hasher().add(info.name).add(info.driver).add(info.uuid).finish();
  return folder / fmt::format("pipelines-{}.bin", name.hex());
}

Hash hashOf(std::span<const std::byte> data) { return Hasher().add(data).finish(); }

// Returns whether the driver of this device wrote the data (VkPipelineCacheHeaderVersionOne).
bool isForDevice(std::span<const std::byte> data, const Context& context) {
  VkPipelineCacheHeaderVersionOne header{};
  if (data.size() < sizeof header) return false;
  std::memcpy(&header, data.data(), sizeof header);
  VkPhysicalDeviceProperties device{};
  vkGetPhysicalDeviceProperties(context.physicalDevice(), &device);
  return header.headerSize >= sizeof header && header.headerVersion == VK_PIPELINE_CACHE_HEADER_VERSION_ONE &&
         header.vendorID == device.vendorID && header.deviceID == device.deviceID &&
         std::memcmp(header.pipelineCacheUUID, device.pipelineCacheUUID, VK_UUID_SIZE) == 0;
}

// Returns the driver's data; empty if the file is missing, corrupt or from a different device.
std::vector<std::byte> load(const std::filesystem::path& file, const Context& context) {
  std::error_code error;
  if (file.empty() || !std::filesystem::is_regular_file(file, error)) return {};
  std::vector<std::byte> bytes;
  try {
    bytes = readFile(file);
  } catch (const Error&) {
    return {};
  }
  if (bytes.size() < kPrefixBytes || std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0) return {};
  Hash expected;
  std::memcpy(&expected, bytes.data() + kMagic.size(), sizeof expected);
  const std::span<const std::byte> data = std::span<const std::byte>(bytes).subspan(kPrefixBytes);
  if (hashOf(data) != expected || !isForDevice(data, context)) return {};
  return {data.begin(), data.end()};
}

}  // namespace

PipelineCache::PipelineCache(Context& context, const std::filesystem::path& folder)
    : context_(context), file_(fileIn(folder, context)) {
  const std::vector<std::byte> data = load(file_, context);
  VkPipelineCacheCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  info.initialDataSize = data.size();
  info.pInitialData = data.data();
  check(context.vk().vkCreatePipelineCache(context.device(), &info, nullptr, &handle_), "create the pipeline cache");
  savedBytes_ = data.size();
}

PipelineCache::~PipelineCache() {
  save();
  context_.vk().vkDestroyPipelineCache(context_.device(), handle_, nullptr);
}

void PipelineCache::save() {
  if (file_.empty()) return;
  try {
    std::size_t size = 0;
    check(context_.vk().vkGetPipelineCacheData(context_.device(), handle_, &size, nullptr), "read the pipeline cache");
    if (size <= savedBytes_) return;
    std::vector<std::byte> bytes(kPrefixBytes + size);
    check(context_.vk().vkGetPipelineCacheData(context_.device(), handle_, &size, bytes.data() + kPrefixBytes),
          "read the pipeline cache");
    bytes.resize(kPrefixBytes + size);
    const Hash hash = hashOf(std::span<const std::byte>(bytes).subspan(kPrefixBytes));
    std::memcpy(bytes.data(), kMagic.data(), kMagic.size());
    std::memcpy(bytes.data() + kMagic.size(), &hash, sizeof hash);
    std::filesystem::create_directories(file_.parent_path());
    writeFile(file_, std::span<const std::byte>(bytes));
    savedBytes_ = size;
  } catch (const std::exception& error) {
    if (context_.log()) context_.log()(LogLevel::debug, fmt::format("pipeline cache not saved: {}", error.what()));
  }
}

}  // namespace quintet::gpu

// SPDX-License-Identifier: Apache-2.0
#include "table_capture.h"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace quintet::layer {
namespace {

constexpr std::uint32_t kMark = 0x51544B4Du;
constexpr VkDeviceSize kMaxCopy = VkDeviceSize{64} << 20;  // of one region
constexpr VkDeviceSize kAlignment = 16;
constexpr std::string_view kUnreachable = "Q801";

check::TableKind kindOf(const PipelineCopy& copy, const GroupCopy& group) {
  if (group.type != VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR) return check::TableKind::hit;
  const VkShaderStageFlagBits stage =
      group.general ? copy.stages[*group.general].stage : VK_SHADER_STAGE_CALLABLE_BIT_KHR;
  if (stage == VK_SHADER_STAGE_RAYGEN_BIT_KHR) return check::TableKind::rayGeneration;
  return stage == VK_SHADER_STAGE_MISS_BIT_KHR ? check::TableKind::miss : check::TableKind::callable;
}

}  // namespace

TableCapture::~TableCapture() {
  poll();
  for (const Copy& copy : copies_) destroy(copy);
}

VkBufferUsageFlags TableCapture::usageFor(VkBufferUsageFlags usage) {
  constexpr VkBufferUsageFlags kRead = VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR |
                                       VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR;
  return (usage & kRead) != 0 ? usage | VK_BUFFER_USAGE_TRANSFER_SRC_BIT : usage;
}

void TableCapture::addBuffer(VkBuffer buffer, VkDeviceSize bytes) {
  const std::scoped_lock lock(mutex_);
  buffers_[buffer] = {bytes, 0};
}

void TableCapture::addAddress(VkBuffer buffer, VkDeviceAddress address) {
  const std::scoped_lock lock(mutex_);
  const auto found = buffers_.find(buffer);
  if (found == buffers_.end() || address == 0) return;
  found->second.address = address;
  addresses_[address] = buffer;
}

void TableCapture::removeBuffer(VkBuffer buffer) {
  const std::scoped_lock lock(mutex_);
  const auto found = buffers_.find(buffer);
  if (found == buffers_.end()) return;
  if (found->second.address != 0) addresses_.erase(found->second.address);
  buffers_.erase(found);
}

void TableCapture::removePipeline(VkPipeline pipeline) {
  poll();
  const std::scoped_lock lock(mutex_);
  groups_.erase(pipeline);
  const std::string prefix = fmt::format("{:#x} ", numberOf(pipeline));
  std::erase_if(linked_, [&](const std::string& key) { return key.starts_with(prefix); });
}

std::optional<TableCapture::Found> TableCapture::find(VkDeviceAddress address) const {
  auto after = addresses_.upper_bound(address);
  if (after == addresses_.begin()) return {};
  const auto& [start, buffer] = *--after;
  const VkDeviceSize bytes = buffers_.at(buffer).bytes;
  if (address - start >= bytes) return {};
  return Found{buffer, address - start, bytes - (address - start)};
}

// Records copies of the parts, one after the other, and the mark. Returns false without memory.
bool TableCapture::record(Copy& copy, const std::vector<Part>& parts) {
  const DeviceTable& vk = device_.table;
  VkDeviceSize total = 0;
  for (const Part& part : parts) total += (part.bytes + kAlignment - 1) / kAlignment * kAlignment;
  copy.markOffset = total;
  VkBufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = total + kAlignment;
  info.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  if (vk.CreateBuffer(device_.handle, &info, nullptr, &copy.buffer) != VK_SUCCESS) return false;
  VkMemoryRequirements needs{};
  vk.GetBufferMemoryRequirements(device_.handle, copy.buffer, &needs);
  VkMemoryAllocateInfo allocate{};
  allocate.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  allocate.allocationSize = needs.size;
  constexpr VkMemoryPropertyFlags kFlags = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  bool found = false;
  for (std::uint32_t i = 0; i < device_.memory.memoryTypeCount && !found; ++i) {
    found = (needs.memoryTypeBits >> i & 1u) != 0 && (device_.memory.memoryTypes[i].propertyFlags & kFlags) == kFlags;
    allocate.memoryTypeIndex = i;
  }
  void* mapped = nullptr;
  if (!found || vk.AllocateMemory(device_.handle, &allocate, nullptr, &copy.memory) != VK_SUCCESS ||
      vk.BindBufferMemory(device_.handle, copy.buffer, copy.memory, 0) != VK_SUCCESS ||
      vk.MapMemory(device_.handle, copy.memory, 0, VK_WHOLE_SIZE, 0, &mapped) != VK_SUCCESS) {
    destroy(copy);
    return false;
  }
  copy.mapped = static_cast<std::byte*>(mapped);
  std::memset(copy.mapped, 0, static_cast<std::size_t>(info.size));
  const auto barrier = [&](VkPipelineStageFlags from, VkAccessFlags written, VkPipelineStageFlags to,
                           VkAccessFlags read) {
    VkMemoryBarrier memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER, nullptr, written, read};
    vk.CmdPipelineBarrier(copy.commands, from, to, 0, 1, &memory, 0, nullptr, 0, nullptr);
  };
  constexpr VkPipelineStageFlags kAll = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, kCopy = VK_PIPELINE_STAGE_TRANSFER_BIT;
  barrier(kAll, VK_ACCESS_MEMORY_WRITE_BIT, kCopy, VK_ACCESS_TRANSFER_READ_BIT);
  VkDeviceSize at = 0;
  for (const Part& part : parts) {
    const VkBufferCopy region{part.from, at, part.bytes};
    vk.CmdCopyBuffer(copy.commands, part.source, copy.buffer, 1, &region);
    at += (part.bytes + kAlignment - 1) / kAlignment * kAlignment;
  }
  barrier(kCopy, VK_ACCESS_TRANSFER_WRITE_BIT, kCopy, VK_ACCESS_TRANSFER_WRITE_BIT);
  vk.CmdFillBuffer(copy.commands, copy.buffer, total, 4, kMark);
  barrier(kCopy, VK_ACCESS_TRANSFER_WRITE_BIT, kAll | VK_PIPELINE_STAGE_HOST_BIT,
          VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT | VK_ACCESS_HOST_READ_BIT);
  return true;
}

void TableCapture::destroy(const Copy& copy) const {
  device_.table.DestroyBuffer(device_.handle, copy.buffer, nullptr);
  device_.table.FreeMemory(device_.handle, copy.memory, nullptr);
}

void TableCapture::trace(VkCommandBuffer commands,
                         const std::array<VkStridedDeviceAddressRegionKHR, check::kTableKinds>& regions) {
  Copy copy;
  copy.commands = commands;
  copy.pipeline = device_.boundPipeline(commands);
  if (!copy.pipeline) return;
  const std::scoped_lock lock(mutex_);
  std::vector<Part> parts;
  std::size_t at = 0;
  for (std::size_t i = 0; i < check::kTableKinds; ++i) {
    check::TableRegion& region = copy.regions[i];
    region = {regions[i].deviceAddress, regions[i].stride, regions[i].size, {}, {}};
    const auto found = find(region.address);
    if (!found || region.bytes == 0) continue;
    region.available = found->available;
    const VkDeviceSize bytes = std::min({region.bytes, found->available, kMaxCopy});
    parts.push_back({found->buffer, found->offset, bytes});
    copy.data[i] = {at, static_cast<std::size_t>(bytes)};
    at += static_cast<std::size_t>((bytes + kAlignment - 1) / kAlignment * kAlignment);
  }
  if (record(copy, parts)) copies_.push_back(std::move(copy));
}

void TableCapture::build(VkCommandBuffer commands, std::uint32_t count,
                         const VkAccelerationStructureBuildGeometryInfoKHR* infos,
                         const VkAccelerationStructureBuildRangeInfoKHR* const* ranges) {
  const std::scoped_lock lock(mutex_);
  for (std::uint32_t i = 0; i < count; ++i) {
    const VkAccelerationStructureBuildGeometryInfoKHR& info = infos[i];
    const auto geometry = [&](std::uint32_t g) -> const VkAccelerationStructureGeometryKHR& {
      return info.pGeometries ? info.pGeometries[g] : *info.ppGeometries[g];
    };
    tops_.erase(info.dstAccelerationStructure);
    bottoms_.erase(info.dstAccelerationStructure);
    if (info.type == VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR) {
      Bottom bottom;
      for (std::uint32_t g = 0; g < info.geometryCount; ++g) {
        program::GeometryFacts facts;
        if (geometry(g).geometryType == VK_GEOMETRY_TYPE_AABBS_KHR) facts.kind = program::GeometryKind::custom;
        facts.alpha = (geometry(g).flags & VK_GEOMETRY_OPAQUE_BIT_KHR) == 0;
        bottom.geometries.push_back(facts);
      }
      bottoms_[info.dstAccelerationStructure] = std::move(bottom);
      continue;
    }
    if (info.geometryCount != 1 || geometry(0).geometryType != VK_GEOMETRY_TYPE_INSTANCES_KHR ||
        geometry(0).geometry.instances.arrayOfPointers)
      continue;
    Copy copy;
    copy.commands = commands;
    copy.structure = info.dstAccelerationStructure;
    copy.instances = ranges[i][0].primitiveCount;
    const VkDeviceSize bytes = copy.instances * sizeof(VkAccelerationStructureInstanceKHR);
    const auto found = find(geometry(0).geometry.instances.data.deviceAddress + ranges[i][0].primitiveOffset);
    if (!found || bytes == 0 || bytes > std::min(found->available, kMaxCopy)) continue;
    if (record(copy, {{found->buffer, found->offset, bytes}})) copies_.push_back(std::move(copy));
  }
}

void TableCapture::copyStructure(VkAccelerationStructureKHR from, VkAccelerationStructureKHR to) {
  const std::scoped_lock lock(mutex_);
  if (const auto found = bottoms_.find(from); found != bottoms_.end()) bottoms_[to] = found->second;
  if (const auto found = tops_.find(from); found != tops_.end()) tops_[to] = found->second;
}

void TableCapture::removeStructure(VkAccelerationStructureKHR structure) {
  const std::scoped_lock lock(mutex_);
  bottoms_.erase(structure);
  tops_.erase(structure);
}

void TableCapture::addCommands(VkCommandPool pool, std::uint32_t count, const VkCommandBuffer* commands) {
  const std::scoped_lock lock(mutex_);
  for (std::uint32_t i = 0; i < count; ++i) pools_[commands[i]] = pool;
}

void TableCapture::release(VkCommandBuffer commands) {
  poll();
  const std::scoped_lock lock(mutex_);
  std::erase_if(copies_, [&](const Copy& copy) {
    if (copy.commands != commands) return false;
    destroy(copy);
    return true;
  });
}

void TableCapture::releasePool(VkCommandPool pool) {
  std::vector<VkCommandBuffer> commands;
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& [buffer, owner] : pools_)
      if (owner == pool) commands.push_back(buffer);
  }
  for (const VkCommandBuffer buffer : commands) release(buffer);
}

void TableCapture::poll() {
  std::vector<std::pair<Copy, std::vector<std::byte>>> complete;
  {
    const std::scoped_lock lock(mutex_);
    for (Copy& copy : copies_) {
      std::uint32_t mark = 0;
      std::memcpy(&mark, copy.mapped + copy.markOffset, sizeof mark);
      if (mark != kMark) continue;
      complete.emplace_back(copy, std::vector<std::byte>(copy.mapped, copy.mapped + copy.markOffset));
      std::memset(copy.mapped + copy.markOffset, 0, sizeof mark);  // the commands can be submitted again
    }
  }
  // Instances first: the traces after them use them.
  std::stable_partition(complete.begin(), complete.end(),
                        [](const auto& entry) { return entry.first.pipeline == nullptr; });
  for (auto& [copy, bytes] : complete) finish(std::move(copy), std::move(bytes));
}

void TableCapture::finish(Copy copy, std::vector<std::byte> bytes) {
  if (copy.pipeline)
    finishTrace(copy, bytes);
  else
    finishBuild(copy, bytes);
}

void TableCapture::finishBuild(const Copy& copy, const std::vector<std::byte>& bytes) {
  std::vector<VkAccelerationStructureInstanceKHR> instances(copy.instances);
  std::memcpy(instances.data(), bytes.data(),
              std::min(bytes.size(), instances.size() * sizeof(VkAccelerationStructureInstanceKHR)));
  const std::scoped_lock lock(mutex_);
  tops_[copy.structure] = std::move(instances);
}

void TableCapture::finishTrace(const Copy& copy, const std::vector<std::byte>& bytes) {
  std::array<check::TableRegion, check::kTableKinds> regions = copy.regions;
  for (std::size_t i = 0; i < check::kTableKinds; ++i) {
    const auto [offset, count] = copy.data[i];
    regions[i].data.assign(bytes.begin() + static_cast<std::ptrdiff_t>(offset),
                           bytes.begin() + static_cast<std::ptrdiff_t>(offset + count));
  }
  const check::TableFindings found = check::checkTable(regions, groupsOf(*copy.pipeline), device_.tableLimits);
  device_.deliver(*copy.pipeline);
  device_.report(found.diagnostics, *copy.pipeline);
  if (found.complete && found.diagnostics.empty()) link(*copy.pipeline, found);
}

const std::vector<check::TableGroup>& TableCapture::groupsOf(LinkedPipeline& pipeline) {
  {
    const std::scoped_lock lock(mutex_);
    if (const auto found = groups_.find(pipeline.handle); found != groups_.end()) return found->second;
  }
  device_.deliver(pipeline);  // its results are complete
  const PipelineCopy& copy = pipeline.copy;
  const std::size_t bytes = device_.tableLimits.handleBytes;
  std::vector<std::byte> handles(bytes * copy.groups.size());
  std::vector<check::TableGroup> groups;
  const bool known = device_.table.GetRayTracingShaderGroupHandlesKHR &&
                     device_.table.GetRayTracingShaderGroupHandlesKHR(device_.handle, pipeline.handle, 0,
                                                                      static_cast<std::uint32_t>(copy.groups.size()),
                                                                      handles.size(), handles.data()) == VK_SUCCESS;
  for (std::size_t g = 0; known && g < copy.groups.size(); ++g) {
    const GroupCopy& group = copy.groups[g];
    check::TableGroup added;
    added.kind = kindOf(copy, group);
    added.name = fmt::format("group {} ({})", g, check::tableName(added.kind));
    added.handle.assign(handles.begin() + static_cast<std::ptrdiff_t>(g * bytes),
                        handles.begin() + static_cast<std::ptrdiff_t>((g + 1) * bytes));
    for (const auto& stage : {group.general, group.closestHit, group.anyHit, group.intersection})
      if (stage) added.recordBytes = std::max(added.recordBytes, pipeline.recordBytes[*stage]);
    groups.push_back(std::move(added));
  }
  const std::scoped_lock lock(mutex_);
  return groups_[pipeline.handle] = std::move(groups);
}

// Links the pipeline again with the table and the instances. Reports what the link without them could not know.
void TableCapture::link(LinkedPipeline& pipeline, const check::TableFindings& found) {
  const std::vector<check::TableGroup>& table = groupsOf(pipeline);
  check::PipelineGroups groups = pipeline.groups;
  std::string key = fmt::format("{:#x}", numberOf(pipeline.handle));
  // The position of a group in PipelineGroups: the lists have the groups of one kind in their order.
  const auto position = [&](std::size_t group) {
    return static_cast<std::size_t>(
        std::ranges::count_if(table.begin(), table.begin() + static_cast<std::ptrdiff_t>(group),
                              [&](const check::TableGroup& other) { return other.kind == table[group].kind; }));
  };
  const auto select = [&](check::TableKind kind, auto& list) {
    const auto all = list;
    list.clear();
    key += fmt::format(" {}", check::tableName(kind));
    for (const auto& record : found.records[static_cast<std::size_t>(kind)]) {
      list.emplace_back();
      key += record ? fmt::format(" {}", *record) : " -";
      if (record && position(*record) < all.size()) list.back() = all[position(*record)];
    }
  };
  select(check::TableKind::miss, groups.misses);
  select(check::TableKind::hit, groups.hitGroups);
  select(check::TableKind::callable, groups.callables);
  for (program::HitGroup& hit : groups.hitGroups) hit.shaders.try_emplace("");
  groups.tablesKnown = true;
  addInstances(groups);
  if (groups.instances)
    for (const check::InstanceRecords& instance : *groups.instances)
      key += fmt::format(" {}:{}:{}", instance.recordOffset, instance.facts.mask, instance.facts.geometryCount);
  {
    const std::scoped_lock lock(mutex_);
    if (!linked_.insert(key).second) return;
  }
  const std::vector<Diagnostic>& known = pipeline.result.diagnostics;
  std::vector<Diagnostic> added = check::checkModules(groups, pipeline.modules, device_.limits).diagnostics;
  // A table need not reach all stages: a pipeline can be for more than one scene.
  std::erase_if(added, [&](const Diagnostic& d) {
    return d.id == kUnreachable || std::ranges::any_of(known, [&](const Diagnostic& k) {
             return k.id == d.id && k.file == d.file && k.line == d.line;
           });
  });
  check::Suppressions(pipeline.sources).apply(added);
  device_.report(std::move(added), pipeline);
}

// Only if there is one top-level structure: which one a trace uses is in the descriptors.
void TableCapture::addInstances(check::PipelineGroups& groups) {
  const std::scoped_lock lock(mutex_);
  if (tops_.size() != 1) return;
  std::unordered_map<std::uint64_t, std::pair<std::uint32_t, std::uint32_t>> ranges;  // by address
  for (const auto& [structure, bottom] : bottoms_) {
    VkAccelerationStructureDeviceAddressInfoKHR info{};
    info.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR;
    info.accelerationStructure = structure;
    const VkDeviceAddress address = device_.table.GetAccelerationStructureDeviceAddressKHR(device_.handle, &info);
    ranges[address] = {static_cast<std::uint32_t>(groups.geometries.size()),
                       static_cast<std::uint32_t>(bottom.geometries.size())};
    groups.geometries.insert(groups.geometries.end(), bottom.geometries.begin(), bottom.geometries.end());
  }
  std::vector<check::InstanceRecords> instances;
  for (const VkAccelerationStructureInstanceKHR& raw : tops_.begin()->second) {
    if (raw.accelerationStructureReference == 0) continue;  // inactive
    const auto range = ranges.find(raw.accelerationStructureReference);
    if (range == ranges.end()) return;  // built elsewhere
    check::InstanceRecords instance;
    instance.facts.name = std::to_string(&raw - tops_.begin()->second.data());
    instance.facts.firstGeometry = range->second.first;
    instance.facts.geometryCount = range->second.second;
    instance.facts.mask = raw.mask;
    instance.facts.customIndex = raw.instanceCustomIndex;
    instance.facts.forceOpaque = (raw.flags & VK_GEOMETRY_INSTANCE_FORCE_OPAQUE_BIT_KHR) != 0;
    instance.facts.forceNoOpaque = (raw.flags & VK_GEOMETRY_INSTANCE_FORCE_NO_OPAQUE_BIT_KHR) != 0;
    constexpr VkTransformMatrixKHR kIdentity{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    instance.facts.transformed = std::memcmp(&raw.transform, &kIdentity, sizeof kIdentity) != 0;
    instance.recordOffset = raw.instanceShaderBindingTableRecordOffset;
    instances.push_back(std::move(instance));
  }
  groups.instances = std::move(instances);
}

}  // namespace quintet::layer

// SPDX-License-Identifier: Apache-2.0
#include "table_capture.h"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/hash.h"

namespace quintet::layer {
namespace {

constexpr std::uint32_t kMark = 0x51544B4Du;
constexpr VkDeviceSize kMaxCopy = VkDeviceSize{64} << 20;  // of one region
constexpr VkDeviceSize kMaxTable = VkDeviceSize{4} << 20;  // of a buffer that an indirect trace can use
constexpr VkDeviceSize kAlignment = 16;                    // of parts in a copy
constexpr std::string_view kUnreachable = "Q801";
// An application can change the data of its records for each trace. Later contents are not checked.
constexpr std::size_t kMaxContents = 16;

VkDeviceSize aligned(VkDeviceSize bytes) { return (bytes + kAlignment - 1) / kAlignment * kAlignment; }

check::TableKind kindOf(const PipelineCopy& copy, const GroupCopy& group) {
  if (group.type != VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR) return check::TableKind::hit;
  const VkShaderStageFlagBits stage =
      group.general ? copy.stages[*group.general].stage : VK_SHADER_STAGE_CALLABLE_BIT_KHR;
  if (stage == VK_SHADER_STAGE_RAYGEN_BIT_KHR) return check::TableKind::rayGeneration;
  return stage == VK_SHADER_STAGE_MISS_BIT_KHR ? check::TableKind::miss : check::TableKind::callable;
}

std::optional<std::string> rayGenerationOf(const LinkedPipeline& pipeline, const check::TableFindings& found) {
  const auto& records = found.records[static_cast<std::size_t>(check::TableKind::rayGeneration)];
  if (records.empty() || !records.front()) return {};
  const std::optional<std::size_t>& stage = pipeline.copy.groups[*records.front()].general;
  return stage ? std::optional(pipeline.stages.of(*stage).name) : std::nullopt;
}

// The modules of the stages that the groups have.
std::vector<check::ModuleStage> usedModules(const std::vector<check::ModuleStage>& modules,
                                            const check::PipelineGroups& groups) {
  std::set<std::string_view> names(groups.rayGenerations.begin(), groups.rayGenerations.end());
  for (const program::MissShader& miss : groups.misses) names.insert(miss.file);
  for (const program::Callable& callable : groups.callables) names.insert(callable.file);
  for (const program::HitGroup& group : groups.hitGroups)
    for (const auto& [ray, shaders] : group.shaders)
      names.insert({shaders.closestHit, shaders.anyHit, shaders.intersection});
  std::vector<check::ModuleStage> used;
  for (const check::ModuleStage& module : modules)
    if (names.contains(module.name)) used.push_back(module);
  return used;
}

std::string contentKey(const check::TableData& data) {
  Hasher hasher;
  for (const auto& [stage, bytes] : data.rayGeneration) hasher.add(bytes);
  for (const auto* table : {&data.misses, &data.hits, &data.callables}) {
    hasher.add(table->size());
    for (const check::RecordData& bytes : *table) hasher.add(bytes);
  }
  return " " + hasher.finish().hex();
}

const VkAccelerationStructureGeometryKHR& geometryOf(const VkAccelerationStructureBuildGeometryInfoKHR& info,
                                                     std::uint32_t g) {
  return info.pGeometries ? info.pGeometries[g] : *info.ppGeometries[g];
}

// The instances of a top-level structure; null if the build is invalid.
const VkAccelerationStructureGeometryInstancesDataKHR* instancesOf(
    const VkAccelerationStructureBuildGeometryInfoKHR& info) {
  if (info.geometryCount != 1 || geometryOf(info, 0).geometryType != VK_GEOMETRY_TYPE_INSTANCES_KHR) return nullptr;
  return &geometryOf(info, 0).geometry.instances;
}

}  // namespace

ReadableBuffer::ReadableBuffer(const VkBufferCreateInfo& info) : info_(info), usage_(info.usage) {
  constexpr VkBufferUsageFlags kRead = VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR |
                                       VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR |
                                       VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;
  constexpr VkBufferCreateFlags kProtected = VK_BUFFER_CREATE_PROTECTED_BIT;
  const auto* usage2 = findInChain<Flags2>(info.pNext, kBufferUsage2);
  if (usage2) usage_ = static_cast<VkBufferUsageFlags>(usage2->flags);
  if ((usage_ & kRead) == 0 || (info.flags & kProtected) != 0) return;
  if (!usage2) {
    info_.usage = usage_ |= VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
  } else if (usage2 == info.pNext) {  // a chain of unknown structures cannot be copied
    usage_ |= VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
    flags2_ = *usage2;
    flags2_.flags |= VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
    info_.pNext = &flags2_;
  }
}

TableCapture::~TableCapture() {
  poll();
  for (const Copy& copy : copies_) destroy(copy);
}

void TableCapture::addBuffer(VkBuffer buffer, VkDeviceSize bytes, VkBufferUsageFlags usage) {
  const std::scoped_lock lock(mutex_);
  buffers_[buffer] = {bytes, usage, 0};
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
  std::erase_if(linkedData_, [&](const auto& entry) { return entry.first.starts_with(prefix); });
}

std::optional<TableCapture::Found> TableCapture::find(VkDeviceAddress address) const {
  auto after = addresses_.upper_bound(address);
  if (after == addresses_.begin()) return {};
  const auto& [start, buffer] = *--after;
  const Buffer& found = buffers_.at(buffer);
  if (address - start >= found.bytes) return {};
  return Found{buffer, address - start, found.bytes - (address - start), found.readable()};
}

// Records copies of the parts, one after the other, and the mark. Returns false without memory.
bool TableCapture::record(Copy& copy, const std::vector<Part>& parts) {
  const DeviceTable& vk = device_.table;
  VkDeviceSize total = 0;
  for (const Part& part : parts) total += aligned(part.bytes);
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
    at += aligned(part.bytes);
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
  if (!copy.pipeline || !copy.pipeline->copy.isComplete) return;
  copy.descriptors = device_.descriptors.withBoundSets(copy.pipeline->copy.descriptors, commands);
  const std::scoped_lock lock(mutex_);
  std::vector<Part> parts;
  std::size_t at = 0;
  for (std::size_t i = 0; i < check::kTableKinds; ++i) {
    check::TableRegion& region = copy.regions[i];
    region = {regions[i].deviceAddress, regions[i].stride, regions[i].size, {}, {}};
    const auto found = find(region.address);
    if (!found || region.bytes == 0) continue;
    region.available = found->available;
    if (!found->readable) continue;
    const VkDeviceSize bytes = std::min({region.bytes, found->available, kMaxCopy});
    parts.push_back({found->buffer, found->offset, bytes});
    copy.data[i] = {at, static_cast<std::size_t>(bytes)};
    at += static_cast<std::size_t>(aligned(bytes));
  }
  if (record(copy, parts)) copies_.push_back(std::move(copy));
}

void TableCapture::traceIndirect(VkCommandBuffer commands, VkDeviceAddress address) {
  Copy copy;
  copy.commands = commands;
  copy.pipeline = device_.boundPipeline(commands);
  if (!copy.pipeline || !copy.pipeline->copy.isComplete) return;
  copy.descriptors = device_.descriptors.withBoundSets(copy.pipeline->copy.descriptors, commands);
  const std::scoped_lock lock(mutex_);
  const auto command = find(address);
  if (!command || !command->readable || command->available < sizeof(VkTraceRaysIndirectCommand2KHR)) return;
  copy.isIndirect = true;
  std::vector<Part> parts{{command->buffer, command->offset, sizeof(VkTraceRaysIndirectCommand2KHR)}};
  VkDeviceSize at = aligned(parts[0].bytes);
  for (const auto& [start, buffer] : addresses_) {
    const Buffer& table = buffers_.at(buffer);
    const bool isTable = (table.usage & VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR) != 0;
    if (!isTable || !table.readable() || table.bytes > kMaxTable || at + table.bytes > kMaxCopy) continue;
    parts.push_back({buffer, 0, table.bytes});
    copy.tables.push_back({start, table.bytes, static_cast<std::size_t>(at)});
    at += aligned(table.bytes);
  }
  if (record(copy, parts)) copies_.push_back(std::move(copy));
}

// The regions of an indirect trace, from the command that the device used.
void TableCapture::readCommand(const Copy& copy, const std::vector<std::byte>& bytes, Regions& regions) {
  VkTraceRaysIndirectCommand2KHR command{};
  std::memcpy(&command, bytes.data(), sizeof command);
  const auto region = [](VkDeviceAddress address, VkDeviceSize stride, VkDeviceSize size) {
    return check::TableRegion{address, stride, size, {}, {}};
  };
  regions = {region(command.raygenShaderRecordAddress, command.raygenShaderRecordSize, command.raygenShaderRecordSize),
             region(command.missShaderBindingTableAddress, command.missShaderBindingTableStride,
                    command.missShaderBindingTableSize),
             region(command.hitShaderBindingTableAddress, command.hitShaderBindingTableStride,
                    command.hitShaderBindingTableSize),
             region(command.callableShaderBindingTableAddress, command.callableShaderBindingTableStride,
                    command.callableShaderBindingTableSize)};
  for (check::TableRegion& found : regions) {
    for (const CopiedTable& table : copy.tables) {
      if (found.address < table.address || found.address - table.address >= table.bytes) continue;
      const std::uint64_t offset = found.address - table.address;
      found.available = table.bytes - offset;
      const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(table.offset + offset);
      found.data.assign(begin, begin + static_cast<std::ptrdiff_t>(std::min(found.bytes, *found.available)));
    }
  }
}

TableCapture::Bottom TableCapture::bottomOf(const VkAccelerationStructureBuildGeometryInfoKHR& info) {
  Bottom bottom;
  for (std::uint32_t g = 0; g < info.geometryCount; ++g) {
    const VkAccelerationStructureGeometryKHR& geometry = geometryOf(info, g);
    program::GeometryFacts facts;
    if (geometry.geometryType == VK_GEOMETRY_TYPE_AABBS_KHR) facts.kind = program::GeometryKind::custom;
    facts.alpha = (geometry.flags & VK_GEOMETRY_OPAQUE_BIT_KHR) == 0;
    bottom.geometries.push_back(facts);
  }
  return bottom;
}

void TableCapture::addStructure(VkAccelerationStructureKHR structure, VkAccelerationStructureTypeKHR type) {
  const std::scoped_lock lock(mutex_);
  // The type of a generic structure is known when it is built.
  if (type != VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR) topLevel_.insert(structure);
}

bool TableCapture::buildBottom(const VkAccelerationStructureBuildGeometryInfoKHR& info) {
  if (info.type != VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR) return false;
  tops_.erase(info.dstAccelerationStructure);
  topLevel_.erase(info.dstAccelerationStructure);
  bottoms_[info.dstAccelerationStructure] = bottomOf(info);
  return true;
}

void TableCapture::buildIndirect(std::uint32_t count, const VkAccelerationStructureBuildGeometryInfoKHR* infos) {
  const std::scoped_lock lock(mutex_);
  for (std::uint32_t i = 0; i < count; ++i)
    if (!buildBottom(infos[i])) tops_.erase(infos[i].dstAccelerationStructure);
}

void TableCapture::buildOnHost(std::uint32_t count, const VkAccelerationStructureBuildGeometryInfoKHR* infos,
                               const VkAccelerationStructureBuildRangeInfoKHR* const* ranges) {
  const std::scoped_lock lock(mutex_);
  for (std::uint32_t i = 0; i < count; ++i) {
    const VkAccelerationStructureBuildGeometryInfoKHR& info = infos[i];
    if (buildBottom(info)) continue;
    const VkAccelerationStructureGeometryInstancesDataKHR* data = instancesOf(info);
    if (!data || !data->data.hostAddress) {
      tops_.erase(info.dstAccelerationStructure);
      continue;
    }
    const auto* bytes = static_cast<const std::byte*>(data->data.hostAddress) + ranges[i][0].primitiveOffset;
    Top top{std::vector<VkAccelerationStructureInstanceKHR>(ranges[i][0].primitiveCount), true};
    for (std::size_t k = 0; k < top.instances.size(); ++k) {
      const void* from = bytes + k * sizeof(VkAccelerationStructureInstanceKHR);
      if (data->arrayOfPointers) std::memcpy(&from, bytes + k * sizeof from, sizeof from);
      std::memcpy(&top.instances[k], from, sizeof(VkAccelerationStructureInstanceKHR));
    }
    setTop(info.dstAccelerationStructure, std::move(top));
  }
}

void TableCapture::forgetStructure(VkAccelerationStructureKHR structure) {
  const std::scoped_lock lock(mutex_);
  tops_.erase(structure);
  bottoms_.erase(structure);
}

void TableCapture::setTop(VkAccelerationStructureKHR structure, Top top) {
  if (const auto found = tops_.find(structure); found != tops_.end()) replaced_.push_back(std::move(found->second));
  tops_[structure] = std::move(top);
}

void TableCapture::build(VkCommandBuffer commands, std::uint32_t count,
                         const VkAccelerationStructureBuildGeometryInfoKHR* infos,
                         const VkAccelerationStructureBuildRangeInfoKHR* const* ranges) {
  const std::scoped_lock lock(mutex_);
  for (std::uint32_t i = 0; i < count; ++i) {
    const VkAccelerationStructureBuildGeometryInfoKHR& info = infos[i];
    if (buildBottom(info)) continue;
    // The instances of the last build count until this one is complete, unless they stay unknown.
    const auto forget = [&] { tops_.erase(info.dstAccelerationStructure); };
    const VkAccelerationStructureGeometryInstancesDataKHR* data = instancesOf(info);
    if (!data || data->arrayOfPointers) {
      forget();
      continue;
    }
    Copy copy;
    copy.commands = commands;
    copy.structure = info.dstAccelerationStructure;
    copy.instances = ranges[i][0].primitiveCount;
    const VkDeviceSize bytes = copy.instances * sizeof(VkAccelerationStructureInstanceKHR);
    const auto found = find(data->data.deviceAddress + ranges[i][0].primitiveOffset);
    const bool known = found && found->readable && bytes > 0 && bytes <= std::min(found->available, kMaxCopy);
    if (known && record(copy, {{found->buffer, found->offset, bytes}}))
      copies_.push_back(std::move(copy));
    else
      forget();
  }
}

void TableCapture::copyStructure(VkAccelerationStructureKHR from, VkAccelerationStructureKHR to) {
  const std::scoped_lock lock(mutex_);
  tops_.erase(to);
  bottoms_.erase(to);
  if (const auto found = bottoms_.find(from); found != bottoms_.end()) {
    bottoms_[to] = found->second;
    topLevel_.erase(to);
  }
  if (const auto found = tops_.find(from); found != tops_.end()) tops_[to] = found->second;
}

void TableCapture::removeStructure(VkAccelerationStructureKHR structure) {
  const std::scoped_lock lock(mutex_);
  bottoms_.erase(structure);
  tops_.erase(structure);
  topLevel_.erase(structure);
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
  const std::scoped_lock lock(mutex_);
  replaced_.clear();
}

void TableCapture::finish(Copy copy, std::vector<std::byte> bytes) {
  if (copy.pipeline)
    finishTrace(copy, bytes);
  else
    finishBuild(copy, bytes);
}

void TableCapture::finishBuild(const Copy& copy, const std::vector<std::byte>& bytes) {
  Top top{std::vector<VkAccelerationStructureInstanceKHR>(copy.instances), false};
  std::memcpy(top.instances.data(), bytes.data(),
              std::min(bytes.size(), top.instances.size() * sizeof(VkAccelerationStructureInstanceKHR)));
  const std::scoped_lock lock(mutex_);
  setTop(copy.structure, std::move(top));
}

void TableCapture::finishTrace(const Copy& copy, const std::vector<std::byte>& bytes) {
  Regions regions = copy.regions;
  if (copy.isIndirect) readCommand(copy, bytes, regions);
  for (std::size_t i = 0; !copy.isIndirect && i < check::kTableKinds; ++i) {
    const auto [offset, count] = copy.data[i];
    regions[i].data.assign(bytes.begin() + static_cast<std::ptrdiff_t>(offset),
                           bytes.begin() + static_cast<std::ptrdiff_t>(offset + count));
  }
  const check::TableFindings found = check::checkTable(regions, groupsOf(*copy.pipeline), device_.tableLimits);
  device_.deliver(*copy.pipeline);
  device_.report(found.diagnostics, *copy.pipeline);
  if (found.complete && found.diagnostics.empty()) link(copy, found, regions);
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
      if (stage)
        added.recordBytes = std::max(added.recordBytes, pipeline.stages.recordBytes[pipeline.stages.ofStage[*stage]]);
    groups.push_back(std::move(added));
  }
  const std::scoped_lock lock(mutex_);
  return groups_[pipeline.handle] = std::move(groups);
}

// What follows the handles of the records.
check::TableData TableCapture::dataOf(const check::TableFindings& found, const Regions& regions,
                                      const std::optional<std::string>& rayGeneration) const {
  const std::size_t handle = device_.tableLimits.handleBytes;
  const auto recordsOf = [&](check::TableKind kind) {
    const check::TableRegion& region = regions[static_cast<std::size_t>(kind)];
    std::vector<check::RecordData> records(found.records[static_cast<std::size_t>(kind)].size());
    const std::uint64_t stride = kind == check::TableKind::rayGeneration ? region.bytes : region.stride;
    for (std::size_t i = 0; i < records.size() && stride > handle; ++i) {
      const auto begin = region.data.begin() + static_cast<std::ptrdiff_t>(i * stride);
      records[i].assign(begin + static_cast<std::ptrdiff_t>(handle), begin + static_cast<std::ptrdiff_t>(stride));
    }
    return records;
  };
  check::TableData data{
      {}, recordsOf(check::TableKind::miss), recordsOf(check::TableKind::hit), recordsOf(check::TableKind::callable)};
  const auto generation = recordsOf(check::TableKind::rayGeneration);
  if (rayGeneration && !generation.empty()) data.rayGeneration[*rayGeneration] = generation.front();
  return data;
}

// Links the pipeline again with the table and the instances. Reports what the link without them could not know.
void TableCapture::link(const Copy& copy, const check::TableFindings& found, const Regions& regions) {
  LinkedPipeline& pipeline = *copy.pipeline;
  // The rules compare traces with records, and shaders with one another.
  if (std::ranges::any_of(found.records,
                          [](const auto& records) { return records.size() > check::kMaxTableWithoutGaps; }))
    return;
  const std::vector<check::TableGroup>& table = groupsOf(pipeline);
  check::PipelineGroups groups = pipeline.groups;
  std::string key = fmt::format("{:#x}", numberOf(pipeline.handle));
  // The positions of the groups in PipelineGroups: the lists have the groups of one kind in their order.
  std::vector<std::size_t> positions;
  std::array<std::size_t, check::kTableKinds> counts{};
  for (const check::TableGroup& group : table) positions.push_back(counts[static_cast<std::size_t>(group.kind)]++);
  const auto select = [&](check::TableKind kind, auto& list) {
    const auto all = list;
    list.clear();
    key += fmt::format(" {}", check::tableName(kind));
    for (const auto& record : found.records[static_cast<std::size_t>(kind)]) {
      list.emplace_back();
      key += record ? fmt::format(" {}", *record) : " -";
      if (record && positions[*record] < all.size()) list.back() = all[positions[*record]];
    }
  };
  select(check::TableKind::miss, groups.misses);
  select(check::TableKind::hit, groups.hitGroups);
  select(check::TableKind::callable, groups.callables);
  for (program::HitGroup& hit : groups.hitGroups) hit.shaders.try_emplace("");
  // A pipeline can have several ray generation shaders, each with tables of its own.
  const std::optional<std::string> generation = rayGenerationOf(pipeline, found);
  if (generation) {
    groups.rayGenerations = {*generation};
    key += " " + *generation;
  }
  const std::vector<check::ModuleStage> modules = usedModules(pipeline.stages.modules, groups);
  if (pipeline.stages.indexByRecord) groups.recordData = dataOf(found, regions, generation);
  groups.descriptorCounts = copy.descriptors;
  for (const auto& [slot, count] : groups.descriptorCounts)
    key += fmt::format(" {}.{}:{}", slot.first, slot.second, count);
  groups.tablesKnown = true;
  const std::vector<check::PipelineGroups> states = withInstances(groups);
  for (const check::PipelineGroups& state : states) {
    key += " |";
    for (const check::InstanceRecords& instance : state.instances.value_or(std::vector<check::InstanceRecords>{}))
      key += fmt::format(" {}:{}:{}:{}", instance.recordOffset, instance.facts.mask, instance.facts.customIndex,
                         instance.facts.geometryCount);
  }
  {
    const std::scoped_lock lock(mutex_);
    if (!pipeline.stages.indexByRecord) {
      if (!linked_.insert(key).second) return;
    } else {
      const std::string content = key + contentKey(groups.recordData);
      if (linked_.contains(content) || linkedData_[key] >= kMaxContents) return;
      linked_.insert(content);
      ++linkedData_[key];
    }
  }
  const auto has = [](const std::vector<Diagnostic>& list, const Diagnostic& d) {
    return std::ranges::any_of(
        list, [&](const Diagnostic& k) { return k.id == d.id && k.file == d.file && k.line == d.line; });
  };
  // A table need not reach all stages: a pipeline can be for more than one scene.
  std::vector<Diagnostic> added = check::checkModules(states.front(), modules, device_.limits).diagnostics;
  std::erase_if(added, [&](const Diagnostic& d) {
    return d.id == kUnreachable || d.severity == Severity::note || has(pipeline.result.diagnostics, d);
  });
  // What holds for only one of several possible states of the instances is not certain.
  for (std::size_t i = 1; i < states.size() && !added.empty(); ++i) {
    const auto other = check::checkModules(states[i], modules, device_.limits).diagnostics;
    std::erase_if(added, [&](const Diagnostic& d) { return !has(other, d); });
  }
  check::Suppressions(pipeline.stages.sources).apply(added);
  device_.report(std::move(added), pipeline);
}

// Only if there is one top-level structure: which one a trace uses is in the descriptors.
std::vector<check::PipelineGroups> TableCapture::withInstances(const check::PipelineGroups& groups) {
  constexpr std::size_t kMaxStates = 4;
  const std::scoped_lock lock(mutex_);
  if (topLevel_.size() != 1 || !tops_.contains(*topLevel_.begin()) || replaced_.size() >= kMaxStates) return {groups};
  std::vector<check::PipelineGroups> states;
  std::vector<const Top*> tops{&tops_.at(*topLevel_.begin())};
  for (const Top& top : replaced_) tops.push_back(&top);
  for (const Top* top : tops) {
    states.push_back(groups);
    if (!addInstances(*top, states.back())) return {groups};
  }
  return states;
}

// Returns false if it is unknown what an instance refers to.
bool TableCapture::addInstances(const Top& top, check::PipelineGroups& groups) {
  std::unordered_map<std::uint64_t, std::pair<std::uint32_t, std::uint32_t>> ranges;  // by address
  for (const auto& [structure, bottom] : bottoms_) {
    VkAccelerationStructureDeviceAddressInfoKHR info{};
    info.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR;
    info.accelerationStructure = structure;
    const std::uint64_t reference = top.refersToHandles
                                        ? numberOf(structure)
                                        : device_.table.GetAccelerationStructureDeviceAddressKHR(device_.handle, &info);
    ranges[reference] = {static_cast<std::uint32_t>(groups.geometries.size()),
                         static_cast<std::uint32_t>(bottom.geometries.size())};
    groups.geometries.insert(groups.geometries.end(), bottom.geometries.begin(), bottom.geometries.end());
  }
  std::vector<check::InstanceRecords> instances;
  for (const VkAccelerationStructureInstanceKHR& raw : top.instances) {
    if (raw.accelerationStructureReference == 0) continue;  // inactive
    const auto range = ranges.find(raw.accelerationStructureReference);
    if (range == ranges.end()) return false;  // built elsewhere
    check::InstanceRecords instance;
    instance.facts.name = std::to_string(&raw - top.instances.data());
    instance.facts.firstGeometry = range->second.first;
    instance.facts.geometryCount = range->second.second;
    instance.facts.mask = raw.mask;
    instance.facts.customIndex = raw.instanceCustomIndex;
    instance.hasCustomIndex = true;
    instance.facts.forceOpaque = (raw.flags & VK_GEOMETRY_INSTANCE_FORCE_OPAQUE_BIT_KHR) != 0;
    instance.facts.forceNoOpaque = (raw.flags & VK_GEOMETRY_INSTANCE_FORCE_NO_OPAQUE_BIT_KHR) != 0;
    constexpr VkTransformMatrixKHR kIdentity{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    instance.facts.transformed = std::memcmp(&raw.transform, &kIdentity, sizeof kIdentity) != 0;
    instance.recordOffset = raw.instanceShaderBindingTableRecordOffset;
    instances.push_back(std::move(instance));
  }
  groups.instances = std::move(instances);
  return true;
}

}  // namespace quintet::layer

// SPDX-License-Identifier: Apache-2.0
// The mode sbt=1: copies the shader binding table of each trace and the instances of each build, as they are when the device
// executes the command, and checks them once the copy is complete. Thread-safe.
//
// A copy is recorded before the command of the application, in its command buffer: into a buffer of the layer, followed by a
// mark. The layer looks for marks in calls that often follow the end of an execution, such as waits and submissions.
#ifndef QUINTET_LAYER_TABLE_CAPTURE_H
#define QUINTET_LAYER_TABLE_CAPTURE_H

#include <array>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "chains.h"
#include "device.h"

namespace quintet::layer {

// The create info of a buffer whose content the layer must be able to copy: shader binding tables, instances of acceleration
// structures, and arguments of indirect traces get TRANSFER_SRC. `info` must outlive this object.
class ReadableBuffer {
 public:
  explicit ReadableBuffer(const VkBufferCreateInfo& info);
  ReadableBuffer(const ReadableBuffer&) = delete;
  const VkBufferCreateInfo& info() const { return info_; }
  VkBufferUsageFlags usage() const { return usage_; }

 private:
  VkBufferCreateInfo info_;
  Flags2 flags2_{};
  VkBufferUsageFlags usage_;
};

class TableCapture {
 public:
  explicit TableCapture(Device& device) : device_(device) {}
  ~TableCapture();  // the device is idle
  TableCapture(const TableCapture&) = delete;

  void addBuffer(VkBuffer buffer, VkDeviceSize bytes, VkBufferUsageFlags usage);
  void addAddress(VkBuffer buffer, VkDeviceAddress address);
  void removeBuffer(VkBuffer buffer);

  void removePipeline(VkPipeline pipeline);

  // Before a trace. The regions are in the order of check::TableKind.
  void trace(VkCommandBuffer commands, const std::array<VkStridedDeviceAddressRegionKHR, check::kTableKinds>& regions);
  // Before a trace whose regions are in device memory, as VkTraceRaysIndirectCommand2KHR: copies it, and all small buffers
  // that can be shader binding tables.
  void traceIndirect(VkCommandBuffer commands, VkDeviceAddress address);
  void addStructure(VkAccelerationStructureKHR structure, VkAccelerationStructureTypeKHR type);
  // Before builds of acceleration structures.
  void build(VkCommandBuffer commands, std::uint32_t count, const VkAccelerationStructureBuildGeometryInfoKHR* infos,
             const VkAccelerationStructureBuildRangeInfoKHR* const* ranges);
  void buildIndirect(std::uint32_t count, const VkAccelerationStructureBuildGeometryInfoKHR* infos);
  void buildOnHost(std::uint32_t count, const VkAccelerationStructureBuildGeometryInfoKHR* infos,
                   const VkAccelerationStructureBuildRangeInfoKHR* const* ranges);
  void copyStructure(VkAccelerationStructureKHR from, VkAccelerationStructureKHR to);
  void forgetStructure(VkAccelerationStructureKHR structure);  // its content is unknown
  void removeStructure(VkAccelerationStructureKHR structure);

  void addCommands(VkCommandPool pool, std::uint32_t count, const VkCommandBuffer* commands);
  // The commands are not pending any more: they are recorded again or freed.
  void release(VkCommandBuffer commands);
  void releasePool(VkCommandPool pool);

  void poll();  // checks what is complete

 private:
  struct Buffer {
    VkDeviceSize bytes = 0;
    VkBufferUsageFlags usage = 0;
    VkDeviceAddress address = 0;  // 0 if it was not queried
    bool readable() const { return (usage & VK_BUFFER_USAGE_TRANSFER_SRC_BIT) != 0; }
  };
  // A buffer that can have a shader binding table, in a copy.
  struct CopiedTable {
    VkDeviceAddress address = 0;
    VkDeviceSize bytes = 0;  // of the buffer
    std::size_t offset = 0;  // in the copy
  };
  struct Part {  // of a copy
    VkBuffer source = VK_NULL_HANDLE;
    VkDeviceSize from = 0, bytes = 0;
  };
  using Regions = std::array<check::TableRegion, check::kTableKinds>;
  struct Copy {
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    std::byte* mapped = nullptr;
    std::size_t markOffset = 0;
    // Of a trace.
    std::shared_ptr<LinkedPipeline> pipeline;
    DescriptorCounts descriptors;
    Regions regions;
    std::array<std::pair<std::size_t, std::size_t>, check::kTableKinds> data;  // offset and bytes in `mapped`
    bool isIndirect = false;                                                   // the copy starts with the command
    std::vector<CopiedTable> tables;                                           // of an indirect trace
    // Of a build.
    VkAccelerationStructureKHR structure = VK_NULL_HANDLE;
    std::size_t instances = 0;
  };
  struct Bottom {
    std::vector<program::GeometryFacts> geometries;
  };
  struct Top {
    std::vector<VkAccelerationStructureInstanceKHR> instances;
    bool refersToHandles = false;  // built on the host: accelerationStructureReference is a handle, not an address
  };
  struct Found {  // by buffer
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceSize offset = 0, available = 0;
    bool readable = false;
  };

  std::optional<Found> find(VkDeviceAddress address) const;
  bool record(Copy& copy, const std::vector<Part>& parts);
  void destroy(const Copy& copy) const;
  void finish(Copy copy, std::vector<std::byte> bytes);
  void finishTrace(const Copy& copy, const std::vector<std::byte>& bytes);
  void finishBuild(const Copy& copy, const std::vector<std::byte>& bytes);
  const std::vector<check::TableGroup>& groupsOf(LinkedPipeline& pipeline);
  static void readCommand(const Copy& copy, const std::vector<std::byte>& bytes, Regions& regions);
  void link(const Copy& copy, const check::TableFindings& found, const Regions& regions);
  check::TableData dataOf(const check::TableFindings& found, const Regions& regions,
                          const std::optional<std::string>& rayGeneration) const;
  static Bottom bottomOf(const VkAccelerationStructureBuildGeometryInfoKHR& info);
  // Returns false if the build is not one of a bottom-level structure.
  bool buildBottom(const VkAccelerationStructureBuildGeometryInfoKHR& info);
  void setTop(VkAccelerationStructureKHR structure, Top top);
  // What rays can hit, one entry per state that the only top-level structure can have had at the trace. Empty if unknown.
  std::vector<check::PipelineGroups> withInstances(const check::PipelineGroups& groups);
  bool addInstances(const Top& top, check::PipelineGroups& groups);

  Device& device_;
  std::mutex mutex_;
  std::unordered_map<VkBuffer, Buffer> buffers_;
  std::map<VkDeviceAddress, VkBuffer> addresses_;
  std::list<Copy> copies_;
  std::unordered_map<VkCommandBuffer, VkCommandPool> pools_;
  std::unordered_map<VkAccelerationStructureKHR, Bottom> bottoms_;
  std::unordered_map<VkAccelerationStructureKHR, Top> tops_;
  std::set<VkAccelerationStructureKHR> topLevel_;  // all that exist, also those whose instances are unknown
  std::vector<Top> replaced_;                      // by builds that were completed together with the traces
  std::unordered_map<VkPipeline, std::vector<check::TableGroup>> groups_;
  std::set<std::string> linked_;                   // tables that were already linked
  std::map<std::string, std::size_t> linkedData_;  // number of contents of their records, by table
};

}  // namespace quintet::layer
#endif

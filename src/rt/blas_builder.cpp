// SPDX-License-Identifier: Apache-2.0
#include "rt/blas_builder.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "base/cancellation.h"
#include "base/error.h"
#include "base/math.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "gpu/commands.h"
#include "gpu/error.h"
#include "gpu/uploader.h"
#include "rt/acceleration_structure.h"

namespace quintet::rt {
namespace {

constexpr VkDeviceSize kInputAlignment = 16;

template <class T>
std::span<const std::byte> bytesOf(std::span<const T> data) {
  return std::as_bytes(data);
}

// Writes host data into device buffers: into mapped memory on a CPU device, otherwise through a staging ring.
class BufferFiller {
 public:
  // `expectedBytes` is an estimate of the written bytes, which determines the size of the staging ring.
  BufferFiller(gpu::Context& context, VkDeviceSize expectedBytes)
      : context_(context),
        stagingBytes_(std::clamp<VkDeviceSize>(2 * expectedBytes, 1 << 16, VkDeviceSize{64} << 20)) {}

  gpu::Buffer make(VkDeviceSize size, VkBufferUsageFlags usage, const std::string& name, gpu::Purpose purpose) const {
    const gpu::Memory memory = context_.info().software ? gpu::Memory::upload : gpu::Memory::device;
    return gpu::Buffer(context_, {.size = size, .memory = memory, .usage = usage, .name = name, .purpose = purpose});
  }

  void write(const gpu::Buffer& buffer, VkDeviceSize offset, std::span<const std::byte> data) {
    if (data.empty()) return;
    assert(offset + data.size() <= buffer.size());
    if (buffer.mapped()) {
      std::memcpy(buffer.mapped() + offset, data.data(), data.size());
      return;
    }
    if (!uploader_) uploader_.emplace(context_, stagingBytes_);
    uploader_->upload(buffer, data, offset);
  }

  // Waits until the device has all data.
  void flush() {
    if (uploader_) uploader_->flush();
  }

 private:
  gpu::Context& context_;
  VkDeviceSize stagingBytes_;
  std::optional<gpu::Uploader> uploader_;
};

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

// ---- One batch on the device

// Several builds (or refits) that share a submission, an input buffer and scratch memory.
class BlasBatch {
 public:
  explicit BlasBatch(gpu::Context& context) : context_(context) {}

  // Adds a build. `options` and `data` must exist until the end of run(), which clears the maps of `data` unless the
  // BLAS allows updates.
  void add(const BlasOptions& options, BlasData& data);
  // Adds an update of `target` in place.
  void addRefit(Blas& target, BlasData& data);
  // Uploads, builds, compacts and waits. Result k belongs to the k-th call of add.
  std::vector<Blas> run();
  VkDeviceSize scratchBytes() const { return scratchBytes_; }

 private:
  // An address if the data is already on the device, otherwise an offset in the input buffer.
  struct Location {
    VkDeviceAddress address = 0;
    VkDeviceSize offset = 0;
  };
  struct GeometryLocations {
    Location points;  // or boxes
    Location indices;
  };
  struct Job {
    const BlasOptions* options;
    BlasData* data;
    bool refit;
    Blas* target;  // run() sets it for a build
    BuildDescription description;
    VkAccelerationStructureBuildSizesInfoKHR sizes;
    VkDeviceSize scratchOffset;
    std::vector<GeometryLocations> locations;  // one per geometry
  };
  using HostBytes = std::span<const std::byte>;

  void addJob(const BlasOptions& options, BlasData& data, Blas* refitted);
  Location locate(VkDeviceAddress known, HostBytes data);
  GeometryLocations locationsOf(const GeometryData& geometry);
  void uploadInputs();
  void describe(Job& job);
  Blas create(const Job& job);
  void uploadMaps(const BlasData& data, Blas& blas);
  void recordBuilds(gpu::Commands& commands) const;
  // Queries the compacted sizes of new structures, then copies them.
  void compact(std::span<Blas* const> structures) const;
  std::vector<VkDeviceSize> compactedSizes(std::span<Blas* const> structures) const;

  gpu::Context& context_;
  std::vector<Job> jobs_;
  std::map<std::pair<const std::byte*, std::size_t>, VkDeviceSize> offsets_;  // in the input buffer
  std::vector<std::pair<const GeometryData*, VkDeviceSize>> gathered_;        // selected primitives and their offset
  VkDeviceSize inputBytes_ = 0;
  VkDeviceSize scratchBytes_ = 0;
  std::optional<BufferFiller> filler_;
  gpu::Buffer inputs_;
  gpu::Buffer scratch_;
};

void BlasBatch::add(const BlasOptions& options, BlasData& data) { addJob(options, data, nullptr); }
void BlasBatch::addRefit(Blas& target, BlasData& data) { addJob(target.options_, data, &target); }

BlasBatch::Location BlasBatch::locate(VkDeviceAddress known, HostBytes data) {
  if (known) return {known, 0};
  const auto [at, isNew] = offsets_.try_emplace({data.data(), data.size()}, inputBytes_);
  if (isNew) inputBytes_ = alignUp(inputBytes_ + data.size(), kInputAlignment);
  return {0, at->second};
}

BlasBatch::GeometryLocations BlasBatch::locationsOf(const GeometryData& geometry) {
  const GeometryInput& input = geometry.input;
  const bool triangles = input.kind == GeometryKind::triangles;
  GeometryLocations locations;
  if (triangles) locations.points = locate(input.positionsAddress, bytesOf(input.positions));
  Location& primitives = triangles ? locations.indices : locations.points;
  if (geometry.map.empty()) {
    primitives = triangles ? locate(input.trianglesAddress, bytesOf(input.triangles)) : locate(0, bytesOf(input.boxes));
  } else {
    primitives = {0, inputBytes_};
    gathered_.emplace_back(&geometry, inputBytes_);
    inputBytes_ = alignUp(inputBytes_ + geometry.primitiveBytes(), kInputAlignment);
  }
  return locations;
}

void BlasBatch::addJob(const BlasOptions& options, BlasData& data, Blas* refitted) {
  Job job{&options, &data, refitted != nullptr, refitted, {}, {}, scratchBytes_, {}};
  job.description.flags = buildFlags(context_, options);
  for (const GeometryData& geometry : data.geometries) {
    job.locations.push_back(locationsOf(geometry));
    job.description.add(geometry, 0, 0);
  }
  job.sizes = job.description.sizes(context_, options.name);
  const VkDeviceSize scratch = refitted ? job.sizes.updateScratchSize : job.sizes.buildScratchSize;
  scratchBytes_ += alignUp(scratch, context_.info().limits.scratchAlignment);
  jobs_.push_back(std::move(job));
}

void BlasBatch::uploadInputs() {
  // The buffer is never empty, because a geometry without primitives needs a valid address.
  inputs_ = filler_->make(std::max<VkDeviceSize>(inputBytes_, 64),
                          VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR, "BLAS inputs",
                          gpu::Purpose::scratch);
  for (const auto& [data, offset] : offsets_) filler_->write(inputs_, offset, HostBytes(data.first, data.second));
  for (const auto& [geometry, offset] : gathered_) {
    const auto size = static_cast<std::size_t>(geometry->primitiveBytes());
    if (inputs_.mapped()) {
      geometry->gather({inputs_.mapped() + offset, size});
    } else {
      std::vector<std::byte> primitives(size);
      geometry->gather(primitives);
      filler_->write(inputs_, offset, primitives);
    }
  }
}

// Requires the address of the input buffer.
void BlasBatch::describe(Job& job) {
  job.description.geometries.clear();
  job.description.ranges.clear();
  for (std::size_t g = 0; g < job.locations.size(); ++g) {
    const GeometryData& geometry = job.data->geometries[g];
    const auto address = [&](const Location& location) {
      if (geometry.count == 0) return inputs_.address();
      return location.address ? location.address : inputs_.address() + location.offset;
    };
    job.description.add(geometry, address(job.locations[g].points), address(job.locations[g].indices));
  }
}

Blas BlasBatch::create(const Job& job) {
  Blas blas;
  blas.context_ = &context_;
  blas.options_ = *job.options;
  blas.bounds_ = job.data->bounds;
  blas.inactiveCount_ = job.data->inactiveCount;
  blas.builtSize_ = job.sizes.accelerationStructureSize;
  blas.handle_ = createStructure(context_, blas.storage_, blas.builtSize_,
                                 VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, job.options->name);
  blas.address_ = structureAddress(context_, blas.handle_);
  uploadMaps(*job.data, blas);
  return blas;
}

void BlasBatch::uploadMaps(const BlasData& data, Blas& blas) {
  VkDeviceSize bytes = 0;
  for (const GeometryData& geometry : data.geometries) bytes += geometry.map.size() * sizeof(std::uint32_t);
  if (bytes > 0)
    blas.mapStorage_ =
        filler_->make(bytes, 0, blas.options_.name + " primitive map", gpu::Purpose::accelerationStructures);
  VkDeviceSize offset = 0;
  for (const GeometryData& geometry : data.geometries) {
    blas.maps_.push_back(geometry.map.empty() ? 0 : blas.mapStorage_.address() + offset);
    filler_->write(blas.mapStorage_, offset, std::as_bytes(std::span(geometry.map)));
    offset += geometry.map.size() * sizeof(std::uint32_t);
  }
}

void BlasBatch::recordBuilds(gpu::Commands& commands) const {
  std::vector<VkAccelerationStructureBuildGeometryInfoKHR> infos;
  std::vector<const VkAccelerationStructureBuildRangeInfoKHR*> ranges;
  for (const Job& job : jobs_) {
    auto info = job.description.info(job.refit ? VK_BUILD_ACCELERATION_STRUCTURE_MODE_UPDATE_KHR
                                               : VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR);
    info.dstAccelerationStructure = job.target->handle_;
    if (job.refit) info.srcAccelerationStructure = job.target->handle_;
    info.scratchData.deviceAddress = scratch_.address() + job.scratchOffset;
    infos.push_back(info);
    ranges.push_back(job.description.ranges.data());
  }
  context_.vk().vkCmdBuildAccelerationStructuresKHR(commands.handle(), static_cast<std::uint32_t>(infos.size()),
                                                    infos.data(), ranges.data());
}

std::vector<Blas> BlasBatch::run() {
  std::vector<Blas> results;
  if (jobs_.empty()) return results;
  filler_.emplace(context_, inputBytes_);
  uploadInputs();
  scratch_ = gpu::Buffer(context_, {.size = std::max<VkDeviceSize>(scratchBytes_, 64),
                                    .alignment = context_.info().limits.scratchAlignment,
                                    .name = "BLAS scratch",
                                    .purpose = gpu::Purpose::scratch});
  results.reserve(jobs_.size());  // keeps pointers to the results valid
  std::vector<Blas*> compactable;
  for (Job& job : jobs_) {
    describe(job);
    if (job.refit) continue;
    job.target = &results.emplace_back(create(job));
    if (isCompacted(context_, *job.options)) compactable.push_back(job.target);
  }
  filler_->flush();
  for (const Job& job : jobs_)
    if (!job.options->allowUpdate)
      for (GeometryData& geometry : job.data->geometries) geometry.map = {};  // the device has a copy
  context_.submitAndWait([&](gpu::Commands& commands) { recordBuilds(commands); });
  inputs_ = {};
  scratch_ = {};
  if (!compactable.empty()) compact(compactable);
  return results;
}

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
    Blas smaller;  // owns the old structure after the swap
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

// ---- The division of inputs into batches

namespace {

// Bytes of vertices, indices and boxes of one batch. Limits the temporary memory of host and device.
constexpr VkDeviceSize kInputBudget = VkDeviceSize{256} << 20;
// Bytes of the structures of one batch before compaction: the larger of this size and this fraction of all.
constexpr VkDeviceSize kCompactionBytes = VkDeviceSize{32} << 20;
constexpr VkDeviceSize kCompactionFraction = 8;
// Inputs with more primitives are prepared one by one, each on all cores.
constexpr std::size_t kManyPrimitives = 65536;

std::size_t primitiveCount(const BlasInput& input) {
  std::size_t count = 0;
  for (const GeometryInput& geometry : input.geometries) count += rt::primitiveCount(geometry);
  return count;
}

bool isOrdered(const gpu::Context& context, const BlasInput& input) {
  return context.info().quirks.keepsPrimitiveOrder && !input.options.keepInputOrder;
}

// Returns the bytes to upload for the build.
VkDeviceSize inputBytes(const gpu::Context& context, const BlasInput& input) {
  const bool indices = isOrdered(context, input);  // sorted indices are uploaded
  VkDeviceSize bytes = 0;
  for (const GeometryInput& g : input.geometries) {
    if (!g.positionsAddress) bytes += g.positions.size_bytes();
    if (!g.trianglesAddress || indices) bytes += g.triangles.size_bytes();
    bytes += g.boxes.size_bytes();
  }
  return bytes;
}

std::vector<BlasData> prepare(const gpu::Context& context, std::span<const BlasInput> inputs) {
  std::vector<BlasData> data(inputs.size());
  const auto prepareOne = [&](std::size_t k) { data[k] = prepareBlas(inputs[k], isOrdered(context, inputs[k])); };
  std::vector<std::size_t> small;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    if (primitiveCount(inputs[k]) > kManyPrimitives) {
      prepareOne(k);
    } else {
      small.push_back(k);
    }
  }
  parallelFor(small.size(), [&](std::size_t k) { prepareOne(small[k]); });
  return data;
}

struct Plan {
  std::vector<std::size_t> lengths;  // of consecutive inputs that fit the budgets together
  std::vector<BlasOptions> options;  // one per input
};

// Divides the inputs into batches. Compaction needs the old and the new structure at the same time and saves a sixth,
// so a batch must be small compared to the total, and a structure with most of the total is not compacted.
Plan planBatches(gpu::Context& context, std::span<const BlasInput> inputs, VkDeviceSize scratchBudget) {
  Plan plan;
  std::vector<VkAccelerationStructureBuildSizesInfoKHR> sizes;
  VkDeviceSize total = 0;
  for (const BlasInput& input : inputs) {
    sizes.push_back(describeForSizes(context, input).sizes(context, input.options.name));
    total += sizes.back().accelerationStructureSize;
  }
  const VkDeviceSize builtBudget = std::max(kCompactionBytes, total / kCompactionFraction);
  VkDeviceSize scratch = 0, bytes = 0, built = 0;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    BlasOptions& options = plan.options.emplace_back(inputs[k].options);
    const VkDeviceSize ownScratch = sizes[k].buildScratchSize + context.info().limits.scratchAlignment;
    const VkDeviceSize ownBytes = inputBytes(context, inputs[k]), ownBuilt = sizes[k].accelerationStructureSize;
    if (ownBuilt > builtBudget) options.compact = false;
    if (plan.lengths.empty() || scratch + ownScratch > scratchBudget || bytes + ownBytes > kInputBudget ||
        built + ownBuilt > builtBudget) {
      plan.lengths.push_back(0);
      scratch = bytes = built = 0;
    }
    ++plan.lengths.back();
    scratch += ownScratch;
    bytes += ownBytes;
    built += ownBuilt;
  }
  return plan;
}

}  // namespace

BlasBuilder::BlasBuilder(gpu::Context& context, VkDeviceSize scratchBudget)
    : context_(context), scratchBudget_(scratchBudget) {}

std::vector<Blas> BlasBuilder::build(std::span<const BlasInput> inputs, BuildStatistics* statistics) {
  BuildStatistics own;
  std::vector<Blas> results;
  results.reserve(inputs.size());
  const Plan plan = planBatches(context_, inputs, scratchBudget_);
  for (const std::size_t length : plan.lengths) {
    throwIfCanceled();
    const std::span<const BlasInput> part = inputs.subspan(results.size(), length);
    const std::span<const BlasOptions> options = std::span(plan.options).subspan(results.size(), length);
    const Stopwatch ordering;
    std::vector<BlasData> data = prepare(context_, part);
    own.orderSeconds += ordering.seconds();

    const Stopwatch building;
    BlasBatch batch(context_);
    for (std::size_t k = 0; k < length; ++k) batch.add(options[k], data[k]);
    std::vector<Blas> built = batch.run();
    own.buildSeconds += building.seconds();
    own.peakScratchBytes = std::max(own.peakScratchBytes, batch.scratchBytes());
    ++own.batchCount;
    for (std::size_t k = 0; k < length; ++k) {
      if (part[k].options.allowUpdate) keepForRefit(built[k], part[k], data[k]);
      own.primitiveCount += primitiveCount(part[k]) - built[k].inactiveCount();
      own.bytes += built[k].size();
      results.push_back(std::move(built[k]));
    }
  }
  if (statistics) *statistics = own;
  return results;
}

void BlasBuilder::keepForRefit(Blas& blas, const BlasInput& input, const BlasData& data) {
  for (std::size_t g = 0; g < data.geometries.size(); ++g) {
    const GeometryData& built = data.geometries[g];
    blas.built_.push_back({built.input.kind, built.input.positions.size(), rt::primitiveCount(input.geometries[g]),
                           built.count, built.map});
  }
}

void BlasBuilder::refit(Blas& blas, const BlasInput& moved) {
  const std::string& name = blas.options_.name;
  if (!blas.handle_ || !blas.options_.allowUpdate)
    throw UsageError(fmt::format("cannot refit '{}', which was built without allowUpdate", name));
  bool matches = moved.geometries.size() == blas.built_.size();
  BlasData data;
  for (std::size_t g = 0; matches && g < moved.geometries.size(); ++g) {
    const GeometryInput& geometry = moved.geometries[g];
    const Blas::BuiltGeometry& built = blas.built_[g];
    matches = geometry.kind == built.kind && geometry.positions.size() == built.vertexCount &&
              rt::primitiveCount(geometry) == built.inputCount;
    if (!matches) break;
    data.geometries.push_back(applyMap(geometry, built.map, built.builtCount));
    for (std::uint32_t k = 0; k < built.builtCount; ++k) {
      const std::uint32_t primitive = built.map.empty() ? k : built.map[k];
      const Bounds3 bounds = primitiveBounds(geometry, primitive);
      if (bounds.empty())
        throw UsageError(
            fmt::format("cannot refit '{}': primitive {} of geometry {} is not finite", name, primitive, g));
      data.bounds.extend(bounds);
    }
  }
  if (!matches) throw UsageError(fmt::format("cannot refit '{}' with counts that differ from the build", name));
  BlasBatch batch(context_);
  batch.addRefit(blas, data);
  batch.run();
  blas.bounds_ = data.bounds;
}

}  // namespace quintet::rt

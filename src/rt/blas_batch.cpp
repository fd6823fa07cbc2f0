#include "rt/blas_batch.h"

#include <algorithm>

namespace quintet::rt {
namespace {

constexpr VkDeviceSize kInputAlignment = 16;

VkDeviceSize alignUp(VkDeviceSize value, VkDeviceSize alignment) {
  return (value + alignment - 1) / alignment * alignment;
}

template <class T>
std::span<const std::byte> bytesOf(std::span<const T> data) {
  return std::as_bytes(data);
}

}  // namespace

void BlasBatch::add(const BlasOptions& options, BlasData& data) { addJob(options, data, nullptr); }
void BlasBatch::addRefit(Blas& target, BlasData& data) { addJob(target.options_, data, &target); }

BlasBatch::Place BlasBatch::place(VkDeviceAddress known, HostBytes data) {
  if (known) return {known, 0};
  const auto [at, isNew] = places_.try_emplace({data.data(), data.size()}, inputBytes_);
  if (isNew) inputBytes_ = alignUp(inputBytes_ + data.size(), kInputAlignment);
  return {0, at->second};
}

BlasBatch::GeometryPlaces BlasBatch::placesOf(const GeometryData& geometry) {
  const GeometryInput& input = geometry.input;
  const bool triangles = input.kind == GeometryKind::triangles;
  GeometryPlaces places;
  if (triangles) places.points = place(input.positionsAddress, bytesOf(input.positions));
  Place& primitives = triangles ? places.indices : places.points;
  if (geometry.map.empty()) {
    primitives = triangles ? place(input.trianglesAddress, bytesOf(input.triangles)) : place(0, bytesOf(input.boxes));
  } else {
    primitives = {0, inputBytes_};
    gathered_.emplace_back(&geometry, inputBytes_);
    inputBytes_ = alignUp(inputBytes_ + geometry.primitiveBytes(), kInputAlignment);
  }
  return places;
}

void BlasBatch::addJob(const BlasOptions& options, BlasData& data, Blas* refitted) {
  Job job{&options, &data, refitted != nullptr, refitted, {}, {}, scratchBytes_, {}};
  job.description.flags = buildFlags(context_, options);
  for (const GeometryData& geometry : data.geometries) {
    job.places.push_back(placesOf(geometry));
    job.description.add(geometry, 0, 0);
  }
  job.sizes = job.description.sizes(context_, options.name);
  const VkDeviceSize scratch = refitted ? job.sizes.updateScratchSize : job.sizes.buildScratchSize;
  scratchBytes_ += alignUp(scratch, context_.info().limits.scratchAlignment);
  jobs_.push_back(std::move(job));
}

void BlasBatch::uploadInputs() {
  // At least some bytes: a geometry without primitives needs a valid address too.
  inputs_ = filler_->make(std::max<VkDeviceSize>(inputBytes_, 64),
                          VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR, "BLAS inputs",
                          gpu::Purpose::scratch);
  for (const auto& [data, offset] : places_) filler_->write(inputs_, offset, HostBytes(data.first, data.second));
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

// Now that the input buffer has an address.
void BlasBatch::describe(Job& job) {
  job.description.geometries.clear();
  job.description.ranges.clear();
  for (std::size_t g = 0; g < job.places.size(); ++g) {
    const GeometryData& geometry = job.data->geometries[g];
    const auto address = [&](const Place& place) {
      if (geometry.count == 0) return inputs_.address();
      return place.address ? place.address : inputs_.address() + place.offset;
    };
    job.description.add(geometry, address(job.places[g].points), address(job.places[g].indices));
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
  results.reserve(jobs_.size());  // pointers to results stay valid
  std::vector<Blas*> compactable;
  for (Job& job : jobs_) {
    describe(job);
    if (job.refit) continue;
    job.target = &results.emplace_back(create(job));
    if (compacts(context_, *job.options)) compactable.push_back(job.target);
  }
  filler_->flush();
  for (const Job& job : jobs_)
    if (!job.options->allowUpdate)
      for (GeometryData& geometry : job.data->geometries) geometry.map = {};  // the device has it
  context_.submitAndWait([&](gpu::Commands& commands) { recordBuilds(commands); });
  inputs_ = {};
  scratch_ = {};
  if (!compactable.empty()) compact(compactable);
  return results;
}

}  // namespace quintet::rt

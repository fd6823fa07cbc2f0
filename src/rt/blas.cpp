// Blas, and the plan by which BlasBuilder cuts its inputs into batches.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "rt/blas_batch.h"

namespace quintet::rt {
namespace {

// Vertices, indices and boxes of one batch: bounds the host's and the device's temporary memory.
constexpr VkDeviceSize kInputBudget = VkDeviceSize{256} << 20;
// Structures of one batch as built: so much, or this share of all.
constexpr VkDeviceSize kCompactionBytes = VkDeviceSize{32} << 20;
constexpr VkDeviceSize kCompactionShare = 8;
// Inputs with more primitives are prepared one after the other, each on all cores.
constexpr std::size_t kManyPrimitives = 65536;

std::size_t primitiveCount(const BlasInput& input) {
  std::size_t count = 0;
  for (const GeometryInput& geometry : input.geometries) count += rt::primitiveCount(geometry);
  return count;
}

bool isOrdered(const gpu::Context& context, const BlasInput& input) {
  return context.info().quirks.keepsPrimitiveOrder && !input.options.keepInputOrder;
}

// What has to be uploaded for the build.
VkDeviceSize inputBytes(const gpu::Context& context, const BlasInput& input) {
  const bool indices = isOrdered(context, input);  // in their own order
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
  std::vector<std::size_t> lengths;  // of consecutive runs of inputs that fit the budgets together
  std::vector<BlasOptions> options;  // one per input
};

// Compaction needs the old and the new structure at once, and wins a sixth: a batch must be small against the whole,
// and a structure that is most of the whole stays as it was built.
Plan planBatches(gpu::Context& context, std::span<const BlasInput> inputs, VkDeviceSize scratchBudget) {
  Plan plan;
  std::vector<VkAccelerationStructureBuildSizesInfoKHR> sizes;
  VkDeviceSize total = 0;
  for (const BlasInput& input : inputs) {
    sizes.push_back(describeForSizes(context, input).sizes(context, input.options.name));
    total += sizes.back().accelerationStructureSize;
  }
  const VkDeviceSize builtBudget = std::max(kCompactionBytes, total / kCompactionShare);
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

Blas::~Blas() { release(); }
Blas::Blas(Blas&& other) noexcept { *this = std::move(other); }

Blas& Blas::operator=(Blas&& other) noexcept {
  if (this == &other) return *this;
  release();
  context_ = std::exchange(other.context_, nullptr);
  handle_ = std::exchange(other.handle_, VkAccelerationStructureKHR{VK_NULL_HANDLE});
  address_ = std::exchange(other.address_, 0);
  builtSize_ = std::exchange(other.builtSize_, 0);
  storage_ = std::move(other.storage_);
  mapStorage_ = std::move(other.mapStorage_);
  maps_ = std::move(other.maps_);
  built_ = std::move(other.built_);
  bounds_ = std::exchange(other.bounds_, Bounds3{});
  inactiveCount_ = std::exchange(other.inactiveCount_, 0);
  options_ = std::move(other.options_);
  return *this;
}

void Blas::release() {
  if (handle_) retireStructure(*context_, handle_);
  handle_ = VK_NULL_HANDLE;
}

BlasBuilder::BlasBuilder(gpu::Context& context, VkDeviceSize scratchBudget)
    : context_(context), scratchBudget_(scratchBudget) {}

std::vector<Blas> BlasBuilder::build(std::span<const BlasInput> inputs, BuildStatistics* statistics) {
  BuildStatistics own;
  std::vector<Blas> results;
  results.reserve(inputs.size());
  const Plan plan = planBatches(context_, inputs, scratchBudget_);
  for (const std::size_t length : plan.lengths) {
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
      if (part[k].options.allowUpdate) remember(built[k], part[k], data[k]);
      own.primitiveCount += primitiveCount(part[k]) - built[k].inactiveCount();
      own.bytes += built[k].size();
      results.push_back(std::move(built[k]));
    }
  }
  if (statistics) *statistics = own;
  return results;
}

void BlasBuilder::remember(Blas& blas, const BlasInput& input, const BlasData& data) {
  for (std::size_t g = 0; g < data.geometries.size(); ++g) {
    const GeometryData& built = data.geometries[g];
    blas.built_.push_back({built.input.kind, built.input.positions.size(), rt::primitiveCount(input.geometries[g]),
                           built.count, built.map});
  }
}

void BlasBuilder::refit(Blas& blas, const BlasInput& moved) {
  const std::string& name = blas.options_.name;
  if (!blas.handle_ || !blas.options_.allowUpdate)
    throw UsageError(fmt::format("refit of '{}', which was not built with allowUpdate", name));
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
            fmt::format("refit of '{}': primitive {} of geometry {} is no longer finite", name, primitive, g));
      data.bounds.extend(bounds);
    }
  }
  if (!matches) throw UsageError(fmt::format("refit of '{}' with other counts than it was built with", name));
  BlasBatch batch(context_);
  batch.addRefit(blas, data);
  batch.run();
  blas.bounds_ = data.bounds;
}

}  // namespace quintet::rt

// SPDX-License-Identifier: Apache-2.0
#include "rt/blas_refit.h"

#include <fmt/format.h>

#include <cassert>

#include "base/error.h"
#include "gpu/context.h"

namespace quintet::rt {

BlasRefit::BlasRefit(gpu::Context& context, const Blas& blas, const BlasInput& built) : handle_(blas.handle_) {
  const std::string& name = blas.options_.name;
  if (!blas.handle_ || !blas.options_.allowUpdate)
    throw UsageError(fmt::format("cannot refit '{}', which was built without allowUpdate", name));
  bool matches = built.geometries.size() == blas.built_.size();
  std::vector<GeometryData> geometries;
  for (std::size_t g = 0; matches && g < built.geometries.size(); ++g) {
    const GeometryInput& geometry = built.geometries[g];
    const Blas::BuiltGeometry& known = blas.built_[g];
    assert(geometry.kind == GeometryKind::triangles && geometry.positionsAddress && geometry.trianglesAddress);
    matches = geometry.kind == known.kind && geometry.positions.size() == known.vertexCount &&
              primitiveCount(geometry) == known.inputCount;
    if (matches) geometries.push_back(applyMap(geometry, known.map, known.builtCount));
  }
  if (!matches) throw UsageError(fmt::format("cannot refit '{}' with counts that differ from the build", name));
  description_.flags = buildFlags(context, blas.options_);
  addTriangles(context, geometries);
  scratch_ = gpu::Buffer(context, {.size = description_.sizes(context, name).updateScratchSize,
                                   .alignment = context.info().limits.scratchAlignment,
                                   .name = name + " refit scratch",
                                   .purpose = gpu::Purpose::scratch});
}

// Describes the geometries, and uploads the triangles of those whose order the build has changed.
void BlasRefit::addTriangles(gpu::Context& context, const std::vector<GeometryData>& geometries) {
  std::vector<std::byte> sorted;
  std::vector<std::size_t> offsets;
  for (const GeometryData& geometry : geometries) {
    offsets.push_back(sorted.size());
    if (geometry.map.empty()) continue;
    sorted.resize(sorted.size() + static_cast<std::size_t>(geometry.primitiveBytes()));
    geometry.gather(std::span(sorted).subspan(offsets.back()));
  }
  if (!sorted.empty())
    triangles_ = gpu::makeBuffer(context, sorted, VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR,
                                 "BLAS refit triangles");
  for (std::size_t g = 0; g < geometries.size(); ++g) {
    const GeometryData& geometry = geometries[g];
    const VkDeviceAddress triangles =
        geometry.map.empty() ? geometry.input.trianglesAddress : triangles_.address() + offsets[g];
    description_.add(geometry, geometry.input.positionsAddress, triangles);
  }
}

void BlasRefit::record(gpu::Commands& commands) const {
  auto info = description_.info(VK_BUILD_ACCELERATION_STRUCTURE_MODE_UPDATE_KHR);
  info.srcAccelerationStructure = info.dstAccelerationStructure = handle_;
  info.scratchData.deviceAddress = scratch_.address();
  const VkAccelerationStructureBuildRangeInfoKHR* ranges = description_.ranges.data();
  commands.context().vk().vkCmdBuildAccelerationStructuresKHR(commands.handle(), 1, &info, &ranges);
}

}  // namespace quintet::rt

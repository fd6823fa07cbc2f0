// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/text.h"
#include "gpu/context.h"
#include "job/version.h"
#include "output/info.h"
#include "output/json_line.h"

namespace quintet::output {
namespace {

using Json = nlohmann::ordered_json;

// The layout of VK_MAKE_API_VERSION.
std::string versionText(std::uint32_t version) {
  return fmt::format("{}.{}.{}", (version >> 22) & 0x7f, (version >> 12) & 0x3ff, version & 0xfff);
}

Json toJson(const gpu::DeviceInfo& device) {
  const gpu::RayTracingLimits& limits = device.limits;
  return {{"index", device.index},
          {"name", device.name},
          {"driver", device.driver},
          {"uuid", device.uuid},
          {"kind", device.kind},
          {"api", versionText(device.apiVersion)},
          {"memoryBytes", device.memoryBytes},
          {"maxBufferBytes", device.maxBufferBytes},
          {"maxImageSize", device.maxImageSize},
          {"maxTextures", device.maxTextures},
          {"usable", device.usable()},
          {"unusableReason", device.unusableReason},
          {"rayQuery", device.rayQuery},
          {"positionFetch", device.positionFetch},
          {"shaderClock", device.shaderClock && !device.software},  // as job::requestedProbes()
          {"subgroupSize", device.subgroupSize},
          {"limits",
           {{"handleSize", limits.handleSize},
            {"handleAlignment", limits.handleAlignment},
            {"baseAlignment", limits.baseAlignment},
            {"maxRecordStride", limits.maxRecordStride},
            {"maxRecursionDepth", limits.maxRecursionDepth},
            {"maxHitAttributeSize", limits.maxHitAttributeSize},
            {"maxLaunchInvocations", limits.maxLaunchInvocations},
            {"scratchAlignment", limits.scratchAlignment},
            {"maxGeometries", limits.maxGeometries},
            {"maxInstances", limits.maxInstances},
            {"maxPrimitives", limits.maxPrimitives}}},
          {"software", device.software},
          {"quirks",
           {{"keepsPrimitiveOrder", device.quirks.keepsPrimitiveOrder},
            {"slowInstances", device.quirks.slowInstances},
            {"slowTraceCalls", device.quirks.slowTraceCalls},
            {"corruptsHitAttributes", device.quirks.corruptsHitAttributes},
            {"noCompaction", device.quirks.noCompaction}}}};
}

std::string toText(const gpu::DeviceInfo& device) {
  std::string text = fmt::format("{}: {}\n", device.index, printable(device.name));
  const auto line = [&text](const char* label, const std::string& value) {
    text += fmt::format("   {:<13}{}\n", label, value);
  };
  line("kind", device.kind);
  line("driver", printable(device.driver));
  line("Vulkan", versionText(device.apiVersion));
  line("memory", fmt::format("{}, buffers up to {}", bytesText(device.memoryBytes), bytesText(device.maxBufferBytes)));
  if (device.limits.handleSize > 0) {
    const gpu::RayTracingLimits& limits = device.limits;
    line("ray tracing",
         fmt::format("recursion {}, hit attributes {} bytes, launches of {} rays, handles {}/{}/{} bytes",
                     limits.maxRecursionDepth, limits.maxHitAttributeSize, limits.maxLaunchInvocations,
                     limits.handleSize, limits.handleAlignment, limits.baseAlignment));
    line("", fmt::format("up to {} instances, {} geometries and {} primitives", limits.maxInstances,
                         limits.maxGeometries, limits.maxPrimitives));
  }
  line("usable", device.usable() ? "yes" : "no: " + printable(device.unusableReason));
  return text;
}

}  // namespace

std::string devicesInfo(bool json) {
  const std::vector<gpu::DeviceInfo> devices = gpu::Context::devices();
  if (json) {
    Json all = Json::array();
    for (const gpu::DeviceInfo& device : devices) all.push_back(toJson(device));
    const Json result{{"version", job::quintetVersion()}, {"devices", std::move(all)}};
    return jsonLine(result);
  }
  if (devices.empty()) return "no Vulkan device found: install a GPU driver or Mesa's lavapipe (docs/install.md)\n";
  std::string text;
  for (const gpu::DeviceInfo& device : devices) text += toText(device);
  return text;
}

}  // namespace quintet::output

// SPDX-License-Identifier: Apache-2.0
#include "gpu/device_info.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <optional>
#include <regex>

#include <fmt/format.h>

#include "base/text.h"
#include "gpu/error.h"

namespace quintet::gpu {
namespace {

constexpr std::array<std::string_view, 5> kKindsByPreference = {"discrete GPU", "integrated GPU", "virtual GPU",
                                                                "other", "CPU"};

bool isDigit(char c) { return c >= '0' && c <= '9'; }

// Returns the text without version numbers: "llvmpipe (LLVM , 256 bits)" of "llvmpipe (LLVM 15.0.6, 256 bits)".
std::string withoutVersions(const std::string& text) {
  static const std::regex kVersion("[0-9]+(\\.[0-9]+)+");
  return std::regex_replace(text, kVersion, "");
}

bool matches(const DeviceInfo& device, const std::string& request) {
  if (lowerCase(device.name) == request) return true;  // scripts pass on what `quintet info` prints
  for (const std::string& text : {withoutVersions(device.name), device.driverName, device.kind})
    if (lowerCase(text).find(request) != std::string::npos) return true;
  return false;
}

// Returns the number that the text consists of, or the largest one if it is too large; nullopt for any other text.
std::optional<std::size_t> asIndex(std::string_view text) {
  if (text.empty() || !std::ranges::all_of(text, isDigit)) return std::nullopt;
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  return error == std::errc{} ? index : std::numeric_limits<std::size_t>::max();
}

std::string listing(std::span<const DeviceInfo> devices) {
  std::string text;
  for (const DeviceInfo& device : devices)
    text += fmt::format("{}{}: {} ({}, {}){}{}", text.empty() ? "" : "; ", device.index, device.name, device.kind,
                        device.driver, device.usable() ? "" : " cannot be used: ", device.unusableReason);
  return text;
}

}  // namespace

std::string deviceKindName(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return "discrete GPU";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return "integrated GPU";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return "virtual GPU";
    case VK_PHYSICAL_DEVICE_TYPE_CPU: return "CPU";
    default: return "other";
  }
}

int devicePreference(std::string_view kind) {
  const auto found = std::find(kKindsByPreference.begin(), kKindsByPreference.end(), kind);
  return static_cast<int>(found - kKindsByPreference.begin());
}

std::size_t chooseDevice(std::span<const DeviceInfo> devices, std::string_view request) {
  if (devices.empty())
    throw NoDeviceError(
        "no Vulkan device found; install mesa-vulkan-drivers (CPU) or the driver of your GPU, then check the output of "
        "`quintet info`");
  const std::optional<std::size_t> index = asIndex(request);
  const std::string wanted = lowerCase(request);
  bool matched = false;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    if (index ? *index != i : !matches(devices[i], wanted)) continue;
    matched = true;
    if (devices[i].usable()) return i;
  }
  if (request.empty()) throw NoDeviceError(fmt::format("no usable device; found {}", listing(devices)));
  const std::string_view problem = matched ? "cannot use device" : index ? "no device with index" : "no device";
  throw NoDeviceError(index ? fmt::format("{} {}; found {}", problem, request, listing(devices))
                            : fmt::format("{} '{}'; found {}", problem, request, listing(devices)));
}

}  // namespace quintet::gpu

// SPDX-License-Identifier: Apache-2.0
#include "gpu/device_list.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "gpu/error.h"

namespace quintet::gpu {
namespace {

constexpr std::string_view kAll = "all";

// The parts between the commas that are not in parentheses.
std::vector<std::string> entriesOf(std::string_view list) {
  std::vector<std::string> entries(1);
  int depth = 0;
  for (const char c : list) {
    depth += c == '(' ? 1 : c == ')' ? -1 : 0;
    if (c == ',' && depth <= 0)
      entries.emplace_back();
    else
      entries.back() += c;
  }
  return entries;
}

std::vector<std::size_t> allDevices(std::span<const DeviceInfo> devices, bool mixed) {
  const std::size_t first = chooseDevice(devices, "");  // throws if none is usable
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < devices.size(); ++i)
    if (devices[i].usable() && (mixed || isSameKind(devices[i], devices[first]))) chosen.push_back(i);
  return chosen;
}

// Returns whether the request is the complete name of a device, which can contain a comma.
bool isName(std::span<const DeviceInfo> devices, const std::string& request) {
  const auto hasName = [&](const DeviceInfo& device) { return lowerCase(device.name) == lowerCase(request); };
  return std::ranges::any_of(devices, hasName);
}

}  // namespace

bool isDeviceList(std::string_view request) {
  return lowerCase(std::string(request)) == kAll || entriesOf(request).size() > 1;
}

bool isSameKind(const DeviceInfo& a, const DeviceInfo& b) { return a.name == b.name && a.driver == b.driver; }

std::vector<std::size_t> chooseDevices(std::span<const DeviceInfo> devices, const std::string& request, bool mixed) {
  if (lowerCase(request) == kAll) return allDevices(devices, mixed);
  if (!isDeviceList(request) || isName(devices, request)) return {chooseDevice(devices, request)};
  std::vector<std::size_t> chosen;
  for (const std::string& entry : entriesOf(request)) {
    if (entry.empty()) throw UsageError(fmt::format("device list '{}': entry {} is empty", request, chosen.size() + 1));
    try {
      chosen.push_back(chooseDevice(devices, entry));
    } catch (const NoDeviceError& error) {
      throw NoDeviceError(fmt::format("device list '{}': {}", request, error.what()));
    }
    const DeviceInfo &first = devices[chosen.front()], &last = devices[chosen.back()];
    if (!mixed && !isSameKind(first, last))
      throw UsageError(fmt::format(
          "device list '{}': {} ({}) and {} ({}) are different kinds of devices, which can differ in the last "
          "bit of a sample; name devices of one kind, or allow mixed devices",
          request, first.name, first.driver, last.name, last.driver));
  }
  return chosen;
}

std::size_t chooseOneDevice(std::span<const DeviceInfo> devices, const std::string& request,
                            const std::string& fallback) {
  if (request.empty()) return chooseDevices(devices, fallback, true).front();
  if (isDeviceList(request) && !isName(devices, request))
    throw UsageError(fmt::format("device '{}': one device is used here; name one", request));
  return chooseDevice(devices, request);
}

std::string requestOf(std::size_t device) { return std::to_string(device); }

}  // namespace quintet::gpu

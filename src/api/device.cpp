// SPDX-License-Identifier: Apache-2.0
#include "api/impl.h"
#include "gpu/context.h"
#include "gpu/driver_environment.h"

namespace quintet {
namespace {

DeviceInfo toPublic(const gpu::DeviceInfo& info) {
  return {
      info.index,         info.name, info.driver, info.uuid, info.kind, info.memoryBytes, info.limits.maxRecursionDepth,
      info.unusableReason};
}

}  // namespace

bool prepareDrivers() { return gpu::prepareDriverEnvironment(); }

std::vector<DeviceInfo> devices() {
  std::vector<DeviceInfo> result;
  for (const gpu::DeviceInfo& info : gpu::Context::devices()) result.push_back(toPublic(info));
  return result;
}

Device::Device(const DeviceOptions& options) {
  LogSink log;
  if (options.onWarning)
    log = [warn = options.onWarning](LogLevel level, const std::string& text) {
      if (level == LogLevel::warning) warn(text);
    };
  impl_ = std::make_unique<Impl>(job::EngineOptions{.device = options.choice,
                                                    .caches = options.cacheFolder,
                                                    .log = std::move(log),
                                                    .severalDevices = true,
                                                    .mixedDevices = options.mixedDevices});
  impl().engine.context();
}
Device::Device(Device&&) noexcept = default;
Device& Device::operator=(Device&&) noexcept = default;
Device::~Device() = default;
Device::Impl& Device::impl() const { return requireObject(impl_, "Device"); }

DeviceInfo Device::info() const { return toPublic(impl().engine.context().info()); }
std::vector<DeviceInfo> Device::infos() const {
  std::vector<DeviceInfo> result;
  for (std::size_t i = 0; i < impl().engine.deviceCount(); ++i)
    result.push_back(toPublic(impl().engine.context(i).info()));
  return result;
}
std::string Device::name() const { return info().name; }
std::string Device::driver() const { return info().driver; }

}  // namespace quintet

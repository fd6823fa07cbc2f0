// SPDX-License-Identifier: Apache-2.0
// The Vulkan devices of the machine, those that render, and how they can fail.
#ifndef QUINTET_DEVICE_H
#define QUINTET_DEVICE_H

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <quintet/error.h>

namespace quintet {

// The driver has reset the device, for example because a shader hung.
class DeviceLostError : public Error {
 public:
  using Error::Error;
};

// A launch did not end in time: 60 s, or 120 s on a CPU, without compilation. The device still works on it and cannot be stopped, so the
// destructors of Renderer and Device can block, and so can exit(). Report the error, and end the process with _exit().
class TimeoutError : public DeviceLostError {
 public:
  explicit TimeoutError(double seconds, const std::string& work = {});
  double seconds() const { return seconds_; }        // the limit
  const std::string& work() const { return work_; }  // "launch 3 (128 pixels, 4 samples each)"; may be empty

 private:
  double seconds_;
  std::string work_;
};

// A device of the machine, whether Quintet can use it or not.
struct DeviceInfo {
  std::uint32_t index = 0;              // for DeviceOptions::choice
  std::string name{};                   // "NVIDIA H200"
  std::string driver{};                 // name, version and details: "lavapipe 25.0.7 (LLVM 15.0.6)"
  std::string uuid{};                   // 32 hexadecimal digits
  std::string kind{};                   // "discrete GPU", "integrated GPU", "virtual GPU", "CPU", "other"
  std::uint64_t memoryBytes = 0;        // of the largest device-local heap
  std::uint32_t maxRecursionDepth = 0;  // of nested traces
  std::string unusableReason{};         // "no VK_KHR_ray_tracing_pipeline"; empty if Quintet can use the device
  // Quintet can use the device.
  bool usable() const { return unusableReason.empty(); }
};

// Sets environment variables of this process, and of those that it starts, that lavapipe needs: Mesa's driver for CPUs. Call it
// at the start of main(), before the process starts threads, because setenv is not safe while other threads read the
// environment. No other function of the library sets variables. Returns false and changes nothing if the process has more than
// one thread. GPUs do not need it. Without it, lavapipe is slower, and it cannot be used (DeviceInfo::unusableReason) if its
// LLVM is older than 19 and the CPU has AVX-512: its results would be wrong. A program that cannot call it can be started with
// GALLIUM_OVERRIDE_CPU_CAPS=avx. Variables that are set keep their values; QUINTET_NO_DRIVER_WORKAROUNDS=1 disables the function.
bool prepareDrivers();

// All devices of the machine, usable or not, GPUs before CPUs; empty without a Vulkan loader or driver.
std::vector<DeviceInfo> devices();

// Which device to open, and what it may keep on disk.
struct DeviceOptions {
  // Index, or part of the name, driver name or kind ("h200", "lavapipe", "cpu"). Empty means $QUINTET_DEVICE, else the first usable device.
  // A list ("0,2", or "all" for all usable devices of the kind of the first one) opens several: a Renderer then shares each
  // batch between them, and its images have the bytes of one device. If one of them is lost, the others render its samples
  // again. A device that is named twice is opened twice.
  std::string choice{};
  std::filesystem::path cacheFolder{};  // for compiled shaders and pipelines; empty means that they are kept in memory
  std::function<void(const std::string&)> onWarning{};  // of the driver; called from any thread; may be empty
  // A list can name different kinds of devices, which can differ in the last bit of a sample; "all" then means all of them.
  bool mixedDevices = false;
};

// An open device, or several. It must outlive the renderers that use it.
class Device {
 public:
  // Throws Error if no device can be used; the message gives the reason for each one. Throws UsageError for a list with
  // different kinds of devices without mixedDevices.
  explicit Device(const DeviceOptions& options = {});
  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;
  ~Device();
  DeviceInfo info() const;                // of the open device, or of the first one
  std::vector<DeviceInfo> infos() const;  // of all open devices, in the order of the list
  std::string name() const;               // info().name
  std::string driver() const;             // info().driver

 private:
  friend class Renderer;
  struct Impl;
  Impl& impl() const;  // throws UsageError for an empty object
  std::unique_ptr<Impl> impl_;
};

}  // namespace quintet
#endif

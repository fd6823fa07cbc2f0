// SPDX-License-Identifier: Apache-2.0
// Environment variables of Vulkan drivers, which work around their defects (docs/design/quirks.md).
#ifndef QUINTET_GPU_DRIVER_ENVIRONMENT_H
#define QUINTET_GPU_DRIVER_ENVIRONMENT_H

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace quintet::gpu {

// Sets the variables that docs/design/quirks.md lists, for this process and those that it starts. Drivers read them when they
// are loaded or list their devices. Variables that are set keep their values, and QUINTET_NO_DRIVER_WORKAROUNDS=1 disables this
// function. No other function changes the environment, because setenv is not safe while other threads call getenv: returns
// false and changes nothing if the process has more than one thread. Only the first call has an effect.
bool prepareDriverEnvironment();

// Returns why results of lavapipe would be wrong, and what to do; empty if the environment is correct for it. `driver`:
// DeviceInfo::driver, "lavapipe 25.0.7 (LLVM 15.0.6)".
std::string wrongEnvironment(std::string_view driver, bool cpuHasAvx512);
bool cpuHasAvx512();

// Number of threads that lavapipe starts in an instance that is created now: LP_NUM_THREADS, by default one per core.
unsigned lavapipeThreads();

// Returns the version of LLVM that the file name of a library states, as in "libLLVM-15.so.1" or "libLLVM.so.19.1"; 0 for other
// libraries.
int llvmVersion(std::string_view path);

// Returns the value of LP_NUM_THREADS that prepareDriverEnvironment() sets. `apiVersion`: of the driver's manifest; 0 if unknown.
unsigned balancingThreads(unsigned cores, std::uint32_t apiVersion);

// What the loader reads about a driver before it loads it.
struct DriverManifest {
  std::string library;           // as for dlopen
  std::uint32_t apiVersion = 0;  // 0: unknown
};
// Reads the text of a manifest in `folder`; nothing if it names no library.
std::optional<DriverManifest> parseManifest(std::string_view json, const std::filesystem::path& folder);
// The manifests of lavapipe that the loader finds.
std::vector<DriverManifest> lavapipeManifests();

}  // namespace quintet::gpu
#endif

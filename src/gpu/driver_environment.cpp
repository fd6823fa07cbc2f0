#include "gpu/driver_environment.h"

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <string>
#include <string_view>

#include "base/parallel.h"

namespace quintet::gpu {

namespace {

constexpr unsigned kThreadsPerCore = 8;
constexpr unsigned kMaxLavapipeThreads = 32;  // LP_MAX_THREADS of Mesa: more are not started

void setUnlessSet(const char* name, const std::string& value) { ::setenv(name, value.c_str(), /*overwrite=*/0); }

}  // namespace

unsigned lavapipeThreads(unsigned cores) {
  return std::min(kThreadsPerCore * std::max(cores, 1u), kMaxLavapipeThreads);
}

void prepareDriverEnvironment() {
  static std::once_flag once;
  std::call_once(once, [] {
    const char* off = std::getenv("QUINTET_NO_DRIVER_WORKAROUNDS");
    if (off && std::string_view(off) != "0") return;
#if defined(__x86_64__)
    // LLVM 15 miscompiles integer code for AVX-512; Mesa takes "avx" as "no AVX-512".
    setUnlessSet("GALLIUM_OVERRIDE_CPU_CAPS", "avx");
#endif
    // A launch is split into one contiguous part per thread: more parts than cores balance the load.
    setUnlessSet("LP_NUM_THREADS", std::to_string(lavapipeThreads(hardwareThreads())));
  });
}

}  // namespace quintet::gpu

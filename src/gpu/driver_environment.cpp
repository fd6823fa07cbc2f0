// SPDX-License-Identifier: Apache-2.0
#include "gpu/driver_environment.h"

#include <dlfcn.h>
#include <link.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <iterator>
#include <mutex>
#include <system_error>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/parallel.h"
#include "base/parse.h"
#include "gpu/vulkan.h"

namespace quintet::gpu {
namespace {

constexpr unsigned kThreadsPerCore = 8;
constexpr unsigned kMaxLavapipeThreads = 32;  // LP_MAX_THREADS of Mesa, which starts no more
// Mesa 25.0, the last version whose threads do not wait actively for each other in builds, has the headers of this version.
constexpr std::uint32_t kLastBalanced = VK_MAKE_API_VERSION(0, 1, 4, 305);

constexpr const char* kLavapipeThreads = "LP_NUM_THREADS";
constexpr const char* kCpuCaps = "GALLIUM_OVERRIDE_CPU_CAPS";
constexpr const char* kWithoutAvx512 = "avx";  // how Mesa names it
constexpr int kCorrectLlvm = 19;               // the oldest version that is known to be correct for AVX-512

bool adaptsDrivers() {
  const char* off = std::getenv("QUINTET_NO_DRIVER_WORKAROUNDS");
  return !off || std::string_view(off) == "0";
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

void setUnlessSet(const char* name, const std::string& value) { ::setenv(name, value.c_str(), /*overwrite=*/0); }

bool hasOneThread() {
  std::error_code error;
  const std::filesystem::directory_iterator threads("/proc/self/task", error);
  return error || std::distance(begin(threads), end(threads)) == 1;
}

// Loads the drivers, which stay loaded, and returns the oldest version of LLVM among the loaded libraries; 0 if there is none.
int loadedLlvm(const std::vector<DriverManifest>& drivers) {
  for (const DriverManifest& driver : drivers) static_cast<void>(::dlopen(driver.library.c_str(), RTLD_LAZY));
  int oldest = 0;
  const auto visit = [](dl_phdr_info* info, std::size_t, void* data) {
    int& found = *static_cast<int*>(data);
    const int version = info->dlpi_name ? llvmVersion(info->dlpi_name) : 0;
    if (version > 0 && (found == 0 || version < found)) found = version;
    return 0;
  };
  dl_iterate_phdr(visit, &oldest);
  return oldest;
}

// The string after "NAME": in JSON; empty if it is missing. Manifests have no escapes.
std::string_view stringOf(std::string_view json, std::string_view name) {
  const std::size_t key = json.find(fmt::format("\"{}\"", name));
  const std::size_t colon = key == json.npos ? key : json.find(':', key + name.size() + 2);
  const std::size_t begin = colon == json.npos ? colon : json.find('"', colon);
  const std::size_t end = begin == json.npos ? begin : json.find('"', begin + 1);
  return end == json.npos ? std::string_view() : json.substr(begin + 1, end - begin - 1);
}

// The folders and files in which the loader looks for manifests, without those of the registry of other systems.
std::vector<std::filesystem::path> manifestLocations() {
  std::vector<std::filesystem::path> locations;
  const auto add = [&](const std::string& list, const char* below) {
    for (const std::string& item : splitText(list, ':'))
      if (!item.empty())
        locations.push_back(*below ? std::filesystem::path(item) / below : std::filesystem::path(item));
  };
  const auto orDefault = [](const char* name, const std::string& otherwise) {
    const std::string value = variable(name);
    return value.empty() ? otherwise : value;
  };
  add(variable("VK_ADD_DRIVER_FILES"), "");
  const std::string named = orDefault("VK_DRIVER_FILES", variable("VK_ICD_FILENAMES"));
  if (!named.empty()) {
    add(named, "");
    return locations;
  }
  const std::string home = variable("HOME");
  add(orDefault("XDG_CONFIG_HOME", home + "/.config"), "vulkan/icd.d");
  add(orDefault("XDG_CONFIG_DIRS", "/etc/xdg") + ":/etc", "vulkan/icd.d");
  add(orDefault("XDG_DATA_HOME", home + "/.local/share"), "vulkan/icd.d");
  add(orDefault("XDG_DATA_DIRS", "/usr/local/share:/usr/share"), "vulkan/icd.d");
  return locations;
}

void addManifest(const std::filesystem::path& file, std::vector<DriverManifest>& manifests) {
  try {
    std::optional<DriverManifest> manifest = parseManifest(readTextFile(file), file.parent_path());
    const bool isLavapipe =
        manifest && std::filesystem::path(manifest->library).filename().string().find("lvp") != std::string::npos;
    if (isLavapipe) manifests.push_back(std::move(*manifest));
  } catch (const Error&) {  // the loader reports it
  }
}

}  // namespace

std::optional<DriverManifest> parseManifest(std::string_view json, const std::filesystem::path& folder) {
  DriverManifest manifest;
  manifest.library = stringOf(json, "library_path");
  if (manifest.library.empty()) return std::nullopt;
  if (manifest.library.find('/') != std::string::npos) manifest.library = (folder / manifest.library).string();
  unsigned parts[3] = {};
  std::string_view version = stringOf(json, "api_version");
  for (unsigned& part : parts) {
    const auto [end, error] = std::from_chars(version.data(), version.data() + version.size(), part);
    if (error != std::errc()) return manifest;
    version.remove_prefix(std::min<std::size_t>(static_cast<std::size_t>(end - version.data()) + 1, version.size()));
  }
  manifest.apiVersion = VK_MAKE_API_VERSION(0, parts[0], parts[1], parts[2]);
  return manifest;
}

std::vector<DriverManifest> lavapipeManifests() {
  std::vector<DriverManifest> manifests;
  for (const std::filesystem::path& location : manifestLocations()) {
    std::error_code error;
    if (!std::filesystem::is_directory(location, error)) {
      addManifest(location, manifests);
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(location, error)) addManifest(entry.path(), manifests);
  }
  return manifests;
}

int llvmVersion(std::string_view path) {
  const std::string_view name = path.substr(path.rfind('/') + 1);
  const std::size_t digit = name.find_first_of("0123456789");
  int version = 0;
  if (name.starts_with("libLLVM") && digit != std::string_view::npos)
    std::from_chars(name.data() + digit, name.data() + name.size(), version);
  return version;
}

unsigned lavapipeThreads() {
  const char* preset = std::getenv(kLavapipeThreads);
  const long wanted = preset ? std::strtol(preset, nullptr, 0) : static_cast<long>(hardwareThreads());
  return static_cast<unsigned>(std::clamp<long>(wanted, 0, kMaxLavapipeThreads));
}

unsigned balancingThreads(unsigned cores, std::uint32_t apiVersion) {
  const unsigned perCore = apiVersion > kLastBalanced ? 1 : kThreadsPerCore;
  return std::min(perCore * std::max(cores, 1u), kMaxLavapipeThreads);
}

bool cpuHasAvx512() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx512f");
#else
  return false;
#endif
}

std::string wrongEnvironment(std::string_view driver, bool hasAvx512) {
  if (!hasAvx512 || !adaptsDrivers() || std::getenv(kCpuCaps) || !driver.starts_with("lavapipe ")) return "";
  constexpr std::string_view kLabel = "(LLVM ";
  const std::size_t label = driver.find(kLabel);
  int version = 0;
  if (label != driver.npos)
    std::from_chars(driver.data() + label + kLabel.size(), driver.data() + driver.size(), version);
  if (version == 0 || version >= kCorrectLlvm) return "";
  return fmt::format(
      "LLVM {} computes wrong values with AVX-512; call quintet::prepareDrivers() before the program starts "
      "threads, or start it with {}={}",
      version, kCpuCaps, kWithoutAvx512);
}

bool prepareDriverEnvironment() {
  static std::once_flag once;
  static bool prepared = true;
  std::call_once(once, [] {
    if (!adaptsDrivers()) return;
    prepared = hasOneThread();
    if (!prepared) return;
    const std::vector<DriverManifest> lavapipe = lavapipeManifests();
    // LLVM 15 miscompiles integer code for AVX-512. Mesa interprets "avx" as "no AVX-512".
    if (cpuHasAvx512() && !std::getenv(kCpuCaps) && loadedLlvm(lavapipe) < kCorrectLlvm)
      setUnlessSet(kCpuCaps, kWithoutAvx512);
    // lavapipe splits a launch into one contiguous part per thread. More parts than cores balance the load.
    std::uint32_t version = 0;
    for (const DriverManifest& manifest : lavapipe) version = std::max(version, manifest.apiVersion);
    setUnlessSet(kLavapipeThreads, std::to_string(balancingThreads(hardwareThreads(), version)));
  });
  return prepared;
}

}  // namespace quintet::gpu

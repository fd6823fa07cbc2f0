// SPDX-License-Identifier: Apache-2.0
#include "gpu/driver_environment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <thread>

#include "base/parallel.h"
#include "gpu/vulkan.h"
#include "temp_folder.h"

namespace quintet::gpu {
namespace {

constexpr std::uint32_t kMesa25_0 = VK_MAKE_API_VERSION(0, 1, 4, 305);
constexpr std::uint32_t kMesa26_1 = VK_MAKE_API_VERSION(0, 1, 4, 335);

TEST(DriverEnvironment, StartsMoreLavapipeThreadsThanCores) {
  for (const std::uint32_t version : {0u, VK_MAKE_API_VERSION(0, 1, 3, 289), kMesa25_0}) {
    EXPECT_EQ(balancingThreads(0, version), 8u);
    EXPECT_EQ(balancingThreads(1, version), 8u);
    EXPECT_EQ(balancingThreads(2, version), 16u);
    EXPECT_EQ(balancingThreads(4, version), 32u);
    EXPECT_EQ(balancingThreads(64, version), 32u);
  }
}

TEST(DriverEnvironment, StartsAThreadPerCoreIfBuildsWait) {
  for (const std::uint32_t version : {kMesa25_0 + 1, kMesa26_1}) {
    EXPECT_EQ(balancingThreads(0, version), 1u);
    EXPECT_EQ(balancingThreads(2, version), 2u);
    EXPECT_EQ(balancingThreads(64, version), 32u);
  }
}

// Environment variables that get their values back at the end of the test.
class Variables {
 public:
  void set(const char* name, const char* value) {
    if (!before_.contains(name))
      before_[name] = std::getenv(name) ? std::optional<std::string>(std::getenv(name)) : std::nullopt;
    apply(name, value ? std::optional<std::string>(value) : std::nullopt);
  }
  Variables() = default;
  Variables(const Variables&) = delete;
  Variables& operator=(const Variables&) = delete;
  ~Variables() {
    for (const auto& [name, value] : before_) apply(name.c_str(), value);
  }

 private:
  static void apply(const char* name, const std::optional<std::string>& value) {
    value ? ::setenv(name, value->c_str(), 1) : ::unsetenv(name);
  }
  std::map<std::string, std::optional<std::string>> before_;
};

TEST(DriverEnvironment, ReadsTheNumberOfLavapipeThreads) {
  Variables variables;
  variables.set("LP_NUM_THREADS", "3");
  EXPECT_EQ(lavapipeThreads(), 3u);
  variables.set("LP_NUM_THREADS", "500");
  EXPECT_EQ(lavapipeThreads(), 32u);
  variables.set("LP_NUM_THREADS", nullptr);
  EXPECT_EQ(lavapipeThreads(), std::min(hardwareThreads(), 32u));
}

TEST(DriverEnvironment, ReadsTheVersionOfLlvm) {
  EXPECT_EQ(llvmVersion("/usr/lib/x86_64-linux-gnu/libLLVM-15.so.1"), 15);
  EXPECT_EQ(llvmVersion("/lib/x86_64-linux-gnu/libLLVM.so.19.1"), 19);
  EXPECT_EQ(llvmVersion("libLLVM-17.so"), 17);
  for (const char* other : {"", "/usr/lib/libLLVM.so", "/opt/libLLVM-15/libvulkan.so.1", "libvulkan_lvp.so"})
    EXPECT_EQ(llvmVersion(other), 0) << other;
}

// Wrong values are an error that says what to do, not an image.
TEST(DriverEnvironment, RejectsLlvmThatMiscompilesAvx512) {
  Variables variables;
  variables.set("GALLIUM_OVERRIDE_CPU_CAPS", nullptr);
  variables.set("QUINTET_NO_DRIVER_WORKAROUNDS", nullptr);
  const std::string driver = "lavapipe 25.0.7-2~bpo12+1 (LLVM 15.0.6)";
  EXPECT_THAT(
      wrongEnvironment(driver, true),
      testing::AllOf(testing::HasSubstr("LLVM 15 computes wrong values with AVX-512"),
                     testing::HasSubstr("prepareDrivers()"), testing::HasSubstr("GALLIUM_OVERRIDE_CPU_CAPS=avx")));
  EXPECT_EQ(wrongEnvironment(driver, false), "") << "the CPU has no AVX-512";
  EXPECT_NE(wrongEnvironment("lavapipe 25.1 (LLVM 18.1.8)", true), "");
  EXPECT_EQ(wrongEnvironment("lavapipe 26.1.6 (LLVM 19.1.7)", true), "");
  EXPECT_EQ(wrongEnvironment("lavapipe 26.1.6", true), "");
  EXPECT_EQ(wrongEnvironment("NVIDIA 580.159.04 (LLVM 15.0.6)", true), "");
  variables.set("QUINTET_NO_DRIVER_WORKAROUNDS", "1");
  EXPECT_EQ(wrongEnvironment(driver, true), "");
  variables.set("QUINTET_NO_DRIVER_WORKAROUNDS", "0");
  EXPECT_NE(wrongEnvironment(driver, true), "");
  variables.set("GALLIUM_OVERRIDE_CPU_CAPS", "avx");
  EXPECT_EQ(wrongEnvironment(driver, true), "");
}

TEST(DriverEnvironment, ReadsManifests) {
  const auto debian = parseManifest(
      R"({"ICD": {"api_version": "1.4.305", "library_path": "libvulkan_lvp.so"}, "file_format_version": "1.0.0"})",
      "/a");
  ASSERT_TRUE(debian);
  EXPECT_EQ(debian->library, "libvulkan_lvp.so");
  EXPECT_EQ(debian->apiVersion, kMesa25_0);
  const auto relative =
      parseManifest(R"({"ICD":{"library_path":"../lib/libvulkan_lvp.so","api_version":"1.4"}})", "/opt/mesa/icd.d");
  ASSERT_TRUE(relative);
  EXPECT_EQ(relative->library, "/opt/mesa/icd.d/../lib/libvulkan_lvp.so");
  EXPECT_EQ(relative->apiVersion, 0u);
  EXPECT_EQ(parseManifest(R"({"ICD": {"library_path": "/usr/lib/libvulkan_lvp.so"}})", "/a")->library,
            "/usr/lib/libvulkan_lvp.so");
  for (const char* invalid :
       {"", "{}", "library_path", R"({"library_path)", R"({"library_path": "open)", R"({"library_path": 3})"})
    EXPECT_FALSE(parseManifest(invalid, "/a")) << invalid;
}

TEST(DriverEnvironment, FindsTheManifestsOfLavapipe) {
  const test::TempFolder folder;
  const auto write = [&](const char* name, const char* library) {
    std::ofstream(folder.path() / name) << "{\"ICD\": {\"library_path\": \"" << library
                                        << "\", \"api_version\": \"1.4.335\"}}";
    return (folder.path() / name).string();
  };
  const std::string lavapipe = write("lvp.json", "libvulkan_lvp.so"), intel = write("intel.json", "libvulkan_intel.so");
  Variables variables;
  variables.set("VK_ICD_FILENAMES", nullptr);
  variables.set("VK_ADD_DRIVER_FILES", nullptr);
  variables.set("VK_DRIVER_FILES", (intel + ":" + lavapipe + ":/missing.json").c_str());
  ASSERT_EQ(lavapipeManifests().size(), 1u);
  EXPECT_EQ(lavapipeManifests()[0].apiVersion, kMesa26_1);
  variables.set("VK_DRIVER_FILES", folder.path().c_str());
  EXPECT_EQ(lavapipeManifests().size(), 1u) << "a folder";
  variables.set("VK_DRIVER_FILES", intel.c_str());
  EXPECT_TRUE(lavapipeManifests().empty());
}

// setenv is not safe while another thread reads the environment.
TEST(DriverEnvironmentDeathTest, StaysWithOtherThreads) {
  const auto run = [](bool withThread) {
    ::unsetenv("LP_NUM_THREADS");
    ::unsetenv("QUINTET_NO_DRIVER_WORKAROUNDS");
    std::thread other;
    if (withThread) other = std::thread([] { std::this_thread::sleep_for(std::chrono::seconds(60)); });
    const bool prepared = prepareDriverEnvironment();
    std::_Exit(2 * (prepared ? 1 : 0) + (std::getenv("LP_NUM_THREADS") ? 1 : 0));
  };
  EXPECT_EXIT(run(false), testing::ExitedWithCode(3), "");
  EXPECT_EXIT(run(true), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace quintet::gpu

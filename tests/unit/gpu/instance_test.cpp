// SPDX-License-Identifier: Apache-2.0
// The environment variables of drivers, and the messages of the validation layers.
#include "gpu/instance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "base/parallel.h"

namespace quintet::gpu {
namespace {

TEST(DriverEnvironment, StartsMoreLavapipeThreadsThanCores) {
  EXPECT_EQ(balancingThreads(0), 8u);
  EXPECT_EQ(balancingThreads(1), 8u);
  EXPECT_EQ(balancingThreads(2), 16u);
  EXPECT_EQ(balancingThreads(4), 32u);
  EXPECT_EQ(balancingThreads(64), 32u);
}

// An environment variable that gets its value back at the end of the test.
class Variable {
 public:
  explicit Variable(const char* name) : name_(name) {
    if (const char* value = std::getenv(name)) before_ = value;
  }
  ~Variable() {
    if (before_)
      set(*before_);
    else
      ::unsetenv(name_);
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;
  void set(const std::string& value) { ::setenv(name_, value.c_str(), 1); }

 private:
  const char* name_;
  std::optional<std::string> before_;
};

class LavapipeThreads : public testing::Test {
 protected:
  void set(unsigned count) { threads.set(std::to_string(count)); }

  Variable threads{"LP_NUM_THREADS"}, own{"QUINTET_DRIVER_VARIABLES"};
  const unsigned cores = hardwareThreads();
};

TEST_F(LavapipeThreads, AreThoseOfTheVariable) {
  set(3);
  EXPECT_EQ(lavapipeThreads(), 3u);
  set(500);
  EXPECT_EQ(lavapipeThreads(), 32u);
  ::unsetenv("LP_NUM_THREADS");
  EXPECT_EQ(lavapipeThreads(), std::min(cores, 32u));
}

TEST_F(LavapipeThreads, AreOnePerCoreIfBuildsWait) {
  if (balancingThreads(cores) == cores) GTEST_SKIP() << "this machine has " << cores << " cores";
  set(balancingThreads(cores));
  own.set("");  // a choice of the user
  EXPECT_FALSE(adaptDriverEnvironment({.waitsInBuilds = true}));
  own.set("GALLIUM_OVERRIDE_CPU_CAPS LP_NUM_THREADS");
  EXPECT_FALSE(adaptDriverEnvironment({}));
  EXPECT_EQ(lavapipeThreads(), balancingThreads(cores));
  EXPECT_TRUE(adaptDriverEnvironment({.waitsInBuilds = true}));
  EXPECT_EQ(lavapipeThreads(), std::min(cores, 32u));
  EXPECT_FALSE(adaptDriverEnvironment({.waitsInBuilds = true})) << "there is nothing more to adapt";
}

TEST(DriverEnvironment, ReadsTheVersionOfLlvm) {
  EXPECT_EQ(llvmVersion("/usr/lib/x86_64-linux-gnu/libLLVM-15.so.1"), 15);
  EXPECT_EQ(llvmVersion("/lib/x86_64-linux-gnu/libLLVM.so.19.1"), 19);
  EXPECT_EQ(llvmVersion("libLLVM-17.so"), 17);
  for (const char* other : {"", "/usr/lib/libLLVM.so", "/opt/libLLVM-15/libvulkan.so.1", "libvulkan_lvp.so"})
    EXPECT_EQ(llvmVersion(other), 0) << other;
}

TEST(ValidationSink, CountsOnlyMessagesOfValidationLayers) {
  std::vector<std::string> log;
  ValidationSink sink([&](LogLevel, const std::string& line) { log.push_back(line); });
  const VkDebugUtilsMessengerCreateInfoEXT info = sink.messengerInfo();
  VkDebugUtilsMessengerCallbackDataEXT data{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CALLBACK_DATA_EXT};
  data.pMessageIdName = "VUID-some-rule";
  data.pMessage = "two\nlines";
  info.pfnUserCallback(VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT, VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
                       &data, info.pUserData);
  EXPECT_EQ(sink.count(), 1u);
  EXPECT_THAT(sink.messages(), testing::ElementsAre("Vulkan validation: VUID-some-rule: two lines"));
  data.pMessageIdName = nullptr;
  info.pfnUserCallback(VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT, VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT,
                       &data, info.pUserData);
  EXPECT_EQ(sink.count(), 1u) << "messages of the loader are not errors of this program";
  EXPECT_EQ(log.size(), 2u);
}

}  // namespace
}  // namespace quintet::gpu

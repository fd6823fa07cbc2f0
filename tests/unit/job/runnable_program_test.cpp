// SPDX-License-Identifier: Apache-2.0
// Which probes a request requires, and the error on devices without a clock.
#include "job/runnable_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "program/heat.h"

namespace quintet::job {
namespace {

using testing::AllOf;
using testing::HasSubstr;

program::Program programWith(const std::vector<std::string>& heatMaps) {
  program::Program program;
  program.outputs.push_back({.name = "color"});
  return program::withHeatMaps(std::move(program), heatMaps);
}

TEST(RequestedProbes, FollowTheRequest) {
  const program::Program program = programWith({"heat_rays", "heat_time"});
  RenderRequest request;
  EXPECT_FALSE(requestedProbes(request, program, {}).prints);
  EXPECT_FALSE(requestedProbes(request, program, {}).heat);
  request.outputs = {"heat_rays"};
  EXPECT_TRUE(requestedProbes(request, program, {}).heat);
  request.print.emplace();
  EXPECT_TRUE(requestedProbes(request, program, {}).prints);
}

TEST(RequestedProbes, TimeRequiresAClock) {
  RenderRequest request;
  request.outputs = {"heat_time"};
  gpu::DeviceInfo device;
  device.name = "Old GPU";
  try {
    requestedProbes(request, programWith({"heat_time"}), device);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("'heat_time'"), HasSubstr("Old GPU has no clock"), HasSubstr("VK_KHR_shader_clock")));
  }
  device.shaderClock = true;
  EXPECT_TRUE(requestedProbes(request, programWith({"heat_time"}), device).heat);
  // The clock of a CPU counts the time of other threads, too.
  device.software = true;
  EXPECT_THROW(requestedProbes(request, programWith({"heat_time"}), device), UsageError);
  request.outputs = {"heat_rays"};
  EXPECT_TRUE(requestedProbes(request, programWith({"heat_rays"}), device).heat);
  request.outputs = {"heat_time"};
  // An output of the program with this name needs no clock.
  program::Program own = programWith({});
  own.outputs.push_back({.name = "heat_time"});
  EXPECT_FALSE(requestedProbes(request, own, {}).heat);
}

}  // namespace
}  // namespace quintet::job

// SPDX-License-Identifier: Apache-2.0
#include "checks.h"

#include <cstdio>
#include <exception>

#include <fmt/ranges.h>

#include "harness.h"

namespace quintet::oracle {
namespace {

// Returns the first version in a text such as "Mesa 25.0.7-2 (LLVM 15)" or "580.159.04". VkPhysicalDeviceProperties has
// no version of lavapipe: its driverVersion is 1.
std::uint32_t versionIn(const std::string& text) {
  std::uint32_t numbers[3] = {};
  const std::size_t first = text.find_first_of("0123456789");
  if (first != std::string::npos) std::sscanf(text.c_str() + first, "%u.%u.%u", &numbers[0], &numbers[1], &numbers[2]);
  return VK_MAKE_API_VERSION(0, numbers[0], numbers[1], numbers[2]);
}

}  // namespace

Driver testDriver() {
  VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  properties.pNext = &driver;
  vkGetPhysicalDeviceProperties2(test::testContext().physicalDevice(), &properties);
  return {driver.driverID, versionIn(driver.driverInfo)};
}

Verdict judge(const Driver& driver, const KnownQuirk* quirk, std::size_t wrong) {
  const bool affected = quirk && quirk->driver == driver.id && driver.version >= quirk->first &&
                        (quirk->fixed == 0 || driver.version < quirk->fixed);
  if (wrong > 0) return affected ? Verdict::knownQuirk : Verdict::fail;
  if (!affected || quirk->sporadic || driver.version < quirk->version) return Verdict::pass;
  return quirk->fixed != 0 && driver.version > quirk->version ? Verdict::pass : Verdict::fixed;
}

Checks::~Checks() {
  if (!finished_ && !std::uncaught_exceptions()) ADD_FAILURE() << "the test must end with Checks::done()";
}

void Checks::finish(const KnownQuirk* quirk) {
  finished_ = true;
  const std::size_t total = hard_.total + soft_.total;
  testing::Test::RecordProperty("values", fmt::format("{}", total));
  if (quirk) testing::Test::RecordProperty("quirk", std::string(quirk->id));
  if (total == 0) ADD_FAILURE() << "the test compares no values";
  if (hard_.wrong > 0)
    ADD_FAILURE() << fmt::format("{} of {} values are wrong:\n  {}", hard_.wrong, hard_.total,
                                 fmt::join(hard_.messages, "\n  "));
  switch (judge(testDriver(), quirk, soft_.wrong)) {
    case Verdict::pass: break;
    case Verdict::knownQuirk: testing::Test::RecordProperty("wrong", fmt::format("{}", soft_.wrong)); break;
    case Verdict::fixed:
      ADD_FAILURE() << fmt::format(
          "the driver is fixed: remove the workaround for '{}' ({}), see docs/design/quirks.md", quirk->id,
          quirk->text);
      break;
    case Verdict::fail:
      ADD_FAILURE() << fmt::format("{} of {} values are wrong:\n  {}", soft_.wrong, soft_.total,
                                   fmt::join(soft_.messages, "\n  "));
      break;
  }
}

}  // namespace quintet::oracle

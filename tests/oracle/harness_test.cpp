// SPDX-License-Identifier: Apache-2.0
// Tests of the oracle itself.
#include <algorithm>

#include "checks.h"

namespace quintet::oracle::harness_test {
namespace {

constexpr std::uint32_t version(std::uint32_t major, std::uint32_t minor, std::uint32_t patch) {
  return VK_MAKE_API_VERSION(0, major, minor, patch);
}

TEST(Harness, EvaluatesQuirksByDriverAndVersion) {
  constexpr KnownQuirk quirk{.id = "test", .text = "for this test", .version = version(25, 0, 7)};
  constexpr KnownQuirk sporadic{.id = "test", .text = "for this test", .sporadic = true, .version = version(25, 0, 7)};
  const Driver same{quirk.driver, version(25, 0, 7)}, older{quirk.driver, version(24, 3, 0)},
      newer{quirk.driver, version(26, 0, 0)}, other{VK_DRIVER_ID_NVIDIA_PROPRIETARY, version(580, 0, 0)};
  Checks checks;
  const auto verdict = [&](const Driver& driver, const KnownQuirk* q, std::size_t wrong, Verdict expected) {
    checks.equal(static_cast<int>(judge(driver, q, wrong)), static_cast<int>(expected), "driver {}, {} wrong",
                 driver.version, wrong);
  };
  for (const Driver& driver : {same, older, newer}) {
    verdict(driver, &quirk, 3, Verdict::knownQuirk);
    verdict(driver, nullptr, 3, Verdict::fail);
    verdict(driver, nullptr, 0, Verdict::pass);
    verdict(driver, &sporadic, 0, Verdict::pass);
  }
  verdict(older, &quirk, 0, Verdict::pass);
  verdict(same, &quirk, 0, Verdict::fixed);
  verdict(newer, &quirk, 0, Verdict::fixed);
  constexpr KnownQuirk fixed{
      .id = "test", .text = "for this test", .version = version(25, 0, 7), .fixed = version(26, 0, 0)};
  constexpr KnownQuirk recent{
      .id = "test", .text = "for this test", .version = version(26, 0, 0), .first = version(25, 0, 7)};
  const Driver between{quirk.driver, version(25, 3, 0)};
  verdict(older, &fixed, 1, Verdict::knownQuirk);
  verdict(same, &fixed, 1, Verdict::knownQuirk);
  verdict(same, &fixed, 0, Verdict::fixed);
  verdict(between, &fixed, 1, Verdict::knownQuirk);
  verdict(between, &fixed, 0, Verdict::pass);
  verdict(newer, &fixed, 1, Verdict::fail);
  verdict(newer, &fixed, 0, Verdict::pass);
  verdict(older, &recent, 1, Verdict::fail);
  verdict(between, &recent, 1, Verdict::knownQuirk);
  verdict(between, &recent, 0, Verdict::pass);
  verdict(newer, &recent, 1, Verdict::knownQuirk);
  verdict(newer, &recent, 0, Verdict::fixed);
  verdict(other, &quirk, 0, Verdict::pass);
  verdict(other, &quirk, 1, Verdict::fail);
  verdict(other, &sporadic, 1, Verdict::fail);
  checks.done();
}

TEST(Harness, HasUniqueQuirkIds) {
  Checks checks;
  for (const KnownQuirk& quirk : kAllQuirks)
    checks.equal(std::ranges::count(kAllQuirks, quirk.id, &KnownQuirk::id), std::ptrdiff_t{1}, "{}", quirk.id);
  checks.done();
}

}  // namespace
}  // namespace quintet::oracle::harness_test

// SPDX-License-Identifier: Apache-2.0
// quintet_oracle_tests: supports the options of GoogleTest and --table (table.h).
#include <cstdio>
#include <string_view>

#include "harness.h"
#include "known_quirks.h"
#include "table.h"

int main(int argc, char** argv) {
  using namespace quintet;
  bool wantsTable = false;
  for (int k = 1; k < argc; ++k) wantsTable |= std::string_view(argv[k]) == "--table";
  testing::InitGoogleTest(&argc, argv);
  auto* const table = new oracle::TableListener;
  testing::TestEventListeners& listeners = testing::UnitTest::GetInstance()->listeners();
  if (wantsTable) delete listeners.Release(listeners.default_result_printer());
  listeners.Append(table);

  std::string device;
  try {
    device = test::testContext().info().name + ", " + test::testContext().info().driver;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  int result = test::runDeviceTests();
  if (wantsTable) std::printf("%s", table->markdown(device).c_str());
  const bool all = testing::GTEST_FLAG(filter) == "*" && !testing::GTEST_FLAG(list_tests);
  if (all)
    for (const std::string& id : table->untestedQuirks()) {
      std::fprintf(stderr, "no test uses the known quirk '%s'\n", id.c_str());
      result = 1;
    }
  return result;
}

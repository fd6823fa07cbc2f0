// SPDX-License-Identifier: Apache-2.0
// `@NAME@`: its output and its errors. Replace this example.
#include <gmock/gmock.h>

#include "fixtures.h"

namespace quintet::test {
namespace {

class @Name@Command : public CliTest {};

TEST_F(@Name@Command, PrintsTheNumberOfBytes) {
  write(folder_ / "three", "abc");
  const RunResult result = quintet({"@NAME@", "three"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out, "3\n");
  EXPECT_EQ(result.err, "");
}

TEST_F(@Name@Command, RequiresAFile) { expectError(quintet({"@NAME@"}), 2, {"no file given"}); }

TEST_F(@Name@Command, NamesAFileThatIsMissing) {
  expectError(quintet({"@NAME@", "missing.glb"}), 1, {"missing.glb"});
}

}  // namespace
}  // namespace quintet::test

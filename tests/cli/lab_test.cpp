// SPDX-License-Identifier: Apache-2.0
// `quintet lab` finds and starts its server. tests/lab tests the server itself.
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "fixtures.h"

namespace quintet::test {
namespace {

// A copy of the binary in a folder of its own, because the build can have a server.
class LabCommand : public CliTest {
 protected:
  RunResult labAlone(const std::vector<std::string>& arguments) {
    std::filesystem::create_directory(folder_ / "alone");
    return quintet(arguments, {.shell = "cp \"$1\" alone/quintet && shift && set -- alone/quintet \"$@\" && "
                                        "export PATH=\"$PWD/bin:/usr/bin:/bin\""});
  }
};

TEST_F(LabCommand, StartsTheServerWithAllArguments) {
  std::filesystem::create_directory(folder_ / "bin");
  const std::filesystem::path server = folder_ / "bin/quintet-lab";
  write(server, "#!/bin/sh\nprintf '%s|' \"$@\"\nexit 7\n");
  std::filesystem::permissions(server, std::filesystem::perms::owner_all);
  const RunResult result = labAlone({"lab", "my programs", "--no-open", "--port", "0"});
  EXPECT_EQ(result.out, "my programs|--no-open|--port|0|") << result.err;
  EXPECT_EQ(result.status, 7);
}

TEST_F(LabCommand, ReportsThatTheServerIsMissing) {
  expectError(labAlone({"lab"}), 1, {"quintet-lab", "scripts/setup.sh lab", "-DQUINTET_LAB=ON"});
}

TEST_F(LabCommand, RejectsWrongOptions) {
  expectError(quintet({"lab", "--port", "70000"}), 2, {"--port", "70000"});
  expectError(quintet({"lab", "--size", "9000x10"}), 2, {"--size", "4096"});
  expectError(quintet({"lab", "--timeout", "0"}), 2, {"--timeout"});
  expectError(quintet({"lab", "--opne"}), 2, {"--opne"});
}

}  // namespace
}  // namespace quintet::test

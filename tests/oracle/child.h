// SPDX-License-Identifier: Apache-2.0
// Runs one test of this executable in a separate process, for tests that can crash or need different environment
// variables.
#ifndef QUINTET_TESTS_ORACLE_CHILD_H
#define QUINTET_TESTS_ORACLE_CHILD_H

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace quintet::oracle {

enum class ChildEnd { passed, failed, crashed };

// `test` has the form "Suite.DISABLED_Name". Variables of `environment` without a value are unset.
using Variables = std::vector<std::pair<std::string, std::optional<std::string>>>;
ChildEnd runInChild(const std::string& test, const Variables& environment = {});

}  // namespace quintet::oracle
#endif

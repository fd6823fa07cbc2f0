// Runs one test of this binary in a process of its own: for what may crash, or needs another environment.
#ifndef QUINTET_TESTS_ORACLE_CHILD_H
#define QUINTET_TESTS_ORACLE_CHILD_H

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace quintet::oracle {

enum class ChildEnd { passed, failed, crashed };

// `test`: "Suite.DISABLED_Name". `environment`: variables to set, or to unset (no value).
using Variables = std::vector<std::pair<std::string, std::optional<std::string>>>;
ChildEnd runInChild(const std::string& test, const Variables& environment = {});

}  // namespace quintet::oracle
#endif

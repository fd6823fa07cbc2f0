// Runs one test of this binary in a process of its own: for what may crash, or needs another environment.
#ifndef QUINTET_TESTS_ORACLE_CHILD_H
#define QUINTET_TESTS_ORACLE_CHILD_H

#include <string>
#include <utility>
#include <vector>

namespace quintet::oracle {

enum class ChildEnd { passed, failed, crashed };

// `test`: "Suite.DISABLED_Name". `environment`: variables to set.
ChildEnd runInChild(const std::string& test, const std::vector<std::pair<std::string, std::string>>& environment = {});

}  // namespace quintet::oracle
#endif

// SPDX-License-Identifier: Apache-2.0
// `quintet_oracle_tests --table`: the results as a Markdown table, for docs/measurements.md.
#ifndef QUINTET_TESTS_ORACLE_TABLE_H
#define QUINTET_TESTS_ORACLE_TABLE_H

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace quintet::oracle {

class TableListener : public testing::EmptyTestEventListener {
 public:
  void OnTestEnd(const testing::TestInfo& test) override;
  // Returns one row per test, then the sums and the complete failures.
  std::string markdown(const std::string& device) const;
  // Returns the ids of the entries of kAllQuirks that no test used.
  std::vector<std::string> untestedQuirks() const;

 private:
  struct Row {
    std::string suite, name, values, quirk, wrong, failure;
  };
  std::vector<Row> rows_;
};

}  // namespace quintet::oracle
#endif

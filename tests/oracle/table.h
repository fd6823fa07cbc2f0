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
  // A row for each test, then the sums; failures in full below.
  std::string markdown(const std::string& device) const;
  // Ids of the entries of kAllQuirks that no test has named.
  std::vector<std::string> untestedQuirks() const;

 private:
  struct Row {
    std::string suite, name, values, quirk, wrong, failure;
  };
  std::vector<Row> rows_;
};

}  // namespace quintet::oracle
#endif

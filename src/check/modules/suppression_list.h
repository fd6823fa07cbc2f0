// SPDX-License-Identifier: Apache-2.0
// Suppression file: diagnostics that the user of an application accepts, without a change of its shaders. One per line:
//
//   Q104                          # each diagnostic with this id
//   Q104 raygen.rgen              # in files with this name or path
//   Q104 shaders/raygen.rgen:12   # in this line
//
// Unlike comments in sources (check/suppression.h), it can also name errors.
#ifndef QUINTET_CHECK_MODULES_SUPPRESSION_LIST_H
#define QUINTET_CHECK_MODULES_SUPPRESSION_LIST_H

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "check/suppression.h"

namespace quintet::check {

class SuppressionList {
 public:
  SuppressionList() = default;
  // Throws FileError with the line of what is wrong.
  static SuppressionList parse(const std::filesystem::path& file, std::string_view text);

  bool accepts(const Diagnostic& diagnostic) const;
  // Moves the accepted diagnostics from the list to the result.
  std::vector<SuppressedDiagnostic> apply(std::vector<Diagnostic>& diagnostics) const;

 private:
  struct Entry {
    std::string id;
    std::string file;  // the end of a path; empty for each file
    int line = 0;      // 0 for each line
    std::string reason;
    SourceLocation location;
  };
  const Entry* find(const Diagnostic& diagnostic) const;  // null if not accepted

  std::vector<Entry> entries_;
};

}  // namespace quintet::check
#endif

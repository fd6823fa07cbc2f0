// SPDX-License-Identifier: Apache-2.0
// Suppressions: comments that accept a diagnostic of their line, or of the next line if nothing else is in their line.
// In GLSL "// quintet: allow Q604 reason", in program.toml "# quintet: allow Q604 reason". Errors cannot be suppressed.
#ifndef QUINTET_CHECK_SUPPRESSION_H
#define QUINTET_CHECK_SUPPRESSION_H

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "program/description/program.h"

namespace quintet::check {

struct Suppression {
  SourceLocation location;  // of the comment
  int line = 0;             // whose diagnostics it accepts
  std::vector<std::string> ids;
  std::string reason;   // can be empty
  std::string problem;  // why the comment is invalid; empty if it is valid
};

// Returns the suppressions of a text, in order. In a file .toml, comments start with '#', in others with "//" or "/*".
std::vector<Suppression> findSuppressions(const std::string& file, std::string_view text);

struct SuppressedDiagnostic {
  Diagnostic diagnostic;
  SourceLocation comment;  // or the line of the list
  std::string reason;
  bool inSource = true;  // false if a list accepts it (modules/suppression_list.h)
};

class Suppressions {
 public:
  explicit Suppressions(const program::Program& program);
  explicit Suppressions(const std::map<std::string, std::string>& texts);  // by file, as diagnostics name it

  // Moves the accepted diagnostics from the list to the result.
  std::vector<SuppressedDiagnostic> apply(std::vector<Diagnostic>& diagnostics);

  // Q803 for each id that apply() has not met, except those that only a run or a device can give and, without a scene,
  // those that depend on it. Q804 for each invalid comment.
  std::vector<Diagnostic> problems(bool hasScene) const;

 private:
  struct Known {
    Suppression suppression;
    std::vector<bool> used;  // by id
  };
  std::vector<Known>& inFile(const std::string& file);  // reads a file from disk if the program does not have it
  void add(const std::string& file, std::string_view text);

  std::map<std::string, std::vector<Known>> files_;  // by path as diagnostics name it
};

}  // namespace quintet::check
#endif

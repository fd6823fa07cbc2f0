// SPDX-License-Identifier: Apache-2.0
// Diagnostics: what the GLSL compiler or the check of the linked pipeline reports about a program.
#ifndef QUINTET_DIAGNOSTIC_H
#define QUINTET_DIAGNOSTIC_H

#include <string>
#include <vector>

#include <quintet/error.h>

namespace quintet {

// A program with an error does not run.
enum class Severity { note, warning, error };

// A second location of a problem, such as the shader that receives a payload.
struct RelatedLocation {
  std::string file{};  // as in Diagnostic
  int line = 0;        // 1-based; 0: unknown
  int column = 0;      // 1-based, in bytes; 0: unknown
  std::string text{};  // what the location contains, without a period
};

// One problem of a program, with its location.
struct Diagnostic {
  Severity severity = Severity::error;
  std::string file{};  // as the user knows it: a path, or "<quintet/bsdf/ggx.glsl>" for the embedded library
  int line = 0;        // 1-based; 0: unknown
  int column = 0;      // 1-based, in bytes; 0: unknown
  std::string id{};    // "GLSL" for the compiler's own, "Q101", … for the check's (docs/diagnostics)
  std::string text{};  // one sentence without a period
  std::vector<RelatedLocation> related{};
  // "file:line:column: error: text [id]"; unknown parts are left out.
  std::string format() const;
};

// A program that does not compile or does not pass the check. what() is the first error's line.
class ProgramError : public Error {
 public:
  explicit ProgramError(std::vector<Diagnostic> diagnostics);
  // Errors and warnings, in the order of the check.
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace quintet
#endif

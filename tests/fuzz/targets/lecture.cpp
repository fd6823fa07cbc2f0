// SPDX-License-Identifier: Apache-2.0
// Lecture-form files. Their errors are diagnostics, not exceptions.
#include "program/lecture/lecture.h"
#include "target.h"

namespace quintet::fuzz {

void readInput(Input input) {
  const program::Program program = program::parseLecture(std::string(textOf(input)), "input.rt.glsl", "folder",
                                                         {{"part.glsl", "struct A { int b; };"}});
  for (const Diagnostic& diagnostic : program.diagnostics)
    if (diagnostic.id.empty()) reportFinding("a diagnostic has no id");
  if (program.diagnostics.empty() && program.rayGeneration.empty())
    reportFinding("a program without an error has no ray generation shader");
}

}  // namespace quintet::fuzz

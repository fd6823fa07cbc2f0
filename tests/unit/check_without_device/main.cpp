// SPDX-License-Identifier: Apache-2.0
// Checks a built-in program on a scene. The executable links quintet_check alone, so it builds only as long as the
// check needs neither gpu, rt nor render. Exits with 0 if nothing is reported.
#include <cstdio>

#include "check/check.h"
#include "check/diagnostic_text.h"
#include "check/scene_facts.h"
#include "program/load.h"
#include "scene/load.h"

int main(int argc, char** argv) {
  using namespace quintet;
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s PROGRAM SCENE\n", argv[0]);
    return 2;
  }
  try {
    const program::Program program = program::loadProgram(argv[1]);
    const program::SceneFacts facts = check::sceneFacts(scene::loadScene(argv[2]));
    const check::CheckResult result = check::check(program, shader::Compiler({}), &facts, {});
    std::fputs(check::diagnosticsText(result.diagnostics, check::sourcesOf(program)).c_str(), stderr);
    return result.diagnostics.empty() ? 0 : 1;
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}

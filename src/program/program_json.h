// A program's description for machines: `--help --json`, the viewer's sliders, the lab.
#ifndef QUINTET_PROGRAM_PROGRAM_JSON_H
#define QUINTET_PROGRAM_PROGRAM_JSON_H

#include <string>

#include "program/program.h"

namespace quintet::program {

// One object, one line (docs/programs.md, "The description as JSON").
std::string describeAsJson(const Program& program);

}  // namespace quintet::program
#endif

// SPDX-License-Identifier: Apache-2.0
// What a program offers to its user: parameters, outputs and ray types, as help text and as JSON; and the list of
// built-in programs.
#ifndef QUINTET_PROGRAM_HELP_H
#define QUINTET_PROGRAM_HELP_H

#include <string>

#include "program/description/program.h"

namespace quintet::program {

// Parameters with type, default, range, unit and help, and outputs: `quintet run PROGRAM --help`.
// Lines have at most `width` columns.
std::string describeAsText(const Program& program, std::size_t width = std::string::npos);

// One object in one line without a line break (docs/programs.md, "The description as JSON").
std::string describeAsJson(const Program& program);

// The built-in programs with the first sentence of their descriptions, one line each.
std::string listAsText(std::size_t width = std::string::npos);

// The built-in programs as an array of {"name", "description"}, in one line without a line break.
std::string listAsJson();

}  // namespace quintet::program
#endif

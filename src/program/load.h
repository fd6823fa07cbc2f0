// SPDX-License-Identifier: Apache-2.0
// Finds and reads programs: a folder with program.toml, a file of the lecture form, or a built-in program.
#ifndef QUINTET_PROGRAM_LOAD_H
#define QUINTET_PROGRAM_LOAD_H

#include <string>
#include <vector>

#include "program/description/program.h"

namespace quintet::program {

// Returns the program of this name, which is one of
//   - a folder with program.toml (or that file itself), or whose only program is a file NAME.rt.glsl;
//   - a file NAME.rt.glsl, with or without its extension;
//   - a built-in program ("lessons/05_shadow"; "05_shadow" and "shadow" also work if no other program has this name);
//   - "<programs/lessons/05_shadow>": the built-in program, also if a folder or a file has its name.
// Throws FileError with a line for an invalid description, and UsageError with the nearest name for an unknown program.
// Errors in a lecture-form file are in Program::diagnostics instead.
Program loadProgram(const std::string& nameOrPath);

// Returns whether loadProgram() found the program in the binary, not in a folder.
bool isBuiltIn(const Program& program);

// Names of all built-in programs, sorted.
std::vector<std::string> builtInPrograms();

}  // namespace quintet::program
#endif

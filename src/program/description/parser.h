// SPDX-License-Identifier: Apache-2.0
// Reads program.toml.
#ifndef QUINTET_PROGRAM_DESCRIPTION_PARSER_H
#define QUINTET_PROGRAM_DESCRIPTION_PARSER_H

#include <map>
#include <string>

#include "program/description/program.h"

namespace quintet::program {

// Returns the program that the text of a program.toml describes. `files` are the files of its folder, `origin` the folder.
// Throws FileError with a line.
Program parseProgram(const std::string& toml, const std::string& name, const std::string& origin,
                     std::map<std::string, std::string> files);

}  // namespace quintet::program
#endif

// program.toml's tables to a Program, in the order in which they need one another.
#ifndef QUINTET_PROGRAM_PROGRAM_PARSER_H
#define QUINTET_PROGRAM_PROGRAM_PARSER_H

#include "program/program.h"
#include "program/toml_reader.h"

namespace quintet::program {

// Fills a program that has its name, origin and files. `file`: as errors show it. Throws FileError.
void parseTables(Program& program, const toml::table& root, const std::string& file);

}  // namespace quintet::program
#endif

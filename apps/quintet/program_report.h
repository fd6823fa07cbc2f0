// What `run PROGRAM --help`, `render --help-program` and `run --list` say about programs, for people and as JSON.
#ifndef QUINTET_APP_PROGRAM_REPORT_H
#define QUINTET_APP_PROGRAM_REPORT_H

#include <string>

#include "program/program.h"

namespace quintet::app {

// Its parameters with type, default, range, unit and help, and its outputs.
std::string programHelp(const program::Program& program);
std::string programJson(const program::Program& program);  // one object, one line

// The built-in programs, one line each; `json`: an array.
std::string programList(bool json);

}  // namespace quintet::app
#endif

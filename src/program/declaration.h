// The parts of program.toml that declare or give values: [[parameter]], the fields of [[record]], and
// `record = { … }` of a shader.
#ifndef QUINTET_PROGRAM_DECLARATION_H
#define QUINTET_PROGRAM_DECLARATION_H

#include "program/program.h"
#include "program/toml_reader.h"

namespace quintet::program {

// Adds what one [[parameter]] table declares.
void parseParameter(Program& program, const toml::table& table, const std::string& file);

// Adds the field that one [[record]] table declares.
void parseRecordField(Program& program, const toml::table& table, const std::string& file);

// The value of `record` in the reader's table over `base` (empty: the fields' defaults).
RecordValues parseRecordValues(const Program& program, TomlReader& reader, const RecordValues& base,
                               const std::string& file);

// The table's `name`, an identifier that is not in `taken`.
std::string parseName(TomlReader& reader, const std::vector<std::string>& taken);

}  // namespace quintet::program
#endif

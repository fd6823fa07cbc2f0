// SPDX-License-Identifier: Apache-2.0
// The texts of the files that diagnostics name.
#ifndef QUINTET_CHECK_SOURCES_H
#define QUINTET_CHECK_SOURCES_H

#include <functional>
#include <optional>
#include <string>

#include "program/description/program.h"

namespace quintet::check {

// Files of the shader library have names in brackets: "<quintet/hit.glsl>". Other names are returned as they are.
std::string withoutBrackets(const std::string& file);

// Returns the text of a file by its name in diagnostics; nullopt if unknown.
using SourceLookup = std::function<std::optional<std::string>(const std::string& file)>;

// Searches the files of the program, the shader library and the disk. `program` must outlive the result.
SourceLookup sourcesOf(const program::Program& program);
// Searches the shader library and the disk.
SourceLookup sourcesOnDisk();

}  // namespace quintet::check
#endif

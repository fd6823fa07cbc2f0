// SPDX-License-Identifier: Apache-2.0
// The GLSL that Quintet generates for a program: constants and `parameters` (<quintet/generated/program.glsl>), and the
// shader record (<quintet/generated/record.glsl>); and the names that a program can give to things that become GLSL names.
#ifndef QUINTET_PROGRAM_DESCRIPTION_GENERATED_GLSL_H
#define QUINTET_PROGRAM_DESCRIPTION_GENERATED_GLSL_H

#include <map>
#include <string>

#include "program/description/program.h"

namespace quintet::program {

// Ray types, strides, indices of miss and callable shaders, output slots, counts, and `parameters`.
std::string generatedConstants(const Program& program);

// `record`, with the fields of Program::record.
std::string generatedRecord(const Program& program);

// Both texts by include name, for shader::Source::virtualFiles.
std::map<std::string, std::string> generatedFiles(const Program& program);

// Returns whether kRay_NAME is a valid GLSL name: at most 128 letters, digits and '_', no leading digit, no "gl_" prefix,
// no "__" (GLSL 4.60, 3.7).
bool isIdentifier(const std::string& name);

// Returns whether a struct member cannot have this name: a GLSL keyword or a macro of the shader library.
bool isReservedWord(const std::string& name);

}  // namespace quintet::program
#endif

// The GLSL that Quintet writes for a program: constants and `parameters`
// (<quintet/generated/program.glsl>), and the shader record (<quintet/generated/record.glsl>).
#ifndef QUINTET_PROGRAM_GENERATED_H
#define QUINTET_PROGRAM_GENERATED_H

#include <map>
#include <string>

#include "program/program.h"

namespace quintet::program {

// Ray types, strides, indices of miss and callable shaders, output slots, counts, and `parameters`.
std::string generatedConstants(const Program& program);

// `record`, with the fields of Program::record.
std::string generatedRecord(const Program& program);

// Both, by include name: shader::Source::virtualFiles.
std::map<std::string, std::string> generatedFiles(const Program& program);

}  // namespace quintet::program
#endif

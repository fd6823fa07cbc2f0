// SPDX-License-Identifier: Apache-2.0
// The inputs of a lecture-form file: its uniforms, and those that are predeclared.
#ifndef QUINTET_PROGRAM_LECTURE_UNIFORMS_H
#define QUINTET_PROGRAM_LECTURE_UNIFORMS_H

#include <optional>
#include <string_view>
#include <vector>

#include "program/description/parameter.h"
#include "program/lecture/text.h"

namespace quintet::program {

struct LectureUniform {
  Parameter parameter;
  std::size_t begin = 0;  // of the declaration
  std::size_t end = 0;    // after its ';'
};

// Returns the declarations "uniform TYPE NAME = VALUE; // defaultval="…" min="…" …" outside functions. They include
// declarations of predeclared names (frameID, …), so that the front end can remove them.
std::vector<LectureUniform> findUniforms(const LectureText& source, LectureErrors& errors);

// Returns whether the name is predeclared as a variable (frameID, frameSize); a uniform can repeat the declaration.
bool isPredeclared(std::string_view name);

// Returns the uniform of a name that is predeclared if used: userParam0 … 2 (float) or texture0 … 4 (image); else empty.
std::optional<LectureUniform> implicitUniform(std::string_view name);

}  // namespace quintet::program
#endif

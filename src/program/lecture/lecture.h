// SPDX-License-Identifier: Apache-2.0
// The front end of the lecture form: one file, NAME.rt.glsl, with several main() functions that markers assign to stages,
// as in the ray tracing node of the GSN Composer (docs/lecture-form.md). The result is a Program like any other.
#ifndef QUINTET_PROGRAM_LECTURE_LECTURE_H
#define QUINTET_PROGRAM_LECTURE_LECTURE_H

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "program/description/program.h"
#include "shader/compiler.h"

namespace quintet::program {

inline constexpr std::string_view kLectureExtension = ".rt.glsl";
// Suffix of the empty miss shader that a file without a miss shader gets.
inline constexpr std::string_view kStubMissExtension = ".none.rmiss";
inline constexpr std::size_t kMaxLectureBytes = std::size_t{1} << 20;  // of the file, and of each included file

// Returns the program of a lecture-form file. Errors in the text are in Program::diagnostics. `file` is the name of the
// text ("shadow.rt.glsl"), `origin` its folder, `siblings` the included files, scenes and images by name.
Program parseLecture(const std::string& text, const std::string& file, const std::string& origin,
                     std::map<std::string, std::string> siblings = {});

// Turns the compiler's "undeclared identifier" for `hit` and `baryCoord` in a stage without a hit into Q204.
void explainLectureNames(std::vector<Diagnostic>& diagnostics, shader::Stage stage);

}  // namespace quintet::program
#endif

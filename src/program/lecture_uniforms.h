// The inputs of a lecture-form file: its uniforms, and those that are there without a declaration.
#ifndef QUINTET_PROGRAM_LECTURE_UNIFORMS_H
#define QUINTET_PROGRAM_LECTURE_UNIFORMS_H

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "program/lecture_split.h"
#include "program/parameter.h"

namespace quintet::program {

struct LectureUniform {
  Parameter parameter;
  std::size_t begin = 0;  // of the declaration, the ';' included
  std::size_t end = 0;
};

// Declarations "uniform TYPE NAME = VALUE; // defaultval="…" min="…" …" outside functions. Names that the library
// gives (frameID, …) are found, too, so that their declarations can be taken away.
std::vector<LectureUniform> findUniforms(std::string_view text, const std::vector<Token>& tokens,
                                         LectureErrors& errors);

// Names that the form gives and that a uniform may declare once more.
bool isLectureName(std::string_view name);

// userParam0 … 2 (float) and texture0 … 4 (image); nothing for other names.
std::optional<LectureUniform> implicitUniform(std::string_view name);

}  // namespace quintet::program
#endif

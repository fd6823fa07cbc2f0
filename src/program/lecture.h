// The lecture form of a program: one file, name.rt.glsl, with several main() that markers give to their stages, as in
// the GSN Composer's ray tracing node (docs/lecture-form.md). It becomes a Program like any other.
#ifndef QUINTET_PROGRAM_LECTURE_H
#define QUINTET_PROGRAM_LECTURE_H

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "program/program.h"

namespace quintet::program {

inline constexpr std::string_view kLectureExtension = ".rt.glsl";
// Appended to the file's name: the empty miss shader of a file that has none.
inline constexpr std::string_view kStubMissExtension = ".none.rmiss";
inline constexpr std::size_t kMaxLectureBytes = std::size_t{1} << 20;  // of the file, and of each that it includes

// Never throws for what the text says: errors are in Program::diagnostics. `file` is the name of the text
// ("shadow.rt.glsl"), `origin` its folder; `included`: texts of files that it includes, by their name there.
Program parseLecture(const std::string& text, const std::string& file, const std::string& origin,
                     std::map<std::string, std::string> included = {});

// A file NAME.rt.glsl (the extension may be left out), a folder whose only program is such a file, or a built-in
// program of that form by its name; nothing if it is none of these. Throws FileError for files that cannot be read.
std::optional<Program> findLecture(const std::string& nameOrPath);

// Says of `hit` and `baryCoord` that the stage has no hit (Q204), where the compiler says that they are undeclared.
void explainLectureNames(std::vector<shader::Diagnostic>& diagnostics, shader::Stage stage);

// Names of the built-in programs of this form: the path below programs/ without .rt.glsl.
std::vector<std::string> builtInLectures();

}  // namespace quintet::program
#endif

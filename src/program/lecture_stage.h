// The GLSL of one stage of a lecture-form file: the file itself with everything blanked that belongs to other
// stages, so that lines stay where they are, below the declarations that the form promises.
#ifndef QUINTET_PROGRAM_LECTURE_STAGE_H
#define QUINTET_PROGRAM_LECTURE_STAGE_H

#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "program/lecture_functions.h"
#include "program/lecture_split.h"
#include "program/lecture_uniforms.h"

namespace quintet::program {

// A text with its tokens.
struct LectureText {
  std::string_view text;
  std::vector<Token> tokens;

  // Those that are neither in comments nor dead.
  std::set<std::string_view> words() const;
  // Outside functions, or as a macro.
  bool declares(std::string_view name) const;
};

// What all stages of a file share.
struct LectureSource : LectureText {
  std::string file;  // as diagnostics name it
  LectureSplit split;
  std::vector<std::vector<TextRange>> unused;  // by main: common functions that it does not need
  std::vector<LectureUniform> uniforms;
  std::vector<LectureUniform> implicit;  // userParam0 and its like, as far as they are used
  // Include lines of the file behind which a type of the user's is known: (token, "RayPayloadType").
  std::vector<std::pair<std::size_t, std::string>> includedTypes;
  bool givesPi = false;       // PI is used and not declared
  bool opensLibrary = false;  // the program includes <quintet/…> itself
  bool hasAnyHit = false;
  bool hasIntersection = false;
};

// `boxes`: the variant of a hit shader for procedural primitives, else for triangles.
std::string lectureStage(const LectureSource& source, std::size_t main, bool boxes);

}  // namespace quintet::program
#endif

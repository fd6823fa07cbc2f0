// SPDX-License-Identifier: Apache-2.0
// The GLSL of one stage of a lecture-form file: the file with the text of other stages blanked, so that line numbers stay,
// after the declarations that the form provides.
#ifndef QUINTET_PROGRAM_LECTURE_STAGE_H
#define QUINTET_PROGRAM_LECTURE_STAGE_H

#include <string>
#include <utility>
#include <vector>

#include "program/lecture/split.h"
#include "program/lecture/text.h"
#include "program/lecture/uniforms.h"

namespace quintet::program {

// A lecture-form file as all of its stages share it.
struct LectureSource : LectureText {
  using LectureText::LectureText;

  std::string file;  // name in diagnostics
  LectureSplit split;
  std::vector<LectureUniform> uniforms;
  std::vector<LectureUniform> implicit;  // predeclared inputs that the program uses: userParam0, …
  // Include lines after which a type of the user is known: (token, "RayPayloadType").
  std::vector<std::pair<std::size_t, std::string>> includedTypes;
  bool declaresPi = false;       // PI is used but not declared by the program
  bool includesLibrary = false;  // the program includes <quintet/…> itself
  bool hasAnyHit = false;
  bool hasIntersection = false;
};

// Returns the source of the stage of main number `main`. `boxes` selects the variant of a hit shader for procedural
// primitives rather than for triangles.
std::string lectureStage(const LectureSource& source, std::size_t main, bool boxes);

}  // namespace quintet::program
#endif

// SPDX-License-Identifier: Apache-2.0
// Splits a lecture-form file into its stages: which bytes are common, which belong to which main(), and which common
// functions each stage needs.
#ifndef QUINTET_PROGRAM_LECTURE_SPLIT_H
#define QUINTET_PROGRAM_LECTURE_SPLIT_H

#include <utility>
#include <vector>

#include "program/lecture/text.h"
#include "shader/compiler.h"

namespace quintet::program {

struct LectureMain {
  shader::Stage stage = shader::Stage::rayGeneration;
  std::size_t begin = 0;  // offset of "void"
  std::size_t body = 0;   // offset after the '{'
  std::size_t end = 0;    // offset after the '}'
};

inline constexpr int kCommonText = -1;

// A part of the file with one owner. Regions cover the file without gaps, in order.
struct LectureRegion {
  std::size_t begin = 0;
  std::size_t end = 0;
  int owner = kCommonText;  // index of a main, or kCommonText
};

using TextRange = std::pair<std::size_t, std::size_t>;  // begin, end

struct LectureSplit {
  std::vector<LectureMain> mains;
  std::vector<LectureRegion> regions;
  // By main: definitions of common functions that neither it nor anything it uses names, such as a function that traces
  // rays for the intersection shader. A function that no stage uses stays in one stage in which all its names exist, so
  // that the compiler checks it.
  std::vector<std::vector<TextRange>> unusedFunctions;

  int ownerOf(std::size_t offset) const;
};

// Common text is all text before the first main() and between COMMON START and COMMON END. Other text belongs to the main()
// that follows it, or to the last one. Errors Q010 to Q014 go to `errors`.
LectureSplit splitLecture(const LectureText& source, LectureErrors& errors);

}  // namespace quintet::program
#endif

// Finds the stages of a lecture-form file: which bytes are common, which belong to which main().
#ifndef QUINTET_PROGRAM_LECTURE_SPLIT_H
#define QUINTET_PROGRAM_LECTURE_SPLIT_H

#include <string>
#include <string_view>
#include <vector>

#include "program/lecture_tokens.h"
#include "shader/compiler.h"

namespace quintet::program {

// Collects what is wrong with one file.
class LectureErrors {
 public:
  LectureErrors(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}
  void add(std::string id, std::size_t offset, std::string problem,
           shader::Severity severity = shader::Severity::error);
  const std::vector<shader::Diagnostic>& all() const { return all_; }

 private:
  std::string_view text_;
  std::string file_;
  std::vector<shader::Diagnostic> all_;
};

struct LectureMain {
  shader::Stage stage = shader::Stage::rayGeneration;
  std::size_t begin = 0;  // of "void"
  std::size_t body = 0;   // behind the '{'
  std::size_t end = 0;    // behind the '}'
};

inline constexpr int kCommonText = -1;

// A part of the file with one owner; regions cover the file without gaps, in order.
struct LectureRegion {
  std::size_t begin = 0;
  std::size_t end = 0;
  int owner = kCommonText;  // index of a main, or kCommonText
};

struct LectureSplit {
  std::vector<LectureMain> mains;
  std::vector<LectureRegion> regions;
  int ownerOf(std::size_t offset) const;
};

// Common is what precedes the first main() and what stands between COMMON START and COMMON END; other text
// belongs to the main() that follows it, after the last one to that. What is wrong goes to `errors`.
LectureSplit splitLecture(std::string_view text, const std::vector<Token>& tokens, LectureErrors& errors);

}  // namespace quintet::program
#endif

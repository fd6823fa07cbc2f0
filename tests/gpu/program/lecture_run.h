// SPDX-License-Identifier: Apache-2.0
// Runs a program of the lecture form on a small scene and returns what gsnSetPixel wrote.
#ifndef QUINTET_TESTS_GPU_PROGRAM_LECTURE_RUN_H
#define QUINTET_TESTS_GPU_PROGRAM_LECTURE_RUN_H

#include <string>
#include <vector>

#include "../render/rendered_image.h"
#include "program/lecture/lecture.h"

namespace quintet::test {

struct LectureOptions {
  std::uint32_t width = 4;
  std::uint32_t height = 1;
  std::uint32_t frames = 1;
  std::vector<std::string> set;  // parameters
  render::Region region;
  double launchSeconds = 0.25;
};

// Raw values, rows from top to bottom.
struct LectureImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<vec4> pixels;
  // `row` counts from the bottom, like gl_LaunchIDEXT.y.
  const vec4& at(std::uint32_t x, std::uint32_t row = 0) const {
    return pixels[std::size_t{height - 1 - row} * width + x];
  }
};

LectureImage runLecture(const program::Program& program, const scene::Scene& scene, const LectureOptions& options = {});
// `included` are files of its folder.
LectureImage runLecture(const std::string& text, const scene::Scene& scene, const LectureOptions& options = {},
                        const std::map<std::string, std::string>& included = {});

// Adds an instance with these boxes as custom primitives.
void addBoxes(scene::Scene& scene, const std::vector<Bounds3>& boxes, const mat4& worldFromObject = mat4(1.0f));

// Returns the messages of the program's compilation.
std::string lectureProblems(const program::Program& program);

}  // namespace quintet::test
#endif

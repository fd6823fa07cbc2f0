// A program given as texts, run once per pixel over a small scene; what its outputs hold afterwards.
#ifndef QUINTET_TESTS_GPU_PROGRAM_RUN_PROGRAM_H
#define QUINTET_TESTS_GPU_PROGRAM_RUN_PROGRAM_H

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "../render/picture.h"

namespace quintet::test {

using Files = std::map<std::string, std::string>;

// One value per pixel of one row, for each output by its position.
using Outputs = std::vector<std::vector<vec4>>;

// `set`: parameters, "name=value". The shaders in `files` lack "#version …", which is put in front of them.
Outputs runProgram(const std::string& toml, const Files& files, const SceneBuilder& scene, std::uint32_t pixels,
                   const std::vector<std::string>& set = {});

// Unit squares in z = 0 facing +z, square i from x = 2i to 2i + 1, with material and mesh of these names.
SceneBuilder namedSquares(const std::vector<std::string>& names);

}  // namespace quintet::test
#endif

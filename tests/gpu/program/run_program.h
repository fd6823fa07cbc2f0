// SPDX-License-Identifier: Apache-2.0
// Runs a program given as texts once per pixel on a small scene and returns its outputs.
#ifndef QUINTET_TESTS_GPU_PROGRAM_RUN_PROGRAM_H
#define QUINTET_TESTS_GPU_PROGRAM_RUN_PROGRAM_H

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "../render/rendered_image.h"

namespace quintet::test {

using Files = std::map<std::string, std::string>;

// One value per pixel of one row, for each output in order.
using Outputs = std::vector<std::vector<vec4>>;

// `set` holds parameters as "name=value". The shaders in `files` have no "#version …" line; the function prepends it.
Outputs runProgram(const std::string& toml, const Files& files, const SceneBuilder& scene, std::uint32_t pixels,
                   const std::vector<std::string>& set = {});

// Returns unit squares in z = 0 facing +z: square i from x = 2i to 2i + 1, with these names for material and mesh.
SceneBuilder namedSquares(const std::vector<std::string>& names);

}  // namespace quintet::test
#endif

// SPDX-License-Identifier: Apache-2.0
// The scenes in which the path tracer must agree with brute force: one entry each in the table of scenes.cpp.
#ifndef QUINTET_TESTS_IMAGE_SCENES_H
#define QUINTET_TESTS_IMAGE_SCENES_H

#include <cstdint>
#include <ostream>
#include <span>

#include "scene_builder.h"

namespace quintet::test {

struct ImageScene {
  const char* name;
  SceneBuilder (*make)();  // with one camera
  std::uint32_t width, height;
  std::uint32_t block;                            // pixels per side; divides width and height
  std::uint32_t pathtracerSamples, naiveSamples;  // multiples of 128
  // Light sampling matters. The scene is also rendered with a planned number of samples, and with wrong MIS weights, which
  // the test must detect.
  bool lightSamples;
};

inline void PrintTo(const ImageScene& s, std::ostream* out) { *out << s.name; }

std::span<const ImageScene> imageScenes();

}  // namespace quintet::test
#endif

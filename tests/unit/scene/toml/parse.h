// SPDX-License-Identifier: Apache-2.0
// Helpers of the tests of scene files.
#ifndef QUINTET_TESTS_SCENE_TOML_PARSE_H
#define QUINTET_TESTS_SCENE_TOML_PARSE_H

#include <gtest/gtest.h>

#include <string>

#include "base/error.h"
#include "scene/model/validate.h"
#include "scene/toml/scene_toml.h"

namespace quintet::test {

inline scene::Scene parse(const std::string& text) {
  scene::Scene s = scene::parseSceneToml(text, "test.scene.toml");
  scene::validate(s);
  return s;
}

inline std::string errorOfToml(const std::string& text) {
  try {
    parse(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

inline void expectNear(const vec3& a, const vec3& b, float tolerance = 1e-6f) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}
inline vec3 apply(const mat4& m, const vec3& p) { return vec3(m * vec4(p, 1.0f)); }

}  // namespace quintet::test
#endif

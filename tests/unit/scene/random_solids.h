// SPDX-License-Identifier: Apache-2.0
// Random transforms, solids and trees for tests, determined by the state of the generator.
#ifndef QUINTET_TESTS_RANDOM_SOLIDS_H
#define QUINTET_TESTS_RANDOM_SOLIDS_H

#include <random>

#include "scene/model/procedural.h"

namespace quintet::test {

// Random rotation, scale per axis (0.3 … 1.3, sometimes mirrored) and translation (up to 1 per axis).
inline mat4 randomTransform(std::mt19937& random) {
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  const auto signedUnit = [&] { return 2.0f * unit(random) - 1.0f; };
  const float x = signedUnit(), y = signedUnit(), z = signedUnit();
  mat4 m = glm::translate(mat4(1.0f), vec3(x, y, z));
  const float w = signedUnit(), a = signedUnit(), b = signedUnit(), c = signedUnit();
  m *= glm::mat4_cast(glm::normalize(quat(w + 1.5f, a, b, c)));
  const float sx = 0.3f + unit(random), sy = 0.3f + unit(random), sz = 0.3f + unit(random);
  return glm::scale(m, vec3(unit(random) < 0.2f ? -sx : sx, sy, sz));
}

inline scene::Primitive randomPrimitive(std::mt19937& random, scene::PrimitiveType type) {
  scene::Primitive primitive;
  primitive.type = type;
  primitive.objectFromPrimitive = randomTransform(random);
  primitive.parameter = std::uniform_real_distribution<float>(0.1f, 0.8f)(random);
  return primitive;
}

// One tree of random shape with `leafCount` random solids.
inline scene::PrimitiveSet randomTree(std::mt19937& random, int leafCount) {
  scene::PrimitiveSet set;
  set.kind = scene::PrimitiveSetKind::csg;
  std::uniform_int_distribution<int> types(0, 4), operations(1, 3), coin(0, 1);
  int depth = 0;
  for (int leaves = 0; leaves < leafCount || depth > 1;) {
    if (leaves < leafCount && (depth < 2 || coin(random) == 1)) {
      set.nodes.push_back({scene::CsgOperation::leaf, static_cast<std::uint32_t>(set.primitives.size())});
      set.primitives.push_back(randomPrimitive(random, static_cast<scene::PrimitiveType>(types(random))));
      ++leaves, ++depth;
    } else {
      set.nodes.push_back({static_cast<scene::CsgOperation>(operations(random)), 0});
      --depth;
    }
  }
  set.trees = {{0, static_cast<std::uint32_t>(set.nodes.size())}};
  return set;
}

}  // namespace quintet::test
#endif

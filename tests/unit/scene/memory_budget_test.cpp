// SPDX-License-Identifier: Apache-2.0
// The limit on the memory that a scene file requests.
#include "scene/memory_budget.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "scene/error_matcher.h"
#include "scene/gltf_builder.h"

namespace quintet::test {
namespace {

TEST(MemoryBudget, ThrowsAboveItsLimit) {
  scene::MemoryBudget budget("scene.glb", std::size_t{3} << 30);
  budget.take(std::size_t{2} << 30);
  budget.take(std::size_t{1} << 30);
  try {
    budget.take(1);
    FAIL();
  } catch (const MemoryError& error) {
    EXPECT_THAT(error.what(), IsErrorAt("scene.glb", "3.0 GiB"));
  }
  EXPECT_THROW(scene::MemoryBudget("x", 10).take(~std::size_t{0}), MemoryError);
}

// A line of JSON that requests more memory than any machine has. The request is counted before anything is read.
TEST(MemoryBudget, RejectsExcessiveAccessors) {
  GltfBuilder builder;
  builder.addTriangle();
  const Json primitive = {
      {"attributes", {{"POSITION", 0}}},
      {"indices",
       builder.add("accessors", {{"componentType", kUnsignedInt}, {"count", 4294967295u}, {"type", "SCALAR"}})}};
  builder.root["meshes"][0]["primitives"] = Json::array_t(1000, primitive);
  EXPECT_THROW(builder.load(), Error);
}

TEST(MemoryBudget, LimitsTheNumberOfInstances) {
  GltfBuilder builder;
  builder.addTriangle();
  const int zeros = builder.add("accessors", {{"componentType", kFloat}, {"count", 1 << 24}, {"type", "VEC3"}});
  builder.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = zeros;
  EXPECT_THAT(errorOf(builder),
              IsErrorAt("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes", "16777215 instances"));
}

TEST(MemoryBudget, ReportsFailedAllocations) {
  EXPECT_EQ(scene::withMemoryErrors("scene.glb", [] { return 3; }), 3);
  EXPECT_THROW(scene::withMemoryErrors("scene.glb", []() -> int { throw std::bad_alloc(); }), MemoryError);
  EXPECT_THROW(scene::withMemoryErrors("scene.glb", []() -> int { throw std::length_error(""); }), MemoryError);
}

}  // namespace
}  // namespace quintet::test

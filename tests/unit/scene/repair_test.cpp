// Small helpers that make a file's content safe: numbers, text, sizes.
#include "scene/repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "scene/gltf_builder.h"
#include "scene/memory_budget.h"
#include "scene/printable.h"

namespace quintet::test {
namespace {

using testing::ElementsAre;

TEST(Repair, UnusedVerticesAreDroppedWhenTheyAreMany) {
  scene::Geometry g;
  for (int i = 0; i < 10; ++i) g.positions.emplace_back(i, 0, 0);
  g.colors.assign(10, vec4(1));
  g.colors[7] = vec4(0.5f);
  g.triangles = {{9, 7, 2}, {2, 7, 4}};
  scene::dropUnusedVertices(g);
  EXPECT_THAT(g.positions, ElementsAre(vec3(2, 0, 0), vec3(4, 0, 0), vec3(7, 0, 0), vec3(9, 0, 0)));
  EXPECT_THAT(g.triangles, ElementsAre(uvec3(3, 2, 0), uvec3(0, 2, 1)));
  EXPECT_EQ(g.colors[2], vec4(0.5f));
  EXPECT_TRUE(g.normals.empty());

  g.positions.emplace_back(100, 0, 0);  // one in five: not worth the copy
  g.colors.emplace_back(1);
  scene::dropUnusedVertices(g);
  EXPECT_EQ(g.positions.size(), 5u);
}

TEST(Repair, NonFiniteVerticesMoveOntoAFiniteOne) {
  scene::Geometry g;
  g.positions = {{NAN, 0, 0}, {1, 2, 3}, {0, INFINITY, 0}};
  g.triangles = {{1, 1, 1}, {0, 1, 2}};
  EXPECT_EQ(scene::dropNonFiniteTriangles(g), 1u);
  EXPECT_THAT(g.positions, testing::Each(vec3(1, 2, 3)));  // boxes over all positions stay tight
  EXPECT_THAT(g.fileTriangles, ElementsAre(0u));
}

TEST(Repair, PrimitivesThatShareTheirVerticesKeepOnlyTheirOwn) {
  GltfBuilder builder;
  std::vector<float> positions(3 * 100, 0.0f);
  const int p = builder.addAccessor(positions, "VEC3");
  for (std::uint8_t i = 0; i < 5; ++i)
    builder.addMesh(
        {{"attributes", {{"POSITION", p}}}, {"indices", builder.addAccessor<std::uint8_t>({i, 50, 99}, "SCALAR")}});
  for (const scene::Mesh& mesh : builder.load().meshes) EXPECT_EQ(mesh.geometries[0].positions.size(), 3u);
}

TEST(Repair, AnyPerpendicularIsPerpendicular) {
  for (const vec3& n :
       {vec3(0, 0, 1), vec3(0, 0, -1), vec3(1, 0, 0), glm::normalize(vec3(1, -2, 3)), vec3(0, 1, -0.0f)}) {
    const vec3 t = scene::anyPerpendicular(n);
    EXPECT_NEAR(glm::dot(n, t), 0.0f, 1e-6f);
    EXPECT_NEAR(glm::length(t), 1.0f, 1e-6f);
  }
}

TEST(Printable, KeepsTextAndReplacesTheRest) {
  EXPECT_EQ(scene::printable("plain"), "plain");
  EXPECT_EQ(scene::printable("Köln 漢 🙂"), "Köln 漢 🙂");
  EXPECT_EQ(scene::printable("a\nb\tc\x1B[31m\x7F"), "a?b?c?[31m?");
  EXPECT_EQ(scene::printable("\xC3"), "?");            // cut off
  EXPECT_EQ(scene::printable("\xC0\xAF\xFF"), "???");  // overlong, no UTF-8 at all
  EXPECT_EQ(scene::printable("\xC2\x85"), "??");       // "next line" of the C1 set
}

TEST(Printable, ErrorsQuoteTheFileOnOneLine) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.root["buffers"] = {{{"byteLength", 36}, {"uri", "a\nb.bin"}}};
  EXPECT_EQ(errorOf(builder), "/buffers/0/uri: a?b.bin does not exist");
  builder.root["buffers"].erase(0);
  builder.root["extensionsUsed"] = {"X\n\x01"};
  EXPECT_EQ(errorOf(builder), "/bufferViews/0/buffer: buffer 0 does not exist: the file has 0");
  builder.root.erase("buffers");
  EXPECT_THAT(builder.load().report.extensionsIgnored, ElementsAre("X??"));
}

TEST(MemoryBudget, StopsAtItsLimit) {
  scene::MemoryBudget budget("scene.glb", std::size_t{3} << 30);
  budget.take(std::size_t{2} << 30);
  budget.take(std::size_t{1} << 30);
  try {
    budget.take(1);
    FAIL();
  } catch (const MemoryError& error) {
    EXPECT_STREQ(error.what(), "scene.glb: the scene needs more than 3.0 GiB of memory");
  }
  EXPECT_THROW(scene::MemoryBudget("x", 10).take(~std::size_t{0}), MemoryError);
}

// A line of JSON that claims what no machine has; the claim is counted before anything is read.
TEST(MemoryBudget, RefusesBombs) {
  GltfBuilder builder;
  builder.addTriangle();
  const Json primitive = {
      {"attributes", {{"POSITION", 0}}},
      {"indices",
       builder.add("accessors", {{"componentType", kUnsignedInt}, {"count", 4294967295u}, {"type", "SCALAR"}})}};
  builder.root["meshes"][0]["primitives"] = Json::array_t(1000, primitive);
  EXPECT_THROW(builder.load(), Error);
}

TEST(MemoryBudget, InstancesAreLimited) {
  GltfBuilder builder;
  builder.addTriangle();
  const int zeros = builder.add("accessors", {{"componentType", kFloat}, {"count", 1 << 24}, {"type", "VEC3"}});
  builder.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = zeros;
  EXPECT_EQ(errorOf(builder), "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes: more than 16777215 instances");
}

}  // namespace
}  // namespace quintet::test

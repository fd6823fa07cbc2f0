// SPDX-License-Identifier: Apache-2.0
// Parallel steps of loading give the same results as on one core and as serial loops.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "base/error.h"
#include "base/file.h"
#include "base/memory_budget.h"
#include "demo/large_scene.h"
#include "scene/geometry/repair.h"
#include "scene/load.h"
#include "scene/model/content_hash.h"
#include "temp_folder.h"

namespace quintet::test {
namespace {

// Restricts the process to one core during its lifetime.
class OneCore {
 public:
  OneCore() {
    sched_getaffinity(0, sizeof all_, &all_);
    cpu_set_t one;
    CPU_ZERO(&one);
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++cpu)
      if (CPU_ISSET(cpu, &all_)) CPU_SET(cpu, &one);
    sched_setaffinity(0, sizeof one, &one);
  }
  ~OneCore() { sched_setaffinity(0, sizeof all_, &all_); }

 private:
  cpu_set_t all_{};
};

// One mesh that is large enough to be read on all cores, and small meshes that are read in parallel.
TEST(LargeScenes, LoadsTheSameSceneOnOneCore) {
  const TempFolder folder;
  demo::writeLargeScene(folder / "one.glb",
                        {.triangles = 700'000, .textures = 1, .textureSize = 8, .normalMaps = true});
  demo::writeLargeScene(folder / "many.glb", {.triangles = 100'000, .meshes = 20});
  for (const char* name : {"one.glb", "many.glb"}) {
    const scene::Scene parallel = scene::loadScene(folder / name);
    const OneCore one;
    const scene::Scene serial = scene::loadScene(folder / name);
    EXPECT_EQ(scene::contentHash(parallel), scene::contentHash(serial)) << name;
    EXPECT_EQ(scene::worldBounds(parallel).min, scene::worldBounds(serial).min);
    EXPECT_EQ(scene::worldBounds(parallel).max, scene::worldBounds(serial).max);
  }
}

TEST(LargeScenes, ReportsTheFirstInvalidIndex) {
  const TempFolder folder;
  const std::uint64_t triangles = demo::writeLargeScene(folder / "a.glb", {.triangles = 400'000});
  std::vector<std::byte> bytes = readFile(folder / "a.glb");
  std::byte* indices = bytes.data() + bytes.size() - 12 * triangles;  // the last view of the file
  for (const std::size_t element : {900'000u, 70'000u, 500'000u}) std::memset(indices + 4 * element, 0xFF, 4);
  writeFile(folder / "a.glb", bytes);
  try {
    scene::loadScene(folder / "a.glb");
    FAIL() << "no error";
  } catch (const FileError& error) {
    EXPECT_EQ(error.location(), "/meshes/0/primitives/0/indices");
    EXPECT_THAT(error.problem(), testing::HasSubstr("element 70000 is 4294967295"));
  }
}

TEST(LargeScenes, ReadsLargeFilesInParts) {
  const TempFolder folder;
  std::mt19937 random(1);
  for (const std::size_t size : {0u, 1u, (8u << 20) - 1, 8u << 20, (8u << 20) + 1, (24u << 20) + 5}) {
    std::vector<std::byte> data(size);
    for (std::size_t i = 0; i < size; i += 4093) data[i] = static_cast<std::byte>(random());
    writeFile(folder / "data", data);
    MemoryBudget budget(folder / "data");
    const FileBytes read = readLargeFile(folder / "data", budget);
    ASSERT_EQ(read.size(), size);
    EXPECT_TRUE(std::equal(read.begin(), read.end(), data.begin()));
  }
  MemoryBudget budget(folder.path());
  EXPECT_THROW(readLargeFile(folder / "none", budget), FileError);
  EXPECT_THROW(readLargeFile(folder.path(), budget), FileError);
}

// Invalid values in distant parts of the arrays.
TEST(LargeScenes, RepairsLikeASerialLoop) {
  constexpr std::size_t kCount = 300'000;
  scene::Geometry g;
  std::mt19937 random(2);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  for (std::size_t i = 0; i < kCount; ++i) {
    g.positions.emplace_back(unit(random), unit(random), unit(random));
    g.normals.emplace_back(unit(random), unit(random), unit(random));
    g.uvs[0].emplace_back(unit(random), unit(random));
    if (i % 3 == 2) g.triangles.emplace_back(i - 2, i - 1, i);
  }
  const std::vector<std::size_t> invalid{0, 65'535, 65'536, 131'073, kCount - 1};
  for (const std::size_t i : invalid) g.normals[i] = vec3(0.0f), g.uvs[0][i].y = NAN;
  const scene::Geometry before = g;
  EXPECT_EQ(scene::repairNormals(g), invalid.size());
  EXPECT_EQ(scene::repairUvsAndColors(g), invalid.size());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    const bool isInvalid = std::ranges::count(invalid, i) > 0;
    const std::size_t first = i / 3 * 3;
    const vec3 face = glm::cross(before.positions[first + 1] - before.positions[first],
                                 before.positions[first + 2] - before.positions[first]);
    const vec3 expected = glm::normalize(isInvalid ? face : before.normals[i]);
    if (!(glm::distance(g.normals[i], expected) < 1e-5f)) ++wrong;
    if (g.uvs[0][i] != (isInvalid ? vec2(0.0f) : before.uvs[0][i])) ++wrong;
  }
  EXPECT_EQ(wrong, 0u);

  g.positions[200'000].x = INFINITY;
  EXPECT_EQ(scene::dropNonFiniteTriangles(g), 1u);
  EXPECT_EQ(g.triangles.size(), kCount / 3 - 1);
  EXPECT_EQ(g.fileTriangles[200'000 / 3], 200'000 / 3 + 1);
}

}  // namespace
}  // namespace quintet::test

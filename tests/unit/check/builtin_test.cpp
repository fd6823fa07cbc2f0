// SPDX-License-Identifier: Apache-2.0
// The built-in programs have no diagnostics.
#include <algorithm>

#include "check/scene_facts.h"
#include "check_test_support.h"
#include "job/scene_source.h"
#include "program/load.h"
#include "shader/library.h"

namespace quintet::check {
namespace {

TEST(CheckBuiltIn, ReportsNothing) {
  for (const std::string& name : builtInPrograms()) {
    const CheckResult result = check(program::loadProgram(name), checkCompiler(), nullptr, {});
    EXPECT_EQ(textOf(result), "") << name;
    EXPECT_LE(result.recursionDepth, name.starts_with("lessons/") ? 6u : 1u) << name;
  }
}

TEST(CheckBuiltIn, ReportsNothingWithAScene) {
  program::SceneFacts scene = sceneWith({{program::GeometryKind::triangles, false, "mesh", "stone"},
                                         {program::GeometryKind::triangles, true, "mesh", "leaf"}});
  for (const std::string& name : builtInPrograms()) {
    const program::Program program = program::loadProgram(name);
    // Lessons with their own scenes.
    const program::SceneFacts own =
        program.scene.empty() ? scene : check::sceneFacts(job::loadScene(job::chooseSceneSource({}, program)));
    EXPECT_EQ(textOf(check(program, checkCompiler(), &own, {})), "") << name;
  }
}

// On a device with all defects of docs/design/quirks.md, such as lavapipe.
TEST(CheckBuiltIn, ReportsNothingOnADefectiveDevice) {
  DeviceLimits limits;
  limits.defects.changesNestedBuiltIns = limits.defects.corruptsHitAttributes = true;
  limits.defects.sharesAnyHit = limits.defects.sharesLocalArrays = true;
  for (const std::string& name : builtInPrograms())
    EXPECT_EQ(textOf(check(program::loadProgram(name), checkCompiler(), nullptr, limits)), "") << name;
}

// Programs for any scene.
TEST(CheckBuiltIn, ReportsNothingForScenesOfOneKind) {
  const program::SceneFacts scenes[] = {sceneWith({}),
                                        sceneWith({{program::GeometryKind::triangles, false, "mesh", "stone"}}),
                                        sceneWith({{program::GeometryKind::triangles, true, "mesh", "leaf"}}),
                                        sceneWith({{program::GeometryKind::solids, false, "balls", "glass"}}),
                                        sceneWith({{program::GeometryKind::solids, true, "balls", "net"}}),
                                        sceneWith({{program::GeometryKind::csg, false, "tree", ""}})};
  for (const std::string& name : builtInPrograms()) {
    const program::Program program = program::loadProgram(name);
    if (!program.scene.empty() || name == "replay") continue;  // replay supports triangles only (quintet bench)
    const program::CompiledProgram compiled = compile(program, checkCompiler(), {});
    for (const program::SceneFacts& scene : scenes) EXPECT_EQ(textOf(check(program, compiled, &scene, {})), "") << name;
  }
}

// As `render` compiles them for a scene with almost no features.
TEST(CheckBuiltIn, ReportsNothingWithoutFeatures) {
  std::vector<std::pair<std::string, std::string>> defines;
  for (const EmbeddedFile& file : embeddedShaderLibrary())
    for (std::size_t at = 0; (at = file.data.find("QUINTET_NO_", at)) != std::string_view::npos; ++at) {
      const std::string define(
          file.data.substr(at, file.data.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_", at) - at));
      if (std::ranges::find(defines, define, &std::pair<std::string, std::string>::first) == defines.end())
        defines.push_back({define, ""});
    }
  EXPECT_GT(defines.size(), 5u);
  for (const char* name : {"pathtracer", "ao", "naive", "normals"})
    EXPECT_EQ(textOf(check(program::loadProgram(name), checkCompiler(), nullptr, {}, defines)), "") << name;
}

}  // namespace
}  // namespace quintet::check

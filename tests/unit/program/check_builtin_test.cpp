// No diagnostic on what Quintet ships, and the check is quick.
#include <algorithm>
#include <cstdio>

#include "check_test_support.h"
#include "render/program_scene.h"
#include "render/scene_facts.h"
#include "shader/embedded_library.h"

namespace quintet::program {
namespace {

TEST(CheckBuiltIn, NothingIsReported) {
  for (const std::string& name : builtInPrograms()) {
    const CheckResult result = check(loadProgram(name), checkCompiler(), nullptr, {});
    EXPECT_EQ(textOf(result), "") << name;
    EXPECT_LE(result.recursionDepth, name.starts_with("lessons/") ? 6u : 1u) << name;
  }
}

TEST(CheckBuiltIn, NothingIsReportedWithAScene) {
  SceneFacts scene =
      sceneWith({{GeometryKind::triangles, false, "mesh", "stone"}, {GeometryKind::triangles, true, "mesh", "leaf"}});
  for (const std::string& name : builtInPrograms()) {
    const Program program = loadProgram(name);
    // Lessons with their own scenes.
    const SceneFacts own = program.scene.empty() ? scene : render::sceneFacts(render::programScene(program));
    EXPECT_EQ(textOf(check(program, checkCompiler(), &own, {})), "") << name;
  }
}

// A device with every defect of docs/design/quirks.md, as lavapipe is.
TEST(CheckBuiltIn, NothingIsReportedOnADefectiveDevice) {
  DeviceLimits limits;
  limits.quirks.changesNestedBuiltIns = limits.quirks.corruptsHitAttributes = true;
  limits.quirks.sharesAnyHit = limits.quirks.sharesLocalArrays = true;
  for (const std::string& name : builtInPrograms())
    EXPECT_EQ(textOf(check(loadProgram(name), checkCompiler(), nullptr, limits)), "") << name;
}

// Whatever the scene has: programs that are for any scene.
TEST(CheckBuiltIn, NothingIsReportedForScenesOfOneKind) {
  const SceneFacts scenes[] = {sceneWith({}),
                               sceneWith({{GeometryKind::triangles, false, "mesh", "stone"}}),
                               sceneWith({{GeometryKind::triangles, true, "mesh", "leaf"}}),
                               sceneWith({{GeometryKind::solids, false, "balls", "glass"}}),
                               sceneWith({{GeometryKind::solids, true, "balls", "net"}}),
                               sceneWith({{GeometryKind::csg, false, "tree", ""}})};
  for (const std::string& name : builtInPrograms()) {
    const Program program = loadProgram(name);
    if (!program.scene.empty() || name == "replay") continue;  // replay: triangles only, for quintet bench
    const CompiledProgram compiled = compile(program, checkCompiler(), {});
    for (const SceneFacts& scene : scenes) EXPECT_EQ(textOf(check(program, compiled, &scene, {})), "") << name;
  }
}

// As `render` compiles them for a scene that has next to nothing.
TEST(CheckBuiltIn, NothingIsReportedWithoutFeatures) {
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
    EXPECT_EQ(textOf(check(loadProgram(name), checkCompiler(), nullptr, {}, defines)), "") << name;
}

// It runs at every start: the check itself, without compilation, takes some ten milliseconds. The quickest of five: what else
// the machine does is not the check's.
TEST(CheckBuiltIn, IsQuick) {
  const Program program = loadProgram("pathtracer");
  const CompiledProgram compiled = compile(program, checkCompiler(), {});
  double seconds = 1e9;
  for (int i = 0; i < 5; ++i)
    seconds = std::min(seconds, check(program, compiled, nullptr, {}).seconds - compiled.seconds);
  EXPECT_LT(seconds, 0.5);
  RecordProperty("milliseconds", static_cast<int>(1000 * seconds));
}

}  // namespace
}  // namespace quintet::program

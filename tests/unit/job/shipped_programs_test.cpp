// SPDX-License-Identifier: Apache-2.0
// The modules of the path tracer in the binary serve every scene of triangles on every device.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "gpu/device_info.h"
#include "job/engine.h"
#include "program/compile.h"
#include "program/load.h"
#include "render/renderer/render_settings.h"
#include "render/scene/scene_features.h"
#include "shader/library.h"

namespace quintet::job {
namespace {

scene::Scene triangleScene(const scene::Material& material) {
  scene::Scene scene;
  scene.materials.push_back(material);
  scene::Geometry geometry;
  geometry.material = 0;
  scene.meshes.emplace_back().geometries.push_back(std::move(geometry));
  return scene;
}

// The files of the path tracer that the compiler compiles for a scene, instead of using a module of the binary.
std::vector<std::string> compiledFiles(const scene::Scene& scene, const std::vector<std::string>& outputs,
                                       bool lavapipe) {
  gpu::Quirks quirks;
  quirks.corruptsHitAttributes = quirks.slowInstances = quirks.slowTraceCalls = lavapipe;
  const render::Defines defines =
      render::renderDefines(render::shaderDefines(render::sceneFeatures(scene, {}), quirks), outputs);
  const program::Program pathtracer = program::loadProgram("<programs/pathtracer>");
  const shader::Compiler compiler = makeCompiler({});
  std::vector<std::string> compiled;
  const std::vector<std::string> files = program::stageFiles(pathtracer);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const shader::Result result =
        compiler.compile(program::stageSource(pathtracer, files[i], i, defines, program::Instrumentation::none));
    EXPECT_TRUE(result.ok()) << files[i];
    if (!result.shipped) compiled.push_back(files[i]);
  }
  return compiled;
}

TEST(ShippedPrograms, ServeScenesOfTriangles) {
  scene::Material plain, glass, mask, leaf, pane;
  glass.transmission = 1.0f, glass.thickness = 0.1f, glass.clearcoat = 1.0f;
  mask.alphaMode = scene::AlphaMode::mask, mask.baseColor.a = 0.5f;
  leaf.alphaMode = scene::AlphaMode::blend, leaf.baseColor.a = 0.5f;
  pane.transmission = 1.0f, pane.roughness = 0.0f, pane.emissive = vec3(1.0f);
  scene::Material paintedPane = pane;
  paintedPane.alphaMode = scene::AlphaMode::blend, paintedPane.baseColor.a = 0.5f;
  for (const bool lavapipe : {false, true})
    for (const scene::Material& material : {plain, glass, mask, leaf, pane, paintedPane})
      EXPECT_TRUE(compiledFiles(triangleScene(material), {}, lavapipe).empty()) << lavapipe;
}

// A material that no triangle has.
TEST(ShippedPrograms, ServeScenesWithAnUnusedPane) {
  scene::Scene scene = triangleScene({});
  scene.materials.emplace_back().transmission = 1.0f;
  scene.materials.back().roughness = 0.0f;
  for (const bool lavapipe : {false, true}) EXPECT_TRUE(compiledFiles(scene, {}, lavapipe).empty()) << lavapipe;
}

TEST(ShippedPrograms, OtherOutputsAreCompiled) {
  EXPECT_EQ(compiledFiles(triangleScene({}), {"albedo"}, false), std::vector<std::string>{"pathtracer.rgen"});
}

TEST(ShippedPrograms, ContainThePassesOfEveryRender) {
  const shader::Compiler compiler = makeCompiler({});
  for (const char* pass : {"film_add", "film_check", "film_mean"})
    EXPECT_TRUE(compiler.compile(shader::passSource(pass)).shipped) << pass;
}

}  // namespace
}  // namespace quintet::job

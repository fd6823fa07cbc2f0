// SPDX-License-Identifier: Apache-2.0
#include "run_program.h"

#include "harness.h"
#include "program/description/parser.h"
#include "shader/compiler.h"

namespace quintet::test {

Outputs runProgram(const std::string& toml, const Files& files, const SceneBuilder& scene, std::uint32_t pixels,
                   const std::vector<std::string>& set) {
  Files whole;
  for (const auto& [name, text] : files)
    whole[name] = shader::stageOfFile(name) ? "#version 460\n#extension GL_EXT_ray_tracing : require\n" + text : text;
  ImageOptions options;
  options.program = program::parseProgram(toml, "test", "<test>", whole);
  options.set = set;
  options.width = pixels;
  options.height = 1;
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  render::Renderer renderer = makeRenderer(device, options.program, settingsFor(scene.scene.cameras[0], options));
  renderer.renderBatch(1);
  Outputs outputs;
  for (std::size_t i = 0; i < options.program.outputs.size(); ++i) {
    const io::Image image = renderer.image(i);
    std::vector<vec4>& values = outputs.emplace_back();
    for (std::uint32_t x = 0; x < pixels; ++x) {
      const auto p = image.pixel<float>(x, 0);
      values.emplace_back(p[0], p[1], p[2], p[3]);
    }
  }
  return outputs;
}

SceneBuilder namedSquares(const std::vector<std::string>& names) {
  SceneBuilder builder;
  for (std::size_t i = 0; i < names.size(); ++i) {
    builder.add(quad({2.0f * static_cast<float>(i), 0, 0}, {1, 0, 0}, {0, 1, 0}), lambert(vec3(0.5f)));
    builder.scene.materials.back().name = names[i];
    builder.scene.meshes.back().name = names[i] + " mesh";
  }
  builder.camera(perspective({0, 0, 5}, {0, 0, 0}, 40.0f));
  return builder;
}

}  // namespace quintet::test

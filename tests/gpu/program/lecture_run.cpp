// SPDX-License-Identifier: Apache-2.0
#include "lecture_run.h"

#include <gtest/gtest.h>

#include "harness.h"

namespace quintet::test {

std::string lectureProblems(const program::Program& program) {
  std::string text;
  for (const Diagnostic& d : program::compile(program, testCompiler(), {}).diagnostics) text += d.format() + "\n";
  return text;
}

LectureImage runLecture(const program::Program& program, const scene::Scene& scene, const LectureOptions& options) {
  const std::string problems = lectureProblems(program);
  EXPECT_EQ(problems, "");
  LectureImage result;
  if (!problems.empty()) throw std::runtime_error(problems);
  render::DeviceScene device(testContext(), scene::Scene(scene), scene::Environment{});
  render::RenderSettings settings;
  settings.width = options.width;
  settings.height = options.height;
  settings.region = options.region;
  settings.launchSeconds = options.launchSeconds;
  settings.frameCount = options.frames;
  settings.timeoutSeconds = 600;
  settings.parameters = program::ParameterValues(program.parameters);
  for (const std::string& assignment : options.set) settings.parameters.setAssignment(assignment);
  render::Renderer renderer = makeRenderer(device, program, settings);
  for (std::uint32_t i = 0; i < options.frames; ++i) EXPECT_TRUE(renderer.renderFrame(i));
  const io::Image image = renderer.film().download(0);
  result.width = image.width;
  result.height = image.height;
  const std::span<const float> values = image.samples<float>();
  for (std::size_t i = 0; i < values.size(); i += 4)
    result.pixels.emplace_back(values[i], values[i + 1], values[i + 2], values[i + 3]);
  return result;
}

LectureImage runLecture(const std::string& text, const scene::Scene& scene, const LectureOptions& options,
                        const std::map<std::string, std::string>& included) {
  return runLecture(program::parseLecture(text, "test.rt.glsl", "test", included), scene, options);
}

void addBoxes(scene::Scene& scene, const std::vector<Bounds3>& boxes, const mat4& worldFromObject) {
  scene::PrimitiveSet set;
  set.kind = scene::PrimitiveSetKind::custom;
  set.boxes = boxes;
  scene::Mesh& mesh = scene.meshes.emplace_back();
  mesh.name = "boxes";
  mesh.primitiveSets.push_back(set);
  scene::Instance& instance = scene.instances.emplace_back();
  instance.mesh = static_cast<int>(scene.meshes.size()) - 1;
  instance.worldFromObject = worldFromObject;
}

}  // namespace quintet::test

// SPDX-License-Identifier: Apache-2.0
// Tests the installed library: animation, parameters, errors. Writes animation.png, lesson 19 after 14 frames, which
// run.cmake compares with the output of the command-line program.
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>

#include <quintet/quintet.h>

namespace {

int failures = 0;

void expect(bool holds, const std::string& what) {
  if (holds) return;
  failures++;
  std::fprintf(stderr, "consumer: failed: %s\n", what.c_str());
}

template <class Exception, class Action>
bool throws(const Action& action) {
  try {
    action();
  } catch (const Exception&) {
    return true;
  } catch (const std::exception&) {
  }
  return false;
}

void animation(quintet::Device& device) {
  const auto program = quintet::Program::load("lessons/19_dynamic");
  quintet::Renderer renderer(device, quintet::Scene::of(program), program, {.width = 96, .height = 64});
  renderer.render(1);
  const std::vector<float> first = renderer.image().pixels;
  renderer.render(13);
  expect(renderer.sampleCount() == 14, "the image must have 14 frames");
  expect(renderer.image().pixels != first, "the instances must move");
  renderer.image().write("animation.png");
}

void errors(quintet::Device& device) {
  const auto program = quintet::Program::load("lessons/01_first_ray");
  const auto scene = quintet::Scene::of(program);
  expect(program.parameters().front().defaultValue == "45",
         "a default value must have the syntax of --set: " + program.parameters().front().defaultValue);
  expect(throws<quintet::UsageError>([&] {
           quintet::Renderer(device, scene, program, {.parameters = {{"fieldOfVeiw", "3"}}});
         }),
         "an unknown parameter must throw UsageError");
  expect(throws<quintet::FileError>([] { quintet::Scene::load("missing.glb"); }),
         "a missing scene must throw FileError");
  expect(quintet::checkProgram(program, &scene).empty(), "lesson 01 must have no diagnostics");

  std::ofstream("bad.rt.glsl") << "struct RayPayloadType { vec3 color; };\n"
                                  "void main() { /**** RAY GENERATION SHADER ****/ gsnSetPixel(vec4(nothing)); }\n";
  const auto bad = quintet::Program::load("bad.rt.glsl");
  expect(quintet::checkProgram(bad).size() == 1 && quintet::checkProgram(bad).front().line == 2,
         "the diagnostic must have line 2");
  expect(throws<quintet::ProgramError>([&] { quintet::Renderer(device, scene, bad); }),
         "a program with errors must throw ProgramError");
}

}  // namespace

int main() try {
  expect(quintet::prepareDrivers(), "the process has one thread");
  quintet::Device device;
  animation(device);
  errors(device);
  return failures > 0 ? 1 : 0;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "consumer: %s\n", error.what()), 1;
}

// What the public library promises, seen from outside: animation, parameters, errors. Writes animation.png: lesson 19
// after 14 frames, which run.cmake compares with the command's.
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
  const std::vector<float> first = renderer.picture().pixels;
  renderer.render(13);
  expect(renderer.sampleCount() == 14, "14 frames");
  expect(renderer.picture().pixels != first, "the instances move");
  renderer.picture().write("animation.png");
}

void errors(quintet::Device& device) {
  const auto program = quintet::Program::load("lessons/01_first_ray");
  const auto scene = quintet::Scene::of(program);
  expect(program.parameters().front().defaultValue == "45",
         "a default as --set takes it: " + program.parameters().front().defaultValue);
  expect(throws<quintet::UsageError>([&] {
           quintet::Renderer(device, scene, program, {.parameters = {{"fieldOfVeiw", "3"}}});
         }),
         "a wrong parameter");
  expect(throws<quintet::FileError>([] { quintet::Scene::load("absent.glb"); }), "an absent scene");
  expect(quintet::check(program, &scene).empty(), "lesson 01 is clean");

  std::ofstream("bad.rt.glsl") << "struct RayPayloadType { vec3 color; };\n"
                                  "void main() { /**** RAY GENERATION SHADER ****/ gsnSetPixel(vec4(nothing)); }\n";
  const auto bad = quintet::Program::load("bad.rt.glsl");
  expect(quintet::check(bad).size() == 1 && quintet::check(bad).front().line == 2, "the error's line");
  expect(throws<quintet::ProgramError>([&] { quintet::Renderer(device, scene, bad); }),
         "a program that does not compile");
}

}  // namespace

int main() try {
  quintet::Device device;
  animation(device);
  errors(device);
  return failures > 0 ? 1 : 0;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "consumer: %s\n", error.what()), 1;
}

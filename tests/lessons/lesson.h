// SPDX-License-Identifier: Apache-2.0
// Runs a lesson at a small size as `quintet run` does and returns what its ray generation shader wrote; and geometry on the
// host in double precision as the reference.
#ifndef QUINTET_TESTS_LESSON_H
#define QUINTET_TESTS_LESSON_H

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/image.h"
#include "program/description/program.h"
#include "render/renderer/renderer.h"
#include "scene/model/scene.h"

namespace quintet::test {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;

// The value of a pixel for which float rounding decides, so that it is not compared.
inline const glm::dvec4 kUndecided(0);

struct LessonOptions {
  std::uint32_t width = 48;
  std::uint32_t height = 32;
  std::uint32_t frames = 1;  // frames of a lecture program, samples per pixel of other programs
  std::uint32_t seed = 0;
  std::vector<std::pair<std::string, std::string>> set;  // parameters
  std::optional<scene::Scene> scene;                     // instead of the lesson's scene
  std::optional<scene::Camera> camera;                   // for programs that use the scene's camera
};

struct LessonImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<io::Image> outputs;
  // (0, 0) is the bottom left pixel, as gl_LaunchIDEXT in a lecture program.
  vec4 at(std::uint32_t x, std::uint32_t y, std::size_t output = 0) const;
  // (0, 0) is the top left pixel.
  vec4 fromTop(std::uint32_t x, std::uint32_t y, std::size_t output = 0) const;
};

program::Program lesson(const std::string& name);  // "01_first_ray"
scene::Scene lessonScene(const std::string& name);
LessonImage renderLesson(const std::string& name, const LessonOptions& options = {});
// Renders the first camera of a lesson's scene as a pinhole and with a lens. Returns how many pixels differ.
int pixelsChangedByLens(const std::string& name);

struct HostRay {
  dvec3 origin;
  dvec3 direction;
};
// Returns the ray of a camera at `eye` through `point` in [0,1]², with (0,0) at the bottom left.
HostRay cameraRay(const dvec3& eye, const dvec3& lookAt, const dvec3& up, double fieldOfViewYDegrees, double aspect,
                  const dvec2& point);

struct HostHit {
  double t = -1;  // negative if the ray misses
  int instance = -1;
  int geometry = -1;
  int primitive = -1;
  dvec2 barycentric{0};  // weights of vertices 1 and 2
  double margin = 1e30;  // smallest distance of any edge test from zero along the ray, in barycentric units
};
// Returns the closest hit by testing every triangle of every instance (Möller and Trumbore 1997).
HostHit closestTriangle(const scene::Scene& scene, const HostRay& ray, double tmin = 1e-6, double tmax = 1e30);

// The surface at a hit, in world space.
struct HostSurface {
  dvec3 position;
  dvec3 normal;      // interpolated, unit
  dvec3 faceNormal;  // unit
  dvec2 texCoord{0};
};
HostSurface surfaceAt(const scene::Scene& scene, const HostHit& hit);

// Compares every pixel with expected(point), where point is in [0,1]² from the bottom left. A result with w = 0 is undecided,
// because an edge is too close, and is skipped. At most the fraction `undecided` of all pixels can be undecided.
void expectPixels(const LessonImage& image, const std::function<glm::dvec4(dvec2)>& expected, double tolerance,
                  double undecided = 0.05, std::size_t output = 0);

}  // namespace quintet::test
#endif

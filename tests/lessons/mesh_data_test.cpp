// SPDX-License-Identifier: Apache-2.0
// Lesson 03: positions, normals, texture coordinates and barycentrics of the hit triangle.
#include <gtest/gtest.h>

#include "lesson.h"

namespace quintet::test {
namespace {

void expectData(int show, const std::function<dvec3(const HostHit&, const HostSurface&)>& color) {
  LessonOptions options;
  options.set = {{"show", std::to_string(show)}};
  const scene::Scene scene = lessonScene("03_mesh_data");
  const double aspect = static_cast<double>(options.width) / options.height;
  expectPixels(
      renderLesson("03_mesh_data", options),
      [&](dvec2 point) {
        const HostHit hit =
            closestTriangle(scene, cameraRay({0, 1.5, 5}, {0, 1.5, 0}, {0, 1, 0}, 40, aspect, point), 0.001, 1000);
        if (hit.margin < 1e-3) return glm::dvec4(0);
        return glm::dvec4(hit.t > 0 ? color(hit, surfaceAt(scene, hit)) : dvec3(0), 1);
      },
      1e-4, 0.2);
}

TEST(LessonMeshData, ShowsPositions) {
  expectData(0, [](const HostHit&, const HostSurface& s) { return 0.5 + 0.2 * s.position; });
}
TEST(LessonMeshData, ShowsNormalsOfTheScaledSphere) {
  expectData(1, [](const HostHit&, const HostSurface& s) { return 0.5 + 0.5 * s.normal; });
}
// In glTF, v = 0 is the top of an image; in the lecture form, t = 0 is the bottom.
TEST(LessonMeshData, ShowsTextureCoordinates) {
  expectData(2, [](const HostHit&, const HostSurface& s) { return dvec3(s.texCoord.x, 1 - s.texCoord.y, 0); });
}
TEST(LessonMeshData, ShowsBarycentrics) {
  expectData(3, [](const HostHit& h, const HostSurface&) {
    return dvec3(1 - h.barycentric.x - h.barycentric.y, h.barycentric);
  });
}
TEST(LessonMeshData, ShowsFaceNormals) {
  expectData(4, [](const HostHit&, const HostSurface& s) { return 0.5 + 0.5 * s.faceNormal; });
}

}  // namespace
}  // namespace quintet::test

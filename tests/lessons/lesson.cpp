// SPDX-License-Identifier: Apache-2.0
#include "lesson.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "harness.h"
#include "io/color.h"
#include "program/load.h"
#include "rendered_image.h"
#include "scene/defaults/auto_camera.h"
#include "scene/defaults/default_environment.h"
#include "scene/toml/scene_toml.h"

namespace quintet::test {

vec4 LessonImage::fromTop(std::uint32_t x, std::uint32_t y, std::size_t output) const {
  const std::span<const float> p = outputs[output].pixel<float>(x, y);
  return {p[0], p[1], p[2], p[3]};
}

vec4 LessonImage::at(std::uint32_t x, std::uint32_t y, std::size_t output) const {
  return fromTop(x, height - 1 - y, output);
}

program::Program lesson(const std::string& name) { return program::loadProgram("lessons/" + name); }

scene::Scene lessonScene(const std::string& name) {
  const program::Program program = lesson(name);
  return scene::parseSceneToml(program.files.at(program.scene), program.path(program.scene), {});
}

LessonImage renderLesson(const std::string& name, const LessonOptions& options) {
  const program::Program program = lesson(name);
  const scene::Scene scene = options.scene ? *options.scene : lessonScene(name);
  render::RenderSettings settings;
  settings.width = options.width;
  settings.height = options.height;
  settings.seed = options.seed;
  const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
  settings.camera = options.camera           ? *options.camera
                    : !scene.cameras.empty() ? scene.cameras.front()
                                             : scene::frameScene(scene::worldBounds(scene), aspect);
  settings.parameters = program::ParameterValues(program.parameters);
  for (const auto& [parameter, value] : options.set) settings.parameters.set(parameter, value);

  render::DeviceScene deviceScene(testContext(), scene::Scene(scene), scene::effectiveEnvironment(scene));
  const bool framewise = program.accumulation == program::Accumulation::program;
  render::Renderer renderer = makeRenderer(deviceScene, program, settings);
  for (std::uint32_t done = 0; done < options.frames;) {
    if (framewise) deviceScene.setFrame(static_cast<float>(done));
    const std::uint32_t count = framewise ? 1u : std::min(render::kBatchSamples, options.frames - done);
    renderer.renderBatch(count);
    done += count;
  }
  LessonImage result{options.width, options.height, {}};
  for (std::size_t i = 0; i < program.outputs.size(); ++i) {
    io::Image& image = result.outputs.emplace_back(renderer.image(i));
    if (program.outputs[i].kind != program::OutputKind::display) continue;
    // Encode linear values as the shader wrote them.
    for (float& value : image.samples<float>()) value = io::srgbFromLinear(value);
  }
  return result;
}

int pixelsChangedByLens(const std::string& name) {
  LessonOptions options;
  options.camera = lessonScene(name).cameras.front();
  const LessonImage pinhole = renderLesson(name, options);
  options.camera->apertureRadius = 0.5f;
  const LessonImage lens = renderLesson(name, options);
  int different = 0;
  for (std::uint32_t y = 0; y < lens.height; ++y)
    for (std::uint32_t x = 0; x < lens.width; ++x) different += glm::length(lens.at(x, y) - pinhole.at(x, y)) > 1e-3f;
  return different;
}

HostRay cameraRay(const dvec3& eye, const dvec3& lookAt, const dvec3& up, double fieldOfViewYDegrees, double aspect,
                  const dvec2& point) {
  const dvec3 forward = glm::normalize(lookAt - eye);
  const dvec3 right = glm::normalize(glm::cross(forward, up));
  const dvec3 upright = glm::cross(right, forward);
  const double height = std::tan(0.5 * glm::radians(fieldOfViewYDegrees));
  const dvec2 p = 2.0 * point - 1.0;
  return {eye, glm::normalize(forward + p.x * aspect * height * right + p.y * height * upright)};
}

HostHit closestTriangle(const scene::Scene& scene, const HostRay& ray, double tmin, double tmax) {
  HostHit best;
  double closest = tmax;
  double margin = 1e30;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Instance& instance = scene.instances[i];
    const scene::Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
    // The ray in object space: t and barycentric coordinates are the same.
    const glm::dmat4 objectFromWorld = glm::inverse(glm::dmat4(instance.worldFromObject));
    const dvec3 origin(objectFromWorld * glm::dvec4(ray.origin, 1)),
        direction(objectFromWorld * glm::dvec4(ray.direction, 0));
    for (std::size_t g = 0; g < mesh.geometries.size(); ++g) {
      const scene::Geometry& geometry = mesh.geometries[g];
      for (std::size_t t = 0; t < geometry.triangles.size(); ++t) {
        const uvec3 v = geometry.triangles[t];
        const dvec3 a(geometry.positions[v.x]), e1 = dvec3(geometry.positions[v.y]) - a,
                                                e2 = dvec3(geometry.positions[v.z]) - a;
        const dvec3 p = glm::cross(direction, e2);
        const double det = glm::dot(e1, p);
        if (det == 0) continue;
        const dvec3 s = origin - a, q = glm::cross(s, e1);
        const double u = glm::dot(s, p) / det, w = glm::dot(direction, q) / det, distance = glm::dot(e2, q) / det;
        if (distance < tmin || distance > tmax) continue;
        margin = std::min({margin, std::abs(u), std::abs(w), std::abs(1 - u - w)});
        if (u < 0 || w < 0 || u + w > 1 || distance >= closest) continue;
        closest = distance;
        best = {distance, static_cast<int>(i), static_cast<int>(g), static_cast<int>(t), {u, w}, 0};
      }
    }
  }
  best.margin = margin;
  return best;
}

HostSurface surfaceAt(const scene::Scene& scene, const HostHit& hit) {
  const scene::Instance& instance = scene.instances[static_cast<std::size_t>(hit.instance)];
  const scene::Geometry& g =
      scene.meshes[static_cast<std::size_t>(instance.mesh)].geometries[static_cast<std::size_t>(hit.geometry)];
  const uvec3 v = g.triangles[static_cast<std::size_t>(hit.primitive)];
  const dvec3 weights(1 - hit.barycentric.x - hit.barycentric.y, hit.barycentric.x, hit.barycentric.y);
  const auto blend = [&](const auto& values) {
    return weights.x * glm::dvec4(glm::dvec3(values[v.x]), 0) + weights.y * glm::dvec4(glm::dvec3(values[v.y]), 0) +
           weights.z * glm::dvec4(glm::dvec3(values[v.z]), 0);
  };
  const glm::dmat4 world(instance.worldFromObject);
  const dmat3 normalMatrix = glm::transpose(glm::inverse(dmat3(world)));
  HostSurface s;
  s.position = dvec3(world * glm::dvec4(dvec3(blend(g.positions)), 1));
  const dvec3 p0(g.positions[v.x]), p1(g.positions[v.y]), p2(g.positions[v.z]);
  s.faceNormal = glm::normalize(normalMatrix * glm::cross(p1 - p0, p2 - p0));
  s.normal = g.normals.empty() ? s.faceNormal : glm::normalize(normalMatrix * dvec3(blend(g.normals)));
  if (!g.uvs[0].empty())
    s.texCoord = weights.x * dvec2(g.uvs[0][v.x]) + weights.y * dvec2(g.uvs[0][v.y]) + weights.z * dvec2(g.uvs[0][v.z]);
  return s;
}

void expectPixels(const LessonImage& image, const std::function<glm::dvec4(dvec2)>& expected, double tolerance,
                  double undecided, std::size_t output) {
  int skipped = 0, failed = 0;
  std::string text;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const glm::dvec4 want = expected(dvec2((x + 0.5) / image.width, (y + 0.5) / image.height));
      if (want.w == 0) {
        skipped++;
        continue;
      }
      const dvec3 got(image.at(x, y, output));
      const dvec3 difference = glm::abs(got - dvec3(want));
      if (std::max({difference.x, difference.y, difference.z}) <= tolerance) continue;
      if (failed++ < 8)
        text += fmt::format("  pixel {}, {}: {:.6f} {:.6f} {:.6f} instead of {:.6f} {:.6f} {:.6f}\n", x, y, got.x,
                            got.y, got.z, want.x, want.y, want.z);
    }
  }
  const int pixels = static_cast<int>(image.width * image.height);
  EXPECT_EQ(failed, 0) << "of " << pixels << " pixels, " << skipped << " of them undecided:\n" << text;
  EXPECT_LE(skipped, undecided * pixels);
}

}  // namespace quintet::test

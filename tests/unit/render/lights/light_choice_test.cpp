// SPDX-License-Identifier: Apache-2.0
// Exact quality of light sampling: the relative variance Σ E²/p / (Σ E)² - 1, where E is the irradiance of an emitter
// at a receiver without occlusion, and p its probability. The optimal choice has variance 0.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>

#include "../../../gpu/lights/tree_oracle.h"
#include "base/file.h"
#include "demo/test_scenes.h"
#include "render/lights/light_table.h"
#include "scene/gltf/gltf.h"
#include "temp_folder.h"

namespace quintet::render {
namespace {

using glm::dvec3;

// Lambert's formula (1760) for a triangle of radiance 1, clipped by the horizon.
double triangleIrradiance(const std::array<dvec3, 3>& corners, const dvec3& normal) {
  std::vector<dvec3> above;
  for (std::size_t i = 0; i < 3; ++i) {
    const dvec3 a = corners[i], b = corners[(i + 1) % 3];
    const double ha = glm::dot(a, normal), hb = glm::dot(b, normal);
    if (ha >= 0.0) above.push_back(glm::normalize(a));
    if ((ha < 0.0) != (hb < 0.0)) above.push_back(glm::normalize(a + (b - a) * (ha / (ha - hb))));
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < above.size(); ++i) {
    const dvec3 a = above[i], b = above[(i + 1) % above.size()], axis = glm::cross(a, b);
    const double sine = glm::length(axis);
    if (sine > 0.0) sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(axis, normal) / sine;
  }
  return std::abs(sum) / 2.0;
}

struct Triangle {
  std::array<vec3, 3> corners;
  float radiance;
};

Triangle worldTriangle(const scene::Scene& scene, std::size_t instance, std::size_t geometry, std::size_t i) {
  const scene::Instance& placed = scene.instances[instance];
  const scene::Geometry& g = scene.meshes[static_cast<std::size_t>(placed.mesh)].geometries[geometry];
  Triangle result{{},
                  g.material == scene::kNone ? 0.0f : scene.materials[static_cast<std::size_t>(g.material)].emissive.y};
  for (glm::length_t k = 0; k < 3; ++k)
    result.corners[static_cast<std::size_t>(k)] =
        vec3(placed.worldFromObject * vec4(g.positions[g.triangles[i][k]], 1.0f));
  return result;
}

// Returns points on surfaces that do not emit, uniform over triangles, which are small enough in these scenes.
std::vector<test::Receiver> receiversOn(const scene::Scene& scene, std::size_t count) {
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Mesh& mesh = scene.meshes[static_cast<std::size_t>(scene.instances[i].mesh)];
    for (std::size_t g = 0; g < mesh.geometries.size(); ++g)
      for (std::size_t t = 0; t < mesh.geometries[g].triangles.size(); ++t)
        if (const Triangle triangle = worldTriangle(scene, i, g, t); triangle.radiance == 0.0f)
          triangles.push_back(triangle);
  }
  std::mt19937 random(3);
  std::vector<test::Receiver> result;
  while (result.size() < count) {
    const auto& [a, b, c] = triangles[random() % triangles.size()].corners;
    const vec3 n = glm::normalize(glm::cross(b - a, c - a));
    result.push_back({(a + b + c) / 3.0f, n.y < 0.0f ? -n : n, 1});
  }
  return result;
}

struct Statistics {
  double mean, p95;
};
Statistics statisticsOf(std::vector<double> values) {
  std::ranges::sort(values);
  double sum = 0.0;
  for (const double v : values) sum += v;
  return {sum / static_cast<double>(values.size()), values[values.size() * 95 / 100]};
}

double relativeVariance(const std::vector<double>& irradiances, const std::vector<double>& probabilities) {
  double first = 0.0, second = 0.0;
  for (std::size_t i = 0; i < irradiances.size(); ++i) {
    if (irradiances[i] <= 0.0) continue;
    EXPECT_GT(probabilities[i], 0.0) << i;
    first += irradiances[i];
    second += irradiances[i] * irradiances[i] / probabilities[i];
  }
  return second / (first * first) - 1.0;
}

void compare(const char* name, const std::vector<std::byte>& file, double minGain, double maxVariance) {
  const test::TempFolder folder;
  writeFile(folder / "scene.glb", file);
  const scene::Scene scene = scene::loadGltf(folder / "scene.glb");
  const LightTable table = buildLightTable(scene, {});
  std::vector<double> powers;
  for (const shared::AliasEntry& entry : table.entries) powers.push_back(entry.probability);
  std::vector<double> byPower, byTree;
  for (const test::Receiver& receiver : receiversOn(scene, 60)) {
    std::vector<double> irradiances;
    for (const shared::LightData& light : table.lights) {
      const Triangle triangle = worldTriangle(scene, light.instance, light.geometry, light.primitive);
      std::array<dvec3, 3> seen;
      for (std::size_t k = 0; k < 3; ++k) seen[k] = dvec3(triangle.corners[k]) - dvec3(receiver.position);
      irradiances.push_back(triangle.radiance * triangleIrradiance(seen, receiver.normal));
    }
    byPower.push_back(relativeVariance(irradiances, powers));
    byTree.push_back(
        relativeVariance(irradiances, test::oracleProbabilities(table.nodes, table.lights.size(), receiver)));
  }
  const Statistics power = statisticsOf(byPower), tree = statisticsOf(byTree);
  std::printf("%s: %zu lights, relative variance by power %.2f (95 %% below %.2f), by the tree %.3f (%.3f)\n", name,
              table.lights.size(), power.mean, power.p95, tree.mean, tree.p95);
  EXPECT_GT(power.mean / tree.mean, minGain);
  EXPECT_LT(tree.mean, maxVariance);
}

TEST(LightChoice, TreeBeatsPower) {
  compare("lanterns", demo::lanterns(), 50.0, 2.0);
  compare("many_lights", demo::manyLights(), 10.0, 1.5);
}

}  // namespace
}  // namespace quintet::render

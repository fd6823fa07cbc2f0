// SPDX-License-Identifier: Apache-2.0
// Lessons 22 to 27: light transport. The references integrate on the host over grids of directions or of points of the
// lamps, or follow paths that sample the lamp on a grid; blocks of pixels agree within a few percent per channel.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "block_means.h"
#include "harness.h"

namespace quintet::test {
namespace {

constexpr std::uint32_t kTransportWidth = 24, kTransportHeight = 16;
const dvec3 kCornellEye(0, 1, 3.9);

LessonImage renderTransport(const std::string& name, std::uint32_t frames,
                            std::vector<std::pair<std::string, std::string>> set) {
  LessonOptions options;
  options.width = kTransportWidth;
  options.height = kTransportHeight;
  options.frames = frames;
  options.set = std::move(set);
  return renderLesson(name, options);
}

// The triangles of a scene in world space, so that a path of the host does not transform them again.
struct WorldTriangle {
  dvec3 a, edge1, edge2, normal;
  int instance = 0;
};

std::vector<WorldTriangle> worldTriangles(const scene::Scene& scene) {
  std::vector<WorldTriangle> triangles;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const glm::dmat4 world(scene.instances[i].worldFromObject);
    for (const scene::Geometry& g : scene.meshes[static_cast<std::size_t>(scene.instances[i].mesh)].geometries)
      for (const uvec3& t : g.triangles) {
        const auto corner = [&](std::uint32_t k) { return dvec3(world * glm::dvec4(dvec3(g.positions[k]), 1)); };
        const dvec3 a = corner(t.x), b = corner(t.y), c = corner(t.z);
        triangles.push_back({a, b - a, c - a, glm::normalize(glm::cross(b - a, c - a)), static_cast<int>(i)});
      }
  }
  return triangles;
}

struct WorldHit {
  double t = -1;
  dvec3 normal{0};  // on the side of the origin
  int instance = -1;
};

WorldHit closestHit(const std::vector<WorldTriangle>& triangles, const HostRay& ray, double tmax = 1e30) {
  WorldHit best;
  double closest = tmax;
  for (const WorldTriangle& t : triangles) {
    const dvec3 p = glm::cross(ray.direction, t.edge2);
    const double det = glm::dot(t.edge1, p);
    if (det == 0) continue;
    const dvec3 s = ray.origin - t.a, q = glm::cross(s, t.edge1);
    const double u = glm::dot(s, p) / det, v = glm::dot(ray.direction, q) / det, d = glm::dot(t.edge2, q) / det;
    if (u < 0 || v < 0 || u + v > 1 || d < 1e-7 || d >= closest) continue;
    closest = d;
    best = {d, glm::dot(t.normal, ray.direction) > 0 ? -t.normal : t.normal, t.instance};
  }
  return best;
}

HostRay pixelRay(const dvec3& eye, double fieldOfView, const dvec2& shift, double x, double y) {
  const dvec2 ndc = 2.0 * dvec2(x / kTransportWidth, y / kTransportHeight) - 1.0;
  const dvec2 plane =
      ndc * dvec2(double(kTransportWidth) / kTransportHeight, 1) * std::tan(0.5 * glm::radians(fieldOfView)) - shift;
  return {eye, glm::normalize(dvec3(plane, -1))};
}

// ---- 23 and 24: the sky ----

dvec3 skyRadiance(const dvec3& d) {
  return glm::mix(dvec3(1, 0.95, 0.85), dvec3(0.25, 0.5, 1), glm::clamp(d.y, 0.0, 1.0));
}

// Integrates over a grid of polar angles and azimuths with the solid angle of each cell, which is neither of the two
// densities of the lessons.
dvec3 underTheSky(const std::vector<WorldTriangle>& triangles, std::uint32_t x, std::uint32_t y, HostRandom& random) {
  const HostRay ray = pixelRay({0, 2.2, 6}, 35, {0, 0.28}, x + 0.5, y + 0.5);
  const WorldHit hit = closestHit(triangles, ray);
  if (hit.t < 0) return skyRadiance(ray.direction);
  const dvec3 albedo[3] = {dvec3(0.6), {0.8, 0.45, 0.2}, {0.35, 0.6, 0.4}};
  const dvec3 position = ray.origin + hit.t * ray.direction + 1e-4 * hit.normal;
  const dvec3 side =
      glm::normalize(glm::cross(hit.normal, std::abs(hit.normal.x) < 0.5 ? dvec3(1, 0, 0) : dvec3(0, 1, 0)));
  const dvec3 other = glm::cross(hit.normal, side);
  constexpr int kRings = 24, kSectors = 48;
  const double dTheta = glm::half_pi<double>() / kRings, dPhi = glm::two_pi<double>() / kSectors;
  dvec3 sum(0);
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kSectors; ++j) {
      const double theta = (i + random()) * dTheta, phi = (j + random()) * dPhi;
      const dvec3 d = std::sin(theta) * (std::cos(phi) * side + std::sin(phi) * other) + std::cos(theta) * hit.normal;
      if (closestHit(triangles, {position, d}).t >= 0) continue;
      sum += skyRadiance(d) * std::cos(theta) * std::sin(theta) * dTheta * dPhi;
    }
  return albedo[hit.instance] / glm::pi<double>() * sum;
}

std::vector<dvec3> skyReference(const scene::Scene& scene) {
  const std::vector<WorldTriangle> triangles = worldTriangles(scene);
  return hostBlocks(kTransportWidth, kTransportHeight, [&](std::uint32_t x, std::uint32_t y, HostRandom& random) {
    return underTheSky(triangles, x, y, random);
  });
}

TEST(LessonSky, BothDensitiesGiveTheIntegral) {
  const std::vector<dvec3> reference = skyReference(lessonScene("23_monte_carlo"));
  expectBlocks(renderTransport("23_monte_carlo", 8, {{"samples", "64"}}), reference);
  for (const char* method : {"0", "1"})
    expectBlocks(renderTransport("24_cosine_sampling", 8, {{"samples", "64"}, {"method", method}}), reference);
}

// A sloping floor below a plate and beside a wall that hides half of the sky: directions have all azimuths and heights with
// their density.
TEST(LessonSky, DirectionsSurroundTheNormal) {
  const auto quadOf = [](const dvec3& corner, const dvec3& a, const dvec3& b) {
    scene::Geometry g;
    for (const dvec3& p : {corner, corner + a, corner + a + b, corner + b}) g.positions.emplace_back(vec3(p));
    g.triangles = {{0, 1, 2}, {0, 2, 3}};
    return g;
  };
  for (const double turn : {0.4, 2.0}) {
    SCOPED_TRACE(turn);
    const dvec3 up = glm::normalize(dvec3(0.25, 1, 0.3)), side = glm::normalize(glm::cross(up, dvec3(0, 0, 1)));
    const dvec3 forward = glm::cross(side, up);
    const dvec3 toWall = std::cos(turn) * side + std::sin(turn) * forward, along = glm::cross(up, toWall);
    scene::Scene scene;
    for (const scene::Geometry& g : {quadOf(-40.0 * (side + forward), 80.0 * side, 80.0 * forward),
                                     quadOf(12.0 * toWall - 200.0 * along, 400.0 * along, 300.0 * up),
                                     quadOf(2.5 * up - 1.0 * (side + forward), 2.0 * side, 2.0 * forward)}) {
      scene.instances.emplace_back().mesh = static_cast<int>(scene.meshes.size());
      scene.meshes.emplace_back().geometries.push_back(g);
    }
    const std::vector<dvec3> reference = skyReference(scene);
    LessonOptions options;
    options.width = kTransportWidth, options.height = kTransportHeight;
    options.scene = scene;
    options.frames = 8;
    BlockLimits limits;
    limits.relative = 0.02;
    options.set = {{"samples", "128"}};
    expectBlocks(renderLesson("23_monte_carlo", options), reference, limits);
    for (const char* method : {"0", "1"}) {
      options.set = {{"samples", "128"}, {"method", method}};
      expectBlocks(renderLesson("24_cosine_sampling", options), reference, limits);
    }
  }
}

double noiseOf(const LessonImage& image, const LessonImage& reference) {
  double sum = 0;
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const dvec3 d = glm::pow(dvec3(image.at(x, y)), dvec3(2.2)) - glm::pow(dvec3(reference.at(x, y)), dvec3(2.2));
      sum += glm::dot(d, d);
    }
  return std::sqrt(sum);
}

TEST(LessonSky, CosineSamplingHasLessNoise) {
  const LessonImage reference = renderTransport("24_cosine_sampling", 16, {{"samples", "256"}});
  const auto noise = [&](const char* method) {
    return noiseOf(renderTransport("24_cosine_sampling", 1, {{"samples", "16"}, {"method", method}}), reference);
  };
  EXPECT_LT(noise("1"), 0.8 * noise("0"));
}

TEST(LessonSky, PixelsHaveDifferentSeeds) {
  for (const char* name : {"23_monte_carlo", "24_cosine_sampling"}) {
    const LessonImage image = renderTransport(name, 1, {{"samples", "1"}});
    int equal = 0;
    for (std::uint32_t x = 1; x < kTransportWidth; ++x) equal += image.at(x, 1) == image.at(x - 1, 1);
    EXPECT_LT(equal, 6) << name;
    const LessonImage two = renderTransport(name, 2, {{"samples", "1"}});
    EXPECT_NE(two.outputs[0].data, image.outputs[0].data) << name;
  }
}

// ---- 25, 27 and 22: the Cornell box ----

const dvec3 kLampRadiance(16, 13, 9);

dvec3 cornellAlbedo(int instance) {
  return instance == 2 ? dvec3(0.63, 0.065, 0.05) : instance == 3 ? dvec3(0.14, 0.45, 0.091) : dvec3(0.73);
}

// The direct light by a jittered grid of the lamp's solid angle per cell.
dvec3 directLight(const std::vector<WorldTriangle>& triangles, const dvec3& position, const dvec3& normal, int grid,
                  HostRandom& random) {
  dvec3 sum(0);
  const double cell = 0.5 / grid;
  for (int i = 0; i < grid; ++i)
    for (int j = 0; j < grid; ++j) {
      const dvec3 to = dvec3(-0.25 + (i + random()) * cell, 1.98, -0.25 + (j + random()) * cell) - position;
      const double r = glm::length(to);
      const double solidAngle = cell * cell * std::max(0.0, to.y / r) / (r * r);
      const double cosine = glm::dot(normal, to / r);
      if (cosine <= 0 || solidAngle <= 0) continue;
      if (closestHit(triangles, {position, to / r}, r - 2e-4).t >= 0) continue;
      sum += kLampRadiance * cosine * solidAngle / glm::pi<double>();
    }
  return sum;
}

TEST(LessonNextEvent, BothTechniquesGiveTheDirectLight) {
  const std::vector<WorldTriangle> triangles = worldTriangles(lessonScene("25_next_event"));
  const std::vector<dvec3> reference =
      hostBlocks(kTransportWidth, kTransportHeight, [&](std::uint32_t x, std::uint32_t y, HostRandom& random) {
        const HostRay ray = pixelRay(kCornellEye, 38, {0, 0}, x + 0.5, y + 0.5);
        const WorldHit hit = closestHit(triangles, ray);
        if (hit.t < 0) return dvec3(0);
        if (hit.instance == 1 && ray.direction.y > 0) return kLampRadiance;
        const dvec3 position = ray.origin + hit.t * ray.direction + 1e-4 * hit.normal;
        return cornellAlbedo(hit.instance) * directLight(triangles, position, hit.normal, 20, random);
      });
  BlockLimits exact;
  exact.relative = 0.015;
  // The rays of some pixels meet the edges of the walls, where GPUs find other hits than lavapipe and the host.
  exact.absolute = testContext().info().software ? 2.8e-3 : 4e-3;
  expectBlocks(renderTransport("25_next_event", 4, {{"samples", "128"}}), reference, exact);
  BlockLimits noisy;
  noisy.relative = 0.06;
  noisy.absolute = 5e-3;
  expectBlocks(renderTransport("25_next_event", 32, {{"samples", "256"}, {"nextEvent", "false"}}), reference, noisy);
}

// A path with next-event estimation on a grid of four points of the lamp. Paths end after `bounces` scattering events.
dvec3 cornellPath(const std::vector<WorldTriangle>& triangles, HostRay ray, int bounces, HostRandom& random) {
  dvec3 sum(0), weight(1);
  for (int depth = 0; depth < bounces; ++depth) {
    const WorldHit hit = closestHit(triangles, ray);
    if (hit.t < 0) break;
    if (hit.instance == 1 && ray.direction.y > 0) return depth == 0 ? kLampRadiance : sum;
    weight *= cornellAlbedo(hit.instance);
    const dvec3 position = ray.origin + hit.t * ray.direction + 1e-5 * hit.normal;
    sum += weight * directLight(triangles, position, hit.normal, 2, random);
    ray = {position, glm::normalize(hit.normal + random.unit())};
  }
  return sum;
}

std::vector<dvec3> cornellReference(int bounces, int paths) {
  const std::vector<WorldTriangle> triangles = worldTriangles(lessonScene("22_path_tracer"));
  return hostBlocks(kTransportWidth, kTransportHeight, [&](std::uint32_t x, std::uint32_t y, HostRandom& random) {
    dvec3 sum(0);
    for (int s = 0; s < paths; ++s)
      sum += cornellPath(triangles, pixelRay(kCornellEye, 38, {0, 0}, x + random(), y + random()), bounces, random);
    return sum / double(paths);
  });
}

TEST(LessonPathTracer, OneBounceIsTheDirectLight) {
  expectBlocks(renderTransport("22_path_tracer", 8, {{"bounces", "1"}, {"samples", "64"}}), cornellReference(1, 150));
}

TEST(LessonPathTracer, BlocksAgreeWithTheHostWithinThreePercent) {
  expectBlocks(renderTransport("22_path_tracer", 16, {{"bounces", "3"}, {"samples", "64"}}), cornellReference(3, 600));
}

// How often a path of lesson 27 with roulette is scattered. It goes on with the probability of its largest weight, at most 0.95.
int cornellEvents(const std::vector<WorldTriangle>& triangles, HostRay ray, int bounces, HostRandom& random) {
  dvec3 weight(1);
  for (int depth = 0; depth < bounces; ++depth) {
    const WorldHit hit = closestHit(triangles, ray);
    if (hit.t < 0 || (hit.instance == 1 && ray.direction.y > 0)) return depth;
    ray = {ray.origin + hit.t * ray.direction + 1e-4 * hit.normal, glm::normalize(hit.normal + random.unit())};
    weight *= cornellAlbedo(hit.instance);
    if (depth < 2) continue;
    const double survival = std::min(std::max({weight.x, weight.y, weight.z}), 0.95);
    if (random() >= survival) return depth + 1;
    weight /= survival;
  }
  return bounces;
}

TEST(LessonRoulette, KeepsTheMeanAndShortensPaths) {
  const std::vector<dvec3> reference = cornellReference(16, 250);
  BlockLimits limits;
  limits.relative = 0.04;
  for (const char* roulette : {"true", "false"})
    expectBlocks(renderTransport("27_roulette", 12, {{"bounces", "16"}, {"samples", "32"}, {"roulette", roulette}}),
                 reference, limits);
  const auto length = [](const char* roulette) {
    const LessonImage image =
        renderTransport("27_roulette", 2, {{"show", "1"}, {"samples", "64"}, {"roulette", roulette}});
    double sum = 0;
    for (std::uint32_t y = 0; y < image.height; ++y)
      for (std::uint32_t x = 0; x < image.width; ++x) sum += 64 * std::pow(image.at(x, y).x, 2.2);
    return sum / (image.width * image.height);
  };
  const double with = length("true"), without = length("false");
  testing::Test::RecordProperty("events", fmt::format("{:.2f} {:.2f}", with, without));
  EXPECT_LT(with, 0.75 * without);
  const std::vector<WorldTriangle> triangles = worldTriangles(lessonScene("27_roulette"));
  const std::vector<dvec3> events =
      hostBlocks(kTransportWidth, kTransportHeight, [&](std::uint32_t x, std::uint32_t y, HostRandom& random) {
        double sum = 0;
        for (int s = 0; s < 64; ++s)
          sum += cornellEvents(triangles, pixelRay(kCornellEye, 38, {0, 0}, x + random(), y + random()), 64, random);
        return dvec3(sum / 64);
      });
  EXPECT_NEAR(with, std::accumulate(events.begin(), events.end(), dvec3(0)).x / double(events.size()), 0.03 * with);
}

// ---- 26: glossy strips ----

dvec3 stripRadiance(const HostRay& ray) {
  const double floorT = -ray.origin.y / ray.direction.y, wallT = (-2 - ray.origin.z) / ray.direction.z;
  const double height[3] = {0.02, 0.12, 0.6}, middle[3] = {0.35, 0.95, 1.9};
  const dvec3 tint[3] = {{1, 0.55, 0.4}, {0.6, 1, 0.6}, {0.5, 0.7, 1}};
  const auto radiance = [&](int i) { return 2.5 / (3.6 * height[i]) * tint[i]; };
  const dvec3 onWall = ray.origin + wallT * ray.direction;
  const dvec3 p = ray.origin + floorT * ray.direction + dvec3(0, 1e-4, 0);  // with the bias of the lesson
  const bool onFloor = floorT > 0 && std::abs(p.x) < 2 && p.z > -2 && p.z < 4;
  for (int i = 0; i < 3; ++i)
    if (std::abs(onWall.x) < 1.8 && std::abs(onWall.y - middle[i]) < 0.5 * height[i] && !(onFloor && floorT < wallT))
      return radiance(i);
  if (!onFloor) return dvec3(0);
  const double exponents[4] = {20, 150, 1500, 15000};
  const double n = exponents[glm::clamp(static_cast<int>(std::floor(p.x + 2)), 0, 3)];
  const dvec3 mirrored = glm::reflect(ray.direction, dvec3(0, 1, 0));
  dvec3 sum(0);
  for (int i = 0; i < 3; ++i) {
    const int rows = std::max(4, static_cast<int>(height[i] / 0.006)), columns = 600;
    const double area = 3.6 * height[i] / (rows * columns);
    double lamp = 0;
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        const dvec3 to =
            dvec3(-1.8 + 3.6 * (c + 0.5) / columns, middle[i] + height[i] * ((r + 0.5) / rows - 0.5), -2) - p;
        const double squared = glm::dot(to, to);
        const dvec3 d = to / std::sqrt(squared);
        const double lobe = std::pow(std::max(0.0, glm::dot(d, mirrored)), n);
        lamp += lobe * d.y * -d.z / squared;
      }
    sum += radiance(i) * (n + 2) / glm::two_pi<double>() * lamp * area;
  }
  return sum;
}

// Next to the lamps all techniques are noisy, so only the rows in front of them are compared closely.
TEST(LessonMis, AllStrategiesGiveTheIntegral) {
  BlockLimits limits;
  limits.block = 4;
  const std::vector<dvec3> reference = hostBlocks(
      kTransportWidth, kTransportHeight,
      [](std::uint32_t x, std::uint32_t y, HostRandom&) {
        return stripRadiance(pixelRay({0, 1.6, 5.5}, 32, {0, 0.16}, x + 0.5, y + 0.5));
      },
      limits);
  const std::vector<dvec3> inFront(reference.begin(), reference.begin() + kTransportWidth / 4);
  const LessonImage both = renderTransport("26_mis", 8, {{"samples", "256"}});
  expectBlocks(both, inFront, limits);
  limits.relative = 0.12;
  expectBlocks(both, reference, limits);
  limits.relative = 0.06;
  limits.absolute = 2e-3;
  expectBlocks(renderTransport("26_mis", 16, {{"samples", "256"}, {"strategy", "0"}}), inFront, limits);
  // Points of the lamps are good for the rough strips on the left only.
  const std::vector<dvec3> rough(inFront.begin(), inFront.begin() + 3);
  expectBlocks(renderTransport("26_mis", 16, {{"samples", "256"}, {"strategy", "1"}}), rough, limits);
}

TEST(LessonMis, WeightsReduceTheNoiseOfBothTechniques) {
  const LessonImage reference = renderTransport("26_mis", 16, {{"samples", "256"}});
  const auto noise = [&](const char* strategy) {
    return noiseOf(renderTransport("26_mis", 1, {{"samples", "16"}, {"strategy", strategy}}), reference);
  };
  const double both = noise("2");
  EXPECT_LT(both, 0.7 * noise("0"));
  EXPECT_LT(both, 0.7 * noise("1"));
}

}  // namespace
}  // namespace quintet::test

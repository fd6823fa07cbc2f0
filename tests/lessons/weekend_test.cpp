// SPDX-License-Identifier: Apache-2.0
// Lessons 21 and 22: path tracers, compared with path tracers on the host that use other random numbers and, for lesson 22,
// no next-event estimation. The comparison uses blocks of pixels and their standard errors.
#include <gtest/gtest.h>

#include <mutex>
#include <random>

#include "base/parallel.h"
#include "solids.h"

namespace quintet::test {
namespace {

constexpr std::uint32_t kWidth = 24, kHeight = 16, kBlock = 8;

struct Mean {
  double sum = 0, squares = 0;
  int count = 0;
  void add(double v) { sum += v, squares += v * v, count++; }
  double value() const { return sum / count; }
  double variance() const { return std::max(0.0, squares / count - value() * value()) / (count - 1); }  // of the mean
};

struct Random {
  std::mt19937 engine;
  double operator()() { return std::uniform_real_distribution<double>(0, 1)(engine); }
  dvec3 unit() {
    std::normal_distribution<double> normal;
    return glm::normalize(dvec3(normal(engine), normal(engine), normal(engine)));
  }
};

using HostPath = std::function<dvec3(dvec2 point, Random& random)>;

// `toLinear` decodes the values of the lesson.
void expectBlocks(const std::string& name, const LessonOptions& given, std::uint32_t frames, int hostSamples,
                  const HostPath& path, const std::function<double(double)>& toLinear) {
  LessonOptions options = given;
  options.width = kWidth;
  options.height = kHeight;
  options.frames = frames;
  const LessonImage image = renderLesson(name, options);

  constexpr std::uint32_t kColumns = kWidth / kBlock, kRows = kHeight / kBlock;
  std::vector<Mean> host(kColumns * kRows);
  parallelFor(host.size(), [&](std::size_t block) {
    Random random{std::mt19937(static_cast<unsigned>(1 + block))};
    for (std::uint32_t i = 0; i < kBlock * kBlock; ++i) {
      const std::uint32_t x = static_cast<std::uint32_t>(block % kColumns) * kBlock + i % kBlock;
      const std::uint32_t y = static_cast<std::uint32_t>(block / kColumns) * kBlock + i / kBlock;
      for (int s = 0; s < hostSamples; ++s) {
        const dvec3 c = path(dvec2((x + random()) / kWidth, (y + random()) / kHeight), random);
        host[block].add((c.x + c.y + c.z) / 3);
      }
    }
  });
  for (std::size_t block = 0; block < host.size(); ++block) {
    Mean device;
    for (std::uint32_t i = 0; i < kBlock * kBlock; ++i) {
      const vec4 c = image.at(static_cast<std::uint32_t>(block % kColumns) * kBlock + i % kBlock,
                              static_cast<std::uint32_t>(block / kColumns) * kBlock + i / kBlock);
      device.add((toLinear(c.x) + toLinear(c.y) + toLinear(c.z)) / 3);
    }
    // The device takes at least as many samples per pixel as the host, so its error is at most that of the host.
    const double error = std::sqrt(2 * host[block].variance());
    EXPECT_NEAR(device.value(), host[block].value(), 4.5 * error + 1e-4) << "block " << block;
    EXPECT_LT(error, 0.06 * host[block].value()) << "block " << block << ": the standard error is too large";
  }
}

// ---- 22 ----

dvec3 cornellPath(const scene::Scene& scene, dvec2 point, Random& random) {
  HostRay ray = cameraRay({0, 1, 3.9}, {0, 1, 0}, {0, 1, 0}, 38, static_cast<double>(kWidth) / kHeight, point);
  dvec3 weight(1);
  for (int depth = 0; depth <= 3; ++depth) {
    const HostHit hit = closestTriangle(scene, ray, 1e-6, 1e4);
    if (hit.t < 0) return dvec3(0);
    if (hit.instance == 1 && ray.direction.y > 0) return weight * dvec3(16, 13, 9);
    const HostSurface s = surfaceAt(scene, hit);
    const dvec3 normal = glm::dot(s.faceNormal, ray.direction) > 0 ? -s.faceNormal : s.faceNormal;
    weight *= hit.instance == 2 ? dvec3(0.63, 0.065, 0.05) : hit.instance == 3 ? dvec3(0.14, 0.45, 0.091) : dvec3(0.73);
    ray = {s.position + 1e-5 * normal, glm::normalize(normal + random.unit())};
  }
  return dvec3(0);
}

TEST(LessonPathTracer, ConvergesToTheImageWithoutNextEventEstimation) {
  const scene::Scene scene = lessonScene("22_path_tracer");
  LessonOptions options;
  options.set = {{"bounces", "3"}, {"samples", "32"}};
  expectBlocks(
      "22_path_tracer", options, 8, 2400,
      [&](dvec2 point, Random& random) { return cornellPath(scene, point, random); },
      [](double v) { return std::pow(v, 2.2); });
}

// ---- 21 ----

std::uint32_t hashed(std::uint32_t x) {
  x = x * 747796405u + 2891336453u;
  x = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
  return (x >> 22u) ^ x;
}

struct Material {
  char kind;  // m diffuse, M metal, g glass
  dvec3 color;
  double fuzz;
};

Material materialOf(std::uint32_t i) {
  if (i == 0) return {'m', dvec3(0.5), 0};
  if (i == 1) return {'g', dvec3(1), 0};
  if (i == 2) return {'m', dvec3(0.4, 0.2, 0.1), 0};
  if (i == 3) return {'M', dvec3(0.7, 0.6, 0.5), 0};
  const auto thirds = [](std::uint32_t h) { return dvec3(h & 1023u, (h >> 10u) & 1023u, (h >> 20u) & 1023u) / 1023.0; };
  const std::uint32_t h = hashed(i), k = hashed(h);
  const dvec3 a = thirds(h), b = thirds(k);
  const double choice = (hashed(k + 1) >> 8u) / 16777216.0;
  if (choice < 0.8) return {'m', a * b, 0};
  if (choice < 0.95) return {'M', 0.5 + 0.5 * a, 0.5 * b.x};
  return {'g', dvec3(1), 0};
}

dvec3 weekendPath(const std::vector<Bounds3>& boxes, dvec2 point, Random& random) {
  const dvec3 eye(13, 2, 3), back = glm::normalize(eye), right = glm::normalize(glm::cross(dvec3(0, 1, 0), back)),
                             up = glm::cross(back, right);
  const dvec2 plane =
      (2.0 * point - 1.0) * dvec2(static_cast<double>(kWidth) / kHeight, 1) * std::tan(glm::radians(10.0));
  dvec2 lens;
  do lens = 2.0 * dvec2(random(), random()) - 1.0;
  while (glm::dot(lens, lens) > 1);
  const dvec3 from = eye + 0.05 * (lens.x * right + lens.y * up);
  HostRay ray{from, glm::normalize(eye + 10.0 * (plane.x * right + plane.y * up - back) - from)};
  dvec3 weight(1);
  for (int bounce = 0; bounce <= 16; ++bounce) {
    double t = 1e30;
    std::uint32_t which = 0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const dvec3 center = 0.5 * (dvec3(boxes[i].min) + dvec3(boxes[i].max));
      const auto interval = sphereInterval(ray, center, 0.5 * (double(boxes[i].max.x) - boxes[i].min.x));
      if (!interval) continue;
      const double candidate = interval->in > 1e-6 ? interval->in : interval->out;
      if (candidate > 1e-6 && candidate < t) t = candidate, which = static_cast<std::uint32_t>(i);
    }
    if (t >= 1e30) return weight * glm::mix(dvec3(1), dvec3(0.5, 0.7, 1), 0.5 + 0.5 * ray.direction.y);
    const dvec3 position = ray.origin + t * ray.direction;
    const dvec3 outward = glm::normalize(position - 0.5 * (dvec3(boxes[which].min) + dvec3(boxes[which].max)));
    const bool front = glm::dot(ray.direction, outward) < 0;
    const dvec3 normal = front ? outward : -outward;
    const Material m = materialOf(which);
    dvec3 next;
    if (m.kind == 'm') {
      next = normal + random.unit();
    } else if (m.kind == 'M') {
      next = glm::normalize(glm::reflect(ray.direction, normal)) + m.fuzz * random.unit();
      if (glm::dot(next, normal) <= 0) return dvec3(0);
    } else {
      const double eta = front ? 1 / 1.5 : 1.5, cosine = std::min(1.0, -glm::dot(ray.direction, normal));
      const double sine = eta * std::sqrt(1 - cosine * cosine);
      const double r0 = std::pow((1 - eta) / (1 + eta), 2), reflectance = r0 + (1 - r0) * std::pow(1 - cosine, 5);
      if (sine > 1 || reflectance > random())
        next = glm::reflect(ray.direction, normal);
      else
        next = eta * (ray.direction + cosine * normal) - std::sqrt(1 - sine * sine) * normal;
    }
    weight *= m.color;
    ray = {position, glm::normalize(next)};
    ray.origin += 1e-3 * (glm::dot(ray.direction, outward) > 0 ? outward : -outward);
  }
  return dvec3(0);
}

TEST(LessonOneWeekend, ConvergesToTheImageOfTheHost) {
  const scene::Scene scene = lessonScene("21_one_weekend");
  const std::vector<Bounds3>& boxes = scene.meshes.front().primitiveSets.front().boxes;
  ASSERT_GT(boxes.size(), 400u);
  expectBlocks(
      "21_one_weekend", {}, 8, 48, [&](dvec2 point, Random& random) { return weekendPath(boxes, point, random); },
      [](double v) { return v * v; });
}

}  // namespace
}  // namespace quintet::test

// SPDX-License-Identifier: Apache-2.0
// Lesson 21, compared with a path tracer on the host that uses other random numbers: the scene of the lesson, and scenes with
// one large sphere, which show a single material or the lens.
#include <gtest/gtest.h>

#include "block_means.h"
#include "solids.h"

namespace quintet::test {
namespace {

constexpr std::uint32_t kWeekendWidth = 24, kWeekendHeight = 16;

std::uint32_t hashed(std::uint32_t x) {
  x = x * 747796405u + 2891336453u;
  x = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
  return (x >> 22u) ^ x;
}

enum class Kind { diffuse, metal, glass };

struct WeekendMaterial {
  Kind kind;
  dvec3 color;
  double fuzz;
};

WeekendMaterial materialOf(std::uint32_t i) {
  if (i == 0) return {Kind::diffuse, dvec3(0.5), 0};
  if (i == 1) return {Kind::glass, dvec3(1), 0};
  if (i == 2) return {Kind::diffuse, dvec3(0.4, 0.2, 0.1), 0};
  if (i == 3) return {Kind::metal, dvec3(0.7, 0.6, 0.5), 0};
  const auto thirds = [](std::uint32_t h) { return dvec3(h & 1023u, (h >> 10u) & 1023u, (h >> 20u) & 1023u) / 1023.0; };
  const std::uint32_t h = hashed(i), k = hashed(h);
  const dvec3 a = thirds(h), b = thirds(k);
  const double choice = (hashed(k + 1) >> 8u) / 16777216.0;
  if (choice < 0.8) return {Kind::diffuse, a * b, 0};
  if (choice < 0.95) return {Kind::metal, 0.5 + 0.5 * a, 0.5 * b.x};
  return {Kind::glass, dvec3(1), 0};
}

struct WeekendSphere {
  std::uint32_t index = 0;
  dvec3 center{0};
  double radius = 0;
};

struct Lens {
  double aperture = 0.1;
  double focus = 10;
};

// Reflection and refraction are written with angles instead of reflect() and refract().
dvec3 weekendPath(const std::vector<WeekendSphere>& spheres, const Lens& lens, dvec2 point, HostRandom& random) {
  const dvec3 eye(13, 2, 3), back = glm::normalize(eye), right = glm::normalize(glm::cross(dvec3(0, 1, 0), back)),
                             up = glm::cross(back, right);
  const dvec2 plane =
      (2.0 * point - 1.0) * dvec2(double(kWeekendWidth) / kWeekendHeight, 1) * std::tan(glm::radians(10.0));
  dvec2 onLens;
  do onLens = 2.0 * dvec2(random(), random()) - 1.0;
  while (glm::dot(onLens, onLens) > 1);
  const dvec3 from = eye + 0.5 * lens.aperture * (onLens.x * right + onLens.y * up);
  HostRay ray{from, glm::normalize(eye + lens.focus * (plane.x * right + plane.y * up - back) - from)};
  dvec3 weight(1);
  for (int bounce = 0; bounce <= 16; ++bounce) {
    double t = 1e30;
    const WeekendSphere* which = nullptr;
    for (const WeekendSphere& sphere : spheres) {
      const auto interval = sphereInterval(ray, sphere.center, sphere.radius);
      if (!interval) continue;
      const double candidate = interval->in > 1e-6 ? interval->in : interval->out;
      if (candidate > 1e-6 && candidate < t) t = candidate, which = &sphere;
    }
    if (!which) return weight * glm::mix(dvec3(1), dvec3(0.5, 0.7, 1), 0.5 + 0.5 * ray.direction.y);
    const dvec3 position = ray.origin + t * ray.direction;
    const dvec3 outward = glm::normalize(position - which->center);
    const bool front = glm::dot(ray.direction, outward) < 0;
    const dvec3 normal = front ? outward : -outward;
    const WeekendMaterial m = materialOf(which->index);
    const double cosine = std::min(1.0, -glm::dot(ray.direction, normal));
    const dvec3 mirrored = ray.direction + 2 * cosine * normal;
    dvec3 next;
    if (m.kind == Kind::diffuse) {
      next = normal + random.unit();
    } else if (m.kind == Kind::metal) {
      next = mirrored + m.fuzz * random.unit();
      if (glm::dot(next, normal) <= 0) return dvec3(0);
    } else {
      const double eta = front ? 1 / 1.5 : 1.5, sine = eta * std::sqrt(1 - cosine * cosine);
      const double r0 = std::pow((1 - eta) / (1 + eta), 2), reflected = r0 + (1 - r0) * std::pow(1 - cosine, 5);
      if (sine > 1 || reflected > random())
        next = mirrored;
      else
        next = eta * (ray.direction + cosine * normal) - std::sqrt(1 - sine * sine) * normal;
    }
    weight *= m.color;
    ray = {position, glm::normalize(next)};
    ray.origin += 1e-3 * (glm::dot(ray.direction, outward) > 0 ? outward : -outward);
  }
  return dvec3(0);
}

WeekendSphere sphereIn(const Bounds3& box, std::uint32_t index) {
  return {index, 0.5 * (dvec3(box.min) + dvec3(box.max)), 0.5 * (double(box.max.x) - box.min.x)};
}

void expectWeekend(const scene::Scene& scene, const std::vector<WeekendSphere>& spheres, const Lens& lens,
                   std::uint32_t frames, int paths, std::uint32_t block, double relative = 0.03) {
  BlockLimits limits;
  limits.block = block;
  limits.relative = relative;
  limits.gamma = 2;
  const std::vector<dvec3> reference = hostBlocks(
      kWeekendWidth, kWeekendHeight,
      [&](std::uint32_t x, std::uint32_t y, HostRandom& random) {
        dvec3 sum(0);
        for (int s = 0; s < paths; ++s)
          sum += weekendPath(spheres, lens, {(x + random()) / kWeekendWidth, (y + random()) / kWeekendHeight}, random);
        return sum / double(paths);
      },
      limits);
  LessonOptions options;
  options.width = kWeekendWidth;
  options.height = kWeekendHeight;
  options.frames = frames;
  options.scene = scene;
  options.set = {{"samples", "32"}, {"aperture", std::to_string(lens.aperture)}, {"focus", std::to_string(lens.focus)}};
  expectBlocks(renderLesson("21_one_weekend", options), reference, limits);
}

// A scene with the ground and one sphere, whose material is that of the index. The spheres with smaller indices are hidden
// in the ground.
void expectOneSphere(std::uint32_t index, const dvec3& center, double radius, const Lens& lens, int paths = 1500,
                     double relative = 0.03) {
  scene::Scene scene = lessonScene("21_one_weekend");
  std::vector<Bounds3>& boxes = scene.meshes.front().primitiveSets.front().boxes;
  boxes.resize(index + 1);
  for (std::uint32_t i = 1; i < index; ++i)
    boxes[i] = {vec3(-0.1f, -500.1f, float(i) - 0.1f), vec3(0.1f, -499.9f, float(i) + 0.1f)};
  boxes[index] = {vec3(center - radius), vec3(center + radius)};
  expectWeekend(scene, {sphereIn(boxes[0], 0), sphereIn(boxes[index], index)}, lens,
                static_cast<std::uint32_t>(paths / 32), paths, 4, relative);
}

TEST(LessonOneWeekend, ConvergesToTheImageOfTheHost) {
  const scene::Scene scene = lessonScene("21_one_weekend");
  std::vector<WeekendSphere> spheres;
  for (const Bounds3& box : scene.meshes.front().primitiveSets.front().boxes)
    spheres.push_back(sphereIn(box, static_cast<std::uint32_t>(spheres.size())));
  ASSERT_GT(spheres.size(), 400u);
  expectWeekend(scene, spheres, {}, 8, 60, 8);
}

const dvec3 kInFront(7, 1.2, 1.6);

TEST(LessonOneWeekend, GlassReflectsAndRefracts) { expectOneSphere(1, kInFront, 1.2, {0, 10}, 6400, 0.006); }
TEST(LessonOneWeekend, DiffuseSpheresFollowTheCosine) { expectOneSphere(2, kInFront, 1.2, {0, 10}); }
TEST(LessonOneWeekend, MetalIsFuzzy) {
  std::uint32_t index = 4;
  while (materialOf(index).kind != Kind::metal || materialOf(index).fuzz < 0.3) index++;
  expectOneSphere(index, kInFront, 1.2, {0, 10});
}

// Far from the plane in focus, the size of the lens decides how wide the edge of the sphere is.
TEST(LessonOneWeekend, TheLensBlursWhatIsNotInFocus) {
  expectOneSphere(2, kInFront, 0.7, {1.2, 4});
  expectOneSphere(2, kInFront, 0.7, {1.2, 14});
}

TEST(LessonOneWeekend, PixelsAndFramesHaveDifferentSeeds) {
  LessonOptions options;
  options.width = kWeekendWidth;
  options.height = kWeekendHeight;
  options.set = {{"samples", "1"}};
  // The ground alone. Without noise, or with the same noise in all pixels, adjacent pixels have similar values; with
  // independent noise, the mean squared difference of adjacent pixels is twice the variance.
  options.scene = lessonScene("21_one_weekend");
  options.scene->meshes.front().primitiveSets.front().boxes.resize(1);
  const LessonImage one = renderLesson("21_one_weekend", options);
  double differences = 0, squares = 0, sum = 0;
  for (std::uint32_t x = 0; x < kWeekendWidth; ++x) sum += one.at(x, 1).x;
  for (std::uint32_t x = 0; x < kWeekendWidth; ++x) {
    squares += std::pow(one.at(x, 1).x - sum / kWeekendWidth, 2);
    if (x > 0) differences += std::pow(one.at(x, 1).x - one.at(x - 1, 1).x, 2);
  }
  EXPECT_GT(differences, squares) << "1 of 2 for independent noise";
  // A second frame with the same samples would not change the mean.
  options.frames = 2;
  const LessonImage two = renderLesson("21_one_weekend", options);
  int changed = 0;
  for (std::uint32_t y = 0; y < kWeekendHeight; ++y)
    for (std::uint32_t x = 0; x < kWeekendWidth; ++x) changed += glm::distance(one.at(x, y), two.at(x, y)) > 1e-3f;
  EXPECT_GT(changed, 200);
}

}  // namespace
}  // namespace quintet::test

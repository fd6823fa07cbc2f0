// SPDX-License-Identifier: Apache-2.0
// Lessons 08, 10 and 11: spheres with intersection shaders, compared with the closed form.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "solids.h"

namespace quintet::test {
namespace {

// The data of the nearest sphere that lesson 10 shows.
struct SphereHit {
  double t = 1e30;
  dvec3 normal{0};  // world space
  dvec3 local{0};   // point on the unit sphere
  bool entering = true;
  bool decided = true;
};

SphereHit nearestSphere(const scene::Scene& scene, const HostRay& ray) {
  SphereHit best;
  for (const scene::Instance& instance : scene.instances) {
    for (const Bounds3& box : scene.meshes[static_cast<std::size_t>(instance.mesh)].primitiveSets.front().boxes) {
      const dvec3 center = 0.5 * (dvec3(box.min) + dvec3(box.max));
      const double radius = 0.5 * (double(box.max.x) - box.min.x);
      const HostRay local = toObject(ray, instance.worldFromObject);
      const auto interval = sphereInterval(local, center, radius);
      // Near the outline, floats can decide differently.
      const double a = glm::dot(local.direction, local.direction);
      const dvec3 nearest =
          local.origin - center - glm::dot(local.origin - center, local.direction) / a * local.direction;
      if (std::abs(glm::length(nearest) / radius - 1) < 2e-3) best.decided = false;
      if (!interval || interval->out < 0.001) continue;
      const bool entering = interval->in >= 0.001;
      const double t = entering ? interval->in : interval->out;
      if (t >= best.t) continue;
      const dvec3 normal = (local.origin + t * local.direction - center) / radius;
      best = {t, normalToWorld(normal, instance.worldFromObject), normal, entering, best.decided};
    }
  }
  return best;
}

void expectSpheres(const scene::Scene& scene, int show, bool worldSpace,
                   const std::function<dvec3(const SphereHit&)>& color, double tolerance) {
  LessonOptions options;
  options.scene = scene;
  options.set = {{"show", std::to_string(show)}, {"worldSpace", worldSpace ? "true" : "false"}};
  int hits = 0;
  expectPixels(
      renderLesson("10_sphere", options),
      [&](dvec2 point) {
        const SphereHit hit = nearestSphere(scene, cameraRay({0, 0, 6}, {0, 0, 0}, {0, 1, 0}, 40, 1.5, point));
        if (!hit.decided) return kUndecided;
        hits += hit.t < 1e30;
        return glm::dvec4(hit.t < 1e30 ? color(hit) : dvec3(0.1, 0.12, 0.16), 1);
      },
      tolerance, 0.1);
  EXPECT_GT(hits, 150);
}

void expectSpheres(int show, bool worldSpace, const std::function<dvec3(const SphereHit&)>& color, double tolerance) {
  scene::Scene scene = lessonScene("10_sphere");
  if (worldSpace) scene.instances.pop_back();  // without the ellipsoid, which needs object space
  expectSpheres(scene, show, worldSpace, color, tolerance);
}

const auto kNormal = [](const SphereHit& h) { return 0.5 + 0.5 * h.normal; };
const auto kDistance = [](const SphereHit& h) { return dvec3(h.t / 10, h.entering ? 1 : 2, 0); };

TEST(LessonSphere, ShowsNormalsInObjectSpace) { expectSpheres(1, false, kNormal, 1e-4); }
TEST(LessonSphere, ShowsNormalsInWorldSpace) { expectSpheres(1, true, kNormal, 1e-4); }
TEST(LessonSphere, ShowsDistancesInObjectSpace) { expectSpheres(3, false, kDistance, 2e-5); }
TEST(LessonSphere, ShowsDistancesInWorldSpace) { expectSpheres(3, true, kDistance, 2e-5); }
TEST(LessonSphere, ShowsTextureCoordinates) {
  expectSpheres(
      2, false,
      [](const SphereHit& h) {
        const double s = std::atan2(h.local.y, h.local.x) / (2 * glm::pi<double>());
        return dvec3(s - std::floor(s), std::acos(-h.local.z) / glm::pi<double>(), 0);
      },
      2e-3);
}

// The camera is inside of a sphere, so that the hits leave it.
TEST(LessonSphere, ReportsWhereRaysLeave) {
  for (const bool worldSpace : {false, true}) {
    scene::Scene scene = lessonScene("10_sphere");
    scene.instances.resize(1);
    scene.instances[0].worldFromObject = glm::scale(glm::translate(mat4(1.0f), vec3(0.2f, -0.1f, 5.8f)), vec3(2.0f));
    expectSpheres(scene, 3, worldSpace, kDistance, 2e-5);
    expectSpheres(scene, 1, worldSpace, kNormal, 1e-4);
  }
}

// The shaded checkerboard, without the borders of its fields.
TEST(LessonSphere, ShowsACheckerboard) {
  const scene::Scene scene = lessonScene("10_sphere");
  int dark = 0, light = 0;
  expectPixels(
      renderLesson("10_sphere"),
      [&](dvec2 point) {
        const SphereHit hit = nearestSphere(scene, cameraRay({0, 0, 6}, {0, 0, 0}, {0, 1, 0}, 40, 1.5, point));
        if (!hit.decided) return kUndecided;
        if (hit.t >= 1e30) return glm::dvec4(0.1, 0.12, 0.16, 1);
        const double turn = std::atan2(hit.local.y, hit.local.x) / (2 * glm::pi<double>());
        const dvec2 fields(16 * (turn - std::floor(turn)), 8 * std::acos(-hit.local.z) / glm::pi<double>());
        const dvec2 border = glm::abs(fields - glm::round(fields));
        if (std::min(border.x, border.y) < 2e-2) return kUndecided;
        const bool odd = ((static_cast<int>(fields.x) + static_cast<int>(fields.y)) & 1) != 0;
        (odd ? dark : light)++;
        const double lit = 0.15 + 0.85 * std::max(0.0, glm::dot(hit.normal, glm::normalize(dvec3(1, 1.5, 2))));
        return glm::dvec4((odd ? dvec3(0.2, 0.4, 0.6) : dvec3(0.9, 0.85, 0.7)) * lit, 1);
      },
      1e-3, 0.25);
  EXPECT_GT(dark, 60);
  EXPECT_GT(light, 60);
}

dvec3 colorOf(std::uint32_t primitive) {
  std::uint32_t h = primitive * 747796405u + 2891336453u;
  h = ((h >> ((h >> 28u) + 4u)) ^ h) * 277803737u;
  h = (h >> 22u) ^ h;
  return 0.2 + 0.7 * dvec3(h & 255u, (h >> 8u) & 255u, (h >> 16u) & 255u) / 255.0;
}

TEST(LessonManySpheres, AgreesWithBruteForce) {
  const scene::Scene scene = lessonScene("11_many_spheres");
  const std::vector<Bounds3>& boxes = scene.meshes.front().primitiveSets.front().boxes;
  ASSERT_EQ(boxes.size(), 10000u);
  const auto nearest = [&](const HostRay& ray, double tmin, double tmax, bool& decided) {
    std::pair<double, int> best{tmax, -1};
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const dvec3 center = 0.5 * (dvec3(boxes[i].min) + dvec3(boxes[i].max));
      const double radius = 0.5 * (double(boxes[i].max.x) - boxes[i].min.x);
      const dvec3 o = ray.origin - center;
      const double along = glm::dot(o, ray.direction);
      const double distance = glm::length(o - along * ray.direction);
      if (std::abs(distance - radius) < 2e-4 && -along > tmin && -along < tmax) decided = false;
      const auto interval = sphereInterval(ray, center, radius);
      if (!interval) continue;
      const double t = interval->in >= tmin ? interval->in : interval->out;
      if (t >= tmin && t < best.first) best = {t, static_cast<int>(i)};
    }
    return best;
  };
  int hits = 0, dark = 0;
  expectPixels(
      renderLesson("11_many_spheres"),
      [&](dvec2 point) {
        bool decided = true;
        const HostRay ray = cameraRay({0, 0, 45}, {0, 0, 0}, {0, 1, 0}, 35, 1.5, point);
        const auto [t, i] = nearest(ray, 0.001, 1000, decided);
        if (!decided) return kUndecided;
        if (i < 0) return glm::dvec4(0.75, 0.82, 0.9, 1);
        const dvec3 center =
            0.5 * (dvec3(boxes[static_cast<std::size_t>(i)].min) + dvec3(boxes[static_cast<std::size_t>(i)].max));
        const dvec3 position = ray.origin + t * ray.direction;
        const dvec3 normal = glm::normalize(position - center);
        const dvec3 toLamp = dvec3(40, 60, 50) - position;
        const double distance = glm::length(toLamp);
        const bool seen = nearest({position + 0.001 * normal, toLamp / distance}, 0, distance, decided).second < 0;
        if (!decided) return kUndecided;
        hits++;
        dark += !seen;
        const double light = seen ? std::max(0.0, glm::dot(normal, toLamp / distance)) : 0.0;
        return glm::dvec4(colorOf(static_cast<std::uint32_t>(i)) * (0.12 + 0.88 * light), 1);
      },
      2e-3, 0.15);
  EXPECT_GT(hits, 300);
  EXPECT_GT(dark, 50);
}

// Returns the color of the path of lesson 08: floor, sphere, sky.
glm::dvec4 refractionColor(HostRay ray, double inside, double outside) {
  const dvec3 center(0, 1.5, 0);
  const double radius = 1.2;
  for (int level = 0; level < 8; ++level) {
    const double floorT = -ray.origin.y / ray.direction.y;
    const dvec3 onFloor = ray.origin + floorT * ray.direction;
    const bool floor = floorT > 0 && std::abs(onFloor.x) < 8 && onFloor.z > -12 && onFloor.z < 6;
    const dvec3 o = ray.origin - center;
    const double along = glm::dot(o, ray.direction), miss = glm::length(o - along * ray.direction);
    if (along < 0 && std::abs(miss - radius) < 5e-3) return kUndecided;
    const auto interval = sphereInterval(ray, center, radius);
    double t = -1;
    bool entering = true;
    if (interval && interval->out > 0) {
      entering = interval->in > 0;
      t = entering ? interval->in : interval->out;
    }
    if (floor && (t < 0 || floorT < t)) {
      const auto near = [](double v) { return std::abs(2 * v - std::round(2 * v)) < 1e-2; };
      if (near(onFloor.x) || near(onFloor.z)) return kUndecided;
      const bool dark = (static_cast<int>(std::floor(2 * onFloor.x) + std::floor(2 * onFloor.z)) & 1) != 0;
      return dark ? glm::dvec4(0.1, 0.15, 0.2, 1) : glm::dvec4(0.85, 0.8, 0.7, 1);
    }
    if (t < 0)
      return glm::dvec4(glm::mix(dvec3(0.9, 0.75, 0.6), dvec3(0.25, 0.45, 0.8), 0.5 + 0.5 * ray.direction.y), 1);
    const dvec3 position = ray.origin + t * ray.direction;
    const dvec3 normal = (entering ? 1.0 : -1.0) * (position - center) / radius;
    // Snell's law with angles instead of refract().
    const double eta = entering ? outside / inside : inside / outside;
    const double cosine = -glm::dot(ray.direction, normal);
    const double sine = eta * std::sqrt(std::max(0.0, 1 - cosine * cosine));
    if (std::abs(sine - 1) < 1e-3) return kUndecided;
    const dvec3 tangent = ray.direction + cosine * normal;
    const double length = glm::length(tangent);
    dvec3 next = ray.direction + 2 * cosine * normal;
    if (sine < 1) next = length > 0 ? sine / length * tangent - std::sqrt(1 - sine * sine) * normal : ray.direction;
    ray = {position + (sine < 1 ? -1e-4 : 1e-4) * normal, glm::normalize(next)};
  }
  return kUndecided;
}

void expectRefraction(double inside, double outside) {
  LessonOptions options;
  options.set = {{"inside", std::to_string(inside)}, {"outside", std::to_string(outside)}};
  expectPixels(
      renderLesson("08_refraction", options),
      [&](dvec2 point) {
        return refractionColor(cameraRay({0, 1.5, 6}, {0, 1.5, 0}, {0, 1, 0}, 35, 1.5, point), inside, outside);
      },
      5e-3, 0.25);
}

// The mean over all paths: each surface reflects a part of the light and refracts the rest. Clears `decided` if a path with
// a visible weight is close to an edge.
dvec3 fresnelMean(const HostRay& ray, int level, double weight, bool& decided) {
  if (level == 8) return dvec3(0);
  const dvec3 center(0, 1.5, 0);
  const auto interval = sphereInterval(ray, center, 1.2);
  const double floorT = -ray.origin.y / ray.direction.y;
  const dvec3 onFloor = ray.origin + floorT * ray.direction;
  const bool floor = floorT > 0 && std::abs(onFloor.x) < 8 && onFloor.z > -12 && onFloor.z < 6;
  const dvec3 o = ray.origin - center;
  const double along = glm::dot(o, ray.direction);
  const bool visible = weight > 5e-3;
  if (visible && along < 0 && std::abs(glm::length(o - along * ray.direction) - 1.2) < 5e-3) decided = false;
  double t = -1;
  bool entering = true;
  if (interval && interval->out > 0) {
    entering = interval->in > 0;
    t = entering ? interval->in : interval->out;
  }
  if (floor && (t < 0 || floorT < t)) {
    const auto near = [](double v) { return std::abs(2 * v - std::round(2 * v)) < 1e-2; };
    if (visible && (near(onFloor.x) || near(onFloor.z))) decided = false;
    const bool dark = (static_cast<int>(std::floor(2 * onFloor.x) + std::floor(2 * onFloor.z)) & 1) != 0;
    return dark ? dvec3(0.1, 0.15, 0.2) : dvec3(0.85, 0.8, 0.7);
  }
  if (t < 0) return glm::mix(dvec3(0.9, 0.75, 0.6), dvec3(0.25, 0.45, 0.8), 0.5 + 0.5 * ray.direction.y);
  const dvec3 position = ray.origin + t * ray.direction;
  const dvec3 normal = (entering ? 1.0 : -1.0) * (position - center) / 1.2;
  const double n1 = entering ? 1.0 : 1.5, n2 = entering ? 1.5 : 1.0;
  const double c1 = -glm::dot(ray.direction, normal), sine = n1 / n2 * std::sqrt(std::max(0.0, 1 - c1 * c1));
  const HostRay away{position + 1e-4 * normal, ray.direction + 2 * c1 * normal};
  if (sine >= 1) return fresnelMean(away, level + 1, weight, decided);
  // In terms of the angles (Fresnel's sine and tangent laws).
  const double a1 = std::acos(std::min(1.0, c1)), a2 = std::asin(sine);
  const double small = (n1 - n2) / (n1 + n2);
  const double s = a1 < 1e-6 ? small : std::sin(a1 - a2) / std::sin(a1 + a2);
  const double p = a1 < 1e-6 ? small : std::tan(a1 - a2) / std::tan(a1 + a2);
  const double reflected = 0.5 * (s * s + p * p);
  const dvec3 inward = n1 / n2 * (ray.direction + c1 * normal) - std::cos(a2) * normal;
  return reflected * fresnelMean(away, level + 1, weight * reflected, decided) +
         (1 - reflected) *
             fresnelMean({position - 1e-4 * normal, inward}, level + 1, weight * (1 - reflected), decided);
}

TEST(LessonRefraction, FresnelGivesTheMeanOfBothRays) {
  LessonOptions options;
  options.width = 36;
  options.height = 24;
  options.frames = 1024;
  options.set = {{"fresnel", "true"}};
  const LessonImage image = renderLesson("08_refraction", options);
  dvec3 bias(0);
  int decidedPixels = 0;
  std::uint32_t pixel = 0;
  expectPixels(
      image,
      [&](dvec2 point) {
        bool decided = true;
        const HostRay ray = cameraRay({0, 1.5, 6}, {0, 1.5, 0}, {0, 1, 0}, 35, 1.5, point);
        const dvec3 mean = fresnelMean(ray, 0, 1, decided);
        const std::uint32_t x = pixel % options.width, y = pixel / options.width;
        pixel++;
        if (!decided) return kUndecided;
        if (sphereInterval(ray, {0, 1.5, 0}, 1.2)) {
          bias += dvec3(image.at(x, y)) - mean;
          decidedPixels++;
        }
        return glm::dvec4(mean, 1);
      },
      0.04, 0.4);
  ASSERT_GT(decidedPixels, 100);
  EXPECT_LT(glm::length(bias) / decidedPixels, 1.5e-3);
}

TEST(LessonRefraction, RefractsGlassInAir) { expectRefraction(1.5, 1.0); }
TEST(LessonRefraction, ReflectsAirInWaterTotally) { expectRefraction(1.0, 1.33); }
TEST(LessonRefraction, PassesEqualMedia) { expectRefraction(1.2, 1.2); }

}  // namespace
}  // namespace quintet::test

// SPDX-License-Identifier: Apache-2.0
// The programs of document 002, unchanged from its slides: first ray, shadow, reflection as a loop, progressive average.
// Every pixel is compared with a reference in double precision, except pixels close to an edge.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "lecture_run.h"
#include "seeds.h"

namespace quintet::test {
namespace {

struct Plate {
  dvec3 corner, a, b;  // front a × b
};

scene::Scene sceneOf(const std::vector<Plate>& plates) {
  scene::Scene scene;
  for (const Plate& p : plates) {
    scene.meshes.emplace_back().geometries = {quad(vec3(p.corner), vec3(p.a), vec3(p.b))};
    scene.instances.emplace_back().mesh = static_cast<int>(scene.meshes.size()) - 1;
  }
  return scene;
}

struct HitD {
  double t;
  dvec3 position, normal;
};

std::optional<HitD> closest(const std::vector<Plate>& plates, const RayD& ray, double tmin, double tmax) {
  std::optional<HitD> best;
  for (const Plate& p : plates) {
    const double t = hitParallelogram(ray, p.corner, p.a, p.b);
    if (t >= tmin && t <= tmax && (!best || t < best->t))
      best = HitD{t, ray.origin + t * ray.direction, glm::normalize(glm::cross(p.a, p.b))};
  }
  return best;
}

// Compares with reference(position of the pixel in [0,1]²). Skips pixels where the reference changes abruptly around the
// center, because an edge is too close. Returns the number of compared pixels.
template <class Reference>
int expectImage(const LectureImage& image, double tolerance, const Reference& reference) {
  int compared = 0;
  for (std::uint32_t row = 0; row < image.height; ++row) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const auto at = [&](double dx, double dy) {
        return reference(dvec2((x + 0.5 + dx) / image.width, (row + 0.5 + dy) / image.height));
      };
      const dvec3 exact = at(0, 0);
      bool steady = true;
      for (const dvec2& d : {dvec2(0.01, 0), dvec2(-0.01, 0), dvec2(0, 0.01), dvec2(0, -0.01)})
        steady = steady && glm::distance(at(d.x, d.y), exact) < 0.02;
      if (!steady) continue;
      ++compared;
      const vec4& seen = image.at(x, row);
      EXPECT_LT(glm::distance(dvec3(seen), exact), tolerance)
          << "pixel " << x << "," << row << ": " << seen.x << " " << seen.y << " " << seen.z << " instead of "
          << exact.x << " " << exact.y << " " << exact.z;
    }
  }
  return compared;
}

constexpr const char* kRedOnBlack = R"(
void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(1.0, 0.0, 0.0);
}
void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0, 0.0, 0.0);
}
)";

// The part of the ray generation shader that slide "first ray" omits.
constexpr const char* kTraceAndSet = R"(
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, rayOrigin, 0.001, rayDirection, 10000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}
)";

std::string cameraOf(const std::string& document) {
  return cutBlock(document, "// Returns a camera ray for a camera at the origin");
}

std::string firstRay(const std::string& document) {
  return "struct RayPayloadType {\n  vec3 color;\n};\n" +
         cutBetween(document, "// Returns a camera ray for a camera", "...");
}

TEST(Seed002, FirstRayShowsARedSilhouette) {
  QUINTET_NEED_SEED(document, "002");
  const std::vector<Plate> plates{{{-1.5, -0.5, -5}, {2, 0, 0}, {0, 1.5, 0}},
                                  {{1, -1.5, -6}, {1.5, 0.5, 0}, {-0.5, 1, 1}}};
  const LectureImage image =
      runLecture(firstRay(document) + kTraceAndSet + kRedOnBlack, sceneOf(plates), {.width = 48, .height = 32});
  const int compared = expectImage(image, 1e-6, [&](const dvec2& point) {
    const bool hit = closest(plates, {dvec3(0), cameraDirection(45, 1.5, point)}, 0.001, 1e4).has_value();
    return dvec3(hit ? 1.0 : 0.0, 0.0, 0.0);
  });
  EXPECT_GT(compared, 1400);
}

// A scene for a moving light: a floor, a wall, and a plate above the floor.
const std::vector<Plate> kStage{{{-3, -1, -9}, {0, 0, 6}, {6, 0, 0}},
                                {{-1, 0.5, -7}, {0, 0, 1.5}, {1.5, 0, 0}},
                                {{-3, -1, -9}, {6, 0, 0}, {0, 4, 0}}};
const dvec3 kBaseColor(0.8, 0.6, 0.4), kAmbient(0.1, 0.1, 0.15);

// Returns the diffuse light with a shadow ray, as the closest-hit shader of the slide computes it.
dvec3 diffuse(const std::vector<Plate>& plates, const RayD& ray, const HitD& hit, const dvec3& light) {
  const double front = glm::dot(-ray.direction, hit.normal);
  const dvec3 towards = glm::normalize(light - hit.position);
  const RayD shadow{hit.position + (front < 0 ? -0.001 : 0.001) * hit.normal, towards};
  if (closest(plates, shadow, 0.001, glm::distance(light, hit.position))) return kAmbient;
  return kAmbient + kBaseColor * std::max(0.0, glm::dot(towards, hit.normal));
}

TEST(Seed002, ShadowFollowsTheMovingLight) {
  QUINTET_NEED_SEED(document, "002");
  const std::string program = cutProgram(document, "struct RayPayloadType {", 0, "/**** MISS SHADER ****/");
  ASSERT_NE(program.find("bool shadowRayMiss"), std::string::npos);
  const std::string elided =
      "uniform vec3 baseColor; // defaultval=\"0.8, 0.6, 0.4\"\nuniform vec3 ambientColor; // defaultval=\"0.1, 0.1, "
      "0.15\"\n" +
      cameraOf(document) + cutBetween(document, "void main() { /**** RAY GENERATION SHADER ****/", "...") +
      kTraceAndSet;
  const scene::Scene scene = sceneOf(kStage);
  int shadowed = 0;
  for (const std::uint32_t frames : {1u, 13u}) {
    const LectureImage image =
        runLecture(supplied(program, elided), scene, {.width = 48, .height = 36, .frames = frames});
    const double t = (frames - 1) / 45.0;
    const dvec3 light(5 * std::sin(2 * glm::pi<double>() * t), 5 * std::cos(2 * glm::pi<double>() * t), 5);
    const int compared = expectImage(image, 2e-4, [&](const dvec2& point) {
      const RayD ray{dvec3(0), cameraDirection(45, 4.0 / 3.0, point)};
      const auto hit = closest(kStage, ray, 0.001, 1e4);
      const dvec3 color = hit ? diffuse(kStage, ray, *hit, light) : dvec3(0);
      if (hit && color == kAmbient) ++shadowed;
      return color;
    });
    EXPECT_GT(compared, 1500);
  }
  EXPECT_GT(shadowed, 200);
}

TEST(Seed002, LoopFollowsReflections) {
  QUINTET_NEED_SEED(document, "002");
  const std::string program = cutProgram(document, "struct RayPayloadType {", 1, "/**** MISS SHADER ****/");
  ASSERT_NE(program.find("nextReflectionFactor"), std::string::npos);
  const std::string elided = cameraOf(document) + R"(
const vec3 baseColor = vec3(0.8, 0.6, 0.4), ambientColor = vec3(0.1, 0.1, 0.15), lightPos = vec3(2.0, 5.0, 3.0);
const vec3 camPos = vec3(1.0, 1.5, 8.0), camLookAt = vec3(0.0, -0.5, -6.0), camUp = vec3(0.0, 1.0, 0.0);
vec3 getCameraRayLookAt(float fieldOfViewY, float aspectRatio, vec3 eye, vec3 lookAt, vec3 up, vec2 point) {
  vec3 back = normalize(eye - lookAt), right = normalize(cross(up, back));
  return mat3(right, cross(back, right), back) * getCameraRay(fieldOfViewY, aspectRatio, point);
}
)";
  const LectureImage image = runLecture(supplied(program, elided), sceneOf(kStage), {.width = 48, .height = 36});
  const dvec3 eye(1, 1.5, 8), back = glm::normalize(eye - dvec3(0, -0.5, -6)),
                              right = glm::normalize(glm::cross(dvec3(0, 1, 0), back));
  int reflected = 0;
  const int compared = expectImage(image, 5e-4, [&](const dvec2& point) {
    const dvec3 c = cameraDirection(20, 4.0 / 3.0, point);
    RayD ray{eye, c.x * right + c.y * glm::cross(back, right) + c.z * back};
    dvec3 color(0);
    double contribution = 1;
    for (int level = 0; level < 5 && contribution > 0.001; ++level, contribution *= 0.25) {
      const auto hit = closest(kStage, ray, 0.001, 1e4);
      if (!hit) break;
      if (level > 0) ++reflected;
      color += contribution * diffuse(kStage, ray, *hit, dvec3(2, 5, 3));
      ray = {hit->position, glm::reflect(ray.direction, hit->normal)};
    }
    return color;
  });
  EXPECT_GT(compared, 1400);
  EXPECT_GT(reflected, 1000);
}

TEST(Seed002, FramesAverageHaltonSamples) {
  QUINTET_NEED_SEED(document, "002");
  const std::string average =
      cutBetween(document, "vec4 previousAverage", "vec4(newAverage, 1.0));") + "vec4(newAverage, 1.0));";
  std::string head = firstRay(document);
  // Anti-aliasing moves the point within the pixel.
  const std::size_t half = head.find("+ 0.5)");
  ASSERT_NE(half, std::string::npos);
  head.replace(half, 6, "+ vec2(halton(2, frameID + 1), halton(3, frameID + 1)))");
  const std::string sequence = R"(float halton(int base, int index) {
  float value = 0.0, digit = 1.0 / float(base);
  for (; index > 0; index /= base, digit /= float(base)) value += digit * float(index % base);
  return value;
}
)";
  const std::string text = sequence + head +
                           "\n  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, rayOrigin, 0.001, "
                           "rayDirection, 10000.0, 0);\n  " +
                           average + "\n}\n" + kRedOnBlack;
  const std::vector<Plate> plates{{{-1.5, -0.7, -5}, {2.3, 0.4, 0}, {-0.3, 1.5, 0}}};
  constexpr int kFrames = 16;
  const LectureImage image = runLecture(text, sceneOf(plates), {.width = 12, .height = 8, .frames = kFrames});
  int between = 0, compared = 0;
  for (std::uint32_t row = 0; row < 8; ++row) {
    for (std::uint32_t x = 0; x < 12; ++x) {
      // A sample close to an edge can be on either side, so compute bounds.
      int least = 0, most = 0;
      for (int i = 1; i <= kFrames; ++i) {
        int hits = 0, tested = 0;
        for (const dvec2& d : {dvec2(0), dvec2(0.001, 0), dvec2(-0.001, 0), dvec2(0, 0.001), dvec2(0, -0.001)}) {
          const dvec2 point((x + halton(2, i) + d.x) / 12.0, (row + halton(3, i) + d.y) / 8.0);
          hits += closest(plates, {dvec3(0), cameraDirection(45, 1.5, point)}, 0.001, 1e4) ? 1 : 0;
          ++tested;
        }
        least += hits == tested ? 1 : 0;
        most += hits > 0 ? 1 : 0;
      }
      const float seen = image.at(x, row).x;
      EXPECT_GE(seen, static_cast<float>(least) / kFrames - 1e-5f) << x << "," << row;
      EXPECT_LE(seen, static_cast<float>(most) / kFrames + 1e-5f) << x << "," << row;
      between += least > 0 && most < kFrames;
      compared += least == most;
    }
  }
  EXPECT_GT(between, 8);
  EXPECT_GT(compared, 85);
  EXPECT_EQ(halton(2, 6), 0.375);  // from the tables of the document
  EXPECT_NEAR(halton(3, 5), 0.777, 1e-3);
}

}  // namespace
}  // namespace quintet::test

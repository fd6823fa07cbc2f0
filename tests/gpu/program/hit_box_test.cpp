// SPDX-License-Identifier: Apache-2.0
// hitBox() of the GLSL library, and the example that uses it: examples/programs/ellipsoids.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/file.h"
#include "harness.h"
#include "job/scene_source.h"
#include "render/rendered_image.h"
#include "render/scene/camera.h"
#include "run_program.h"

namespace quintet::test {
namespace {

using glm::dmat3;
using glm::dmat4;
using glm::dvec2;
using glm::dvec3;
using glm::dvec4;

constexpr const char* kHitBoxToml = R"([program]
ray_generation = "main.rgen"
[[ray]]
name = "down"
miss = "none.rmiss"
[[hit_group]]
name = "boxes"
geometry = "custom"
down = { intersection = "box.rint", closest_hit = "box.rchit" }
[[output]]
name = "low"
[[output]]
name = "high"
)";
constexpr const char* kPayload = "struct Payload { vec3 low; vec3 high; };\n";

// Boxes in one row along x. Their order differs from the spatial order, in which some drivers need them.
scene::Scene scrambledBoxes(std::uint32_t count) {
  scene::PrimitiveSet set;
  set.kind = scene::PrimitiveSetKind::custom;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto column = static_cast<float>((7 * i + 3) % count);
    set.boxes.push_back({{column + 0.25f, -1.0f - static_cast<float>(i), -0.5f}, {column + 0.75f, 1.0f, 0.5f}});
  }
  scene::Scene scene;
  scene.meshes.emplace_back().primitiveSets.push_back(std::move(set));
  scene.instances.emplace_back().mesh = 0;
  return scene;
}

TEST(HitBox, IsTheBoxOfTheSceneInEachStage) {
  constexpr std::uint32_t kCount = 32;
  const Files files{{"payload.glsl", kPayload},
                    {"main.rgen", R"(#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT tlas;
layout(location = 0) rayPayloadEXT Payload payload;
void main() {
  const uvec2 pixel = launchPixel();
  traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFFu, kRay_down, kRayTypeCount, kMiss_down, vec3(float(pixel.x) + 0.5, 100.0, 0.0), 0.0, vec3(0.0, -1.0, 0.0), 1000.0, 0);
  storeOutput(kOutput_low, pixel, vec4(payload.low, 1.0));
  storeOutput(kOutput_high, pixel, vec4(payload.high, 1.0));
})"},
                    {"none.rmiss",
                     "#include \"payload.glsl\"\nlayout(location = 0) rayPayloadInEXT Payload payload;\n"
                     "void main() { payload.low = payload.high = vec3(0.0); }\n"},
                    // Reports the distance of the top only for the right box, so that both stages are tested.
                    {"box.rint", R"(#include <quintet/hit_geometry.glsl>
void main() {
  const BoxData box = hitBox();
  const vec3 o = gl_ObjectRayOriginEXT;
  if (box.min.x < o.x && o.x < box.max.x) reportIntersectionEXT(o.y - box.max.y, kHitEntering);
})"},
                    {"box.rchit",
                     "#include <quintet/hit_geometry.glsl>\n#include \"payload.glsl\"\n"
                     "layout(location = 0) rayPayloadInEXT Payload payload;\n"
                     "void main() { payload.low = hitBox().min; payload.high = hitBox().max; }\n"}};
  SceneBuilder builder;
  builder.scene = scrambledBoxes(kCount);
  builder.camera(perspective({0, 0, 5}, {0, 0, 0}, 40.0f));
  const Outputs outputs = runProgram(kHitBoxToml, files, builder, kCount);
  for (const Bounds3& box : builder.scene.meshes[0].primitiveSets[0].boxes) {
    const auto pixel = static_cast<std::size_t>(box.min.x);
    EXPECT_EQ(vec3(outputs[0][pixel]), box.min) << "pixel " << pixel;
    EXPECT_EQ(vec3(outputs[1][pixel]), box.max) << "pixel " << pixel;
  }
}

// Distance along the ray to the ellipsoid in the box, in object space, with the normal there.
std::optional<std::pair<double, dvec3>> ellipsoidHit(const Bounds3& box, const dvec3& origin, const dvec3& direction) {
  const dvec3 center = 0.5 * (dvec3(box.min) + dvec3(box.max)), radii = 0.5 * (dvec3(box.max) - dvec3(box.min));
  const dvec3 o = (origin - center) / radii, d = direction / radii;
  const double a = dot(d, d), b = dot(o, d), discriminant = b * b - a * (dot(o, o) - 1.0);
  if (discriminant < 0) return {};
  const double t = (-b - std::sqrt(discriminant)) / a;
  return std::pair{t, (o + t * d) / radii};
}

TEST(HitBox, LetsTheExampleRenderEllipsoids) {
  constexpr std::uint32_t kWidth = 60, kHeight = 40;
  const program::Program program = program::loadProgram(QUINTET_SOURCE_ROOT "/examples/programs/ellipsoids");
  const scene::Scene scene = job::loadScene(job::chooseSceneSource({}, program));
  ASSERT_EQ(scene.instances.size(), 1u);
  ASSERT_EQ(scene.cameras.size(), 1u);
  ImageOptions options;
  options.program = program;
  options.width = kWidth;
  options.height = kHeight;
  render::DeviceScene device(testContext(), scene::Scene(scene), {});
  render::Renderer renderer = makeRenderer(device, program, settingsFor(scene.cameras[0], options));
  renderer.renderBatch(1);
  const io::Image image = renderer.image();

  const shared::CameraData camera = render::makeCamera(scene.cameras[0], kWidth, kHeight);
  const dmat4 objectFromWorld = inverse(dmat4(scene.instances[0].worldFromObject));
  int hits = 0, wrong = 0;
  for (std::uint32_t y = 0; y < kHeight; ++y)
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const dvec2 plane(((2.0 * x + 1.0) / kWidth - 1.0) * camera.halfSize.x,
                        (1.0 - (2.0 * y + 1.0) / kHeight) * camera.halfSize.y);
      const auto toWorld = [&](const dvec4& p) {
        return dvec3(dot(dvec4(camera.worldFromCamera[0]), p), dot(dvec4(camera.worldFromCamera[1]), p),
                     dot(dvec4(camera.worldFromCamera[2]), p));
      };
      const dvec3 origin(objectFromWorld * dvec4(toWorld({0, 0, 0, 1}), 1));
      const dvec3 direction(objectFromWorld * dvec4(normalize(toWorld({plane, -1, 0})), 0));
      dvec3 expected(0);
      double nearest = 1e30;
      for (const Bounds3& box : scene.meshes[0].primitiveSets[0].boxes) {
        const auto hit = ellipsoidHit(box, origin, direction);
        if (!hit || hit->first >= nearest) continue;
        nearest = hit->first;
        expected = 0.5 + 0.5 * normalize(transpose(dmat3(objectFromWorld)) * hit->second);
      }
      hits += nearest < 1e30 ? 1 : 0;
      const auto p = image.pixel<float>(x, y);
      const dvec3 difference = abs(dvec3(p[0], p[1], p[2]) - expected);
      wrong += std::max({difference.x, difference.y, difference.z}) > 1e-3 ? 1 : 0;
    }
  EXPECT_GT(hits, 150);
  EXPECT_LE(wrong, 3) << "rounding at silhouettes";
}

// The documentation shows the shader that the test above runs.
TEST(HitBox, IsDocumentedByTheExample) {
  const std::string root = QUINTET_SOURCE_ROOT;
  const std::string shader = readTextFile(root + "/examples/programs/ellipsoids/ellipsoid.rint");
  const std::string page = readTextFile(root + "/docs/programs.md");
  EXPECT_NE(page.find("```glsl\n" + shader.substr(shader.find("#version")) + "```\n"), std::string::npos);
}

}  // namespace
}  // namespace quintet::test

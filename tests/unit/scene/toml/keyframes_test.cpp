// SPDX-License-Identifier: Apache-2.0
// Keyframes of lights, cameras, instances and the environment in scene files, against values computed by hand.
#include <gmock/gmock.h>

#include <algorithm>

#include "base/file.h"
#include "scene/animation/pose.h"
#include "scene/defaults/auto_camera.h"
#include "scene/defaults/default_environment.h"
#include "scene/model/content_hash.h"
#include "scene/toml/parse.h"

namespace quintet::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kRate = scene::kDefaultFramesPerSecond;

scene::Pose poseOf(const scene::Scene& scene, double seconds) {
  return scene::poseAt(scene.nodeAnimation.get(), seconds * kRate);
}
scene::Light lightIn(const scene::Scene& scene, double seconds) {
  return scene::lightAt(scene.lights.at(0), poseOf(scene, seconds));
}
scene::Camera cameraIn(const scene::Scene& scene, double seconds) {
  return scene::cameraAt(scene.cameras.at(0), poseOf(scene, seconds));
}
scene::Environment environmentIn(const scene::Scene& scene, double seconds) {
  scene::Environment environment = scene.environment;
  scene::moveEnvironment(environment, poseOf(scene, seconds));
  return environment;
}

scene::Scene lamp(const std::string& more) {
  return parse("[[light]]\nname = 'lamp'\ntype = 'point'\nposition = [1, 2, 3]\nintensity = 4\n" + more);
}
scene::Scene viewer(const std::string& more) {
  return parse("[[camera]]\nlook_from = [0, 0, 4]\nlook_at = [0, 0, 0]\n" + more);
}

// Value of a cubic Bézier curve by de Casteljau's algorithm. Its inner points follow from the tangents per second.
double bezier(double a, double leaving, double b, double arriving, double seconds, double t) {
  double p[] = {a, a + leaving * seconds / 3, b - arriving * seconds / 3, b};
  for (int count = 3; count > 0; --count)
    for (int i = 0; i < count; ++i) p[i] += t * (p[i + 1] - p[i]);
  return p[0];
}

void expectSameFrame(const mat4& a, const mat4& b) {
  for (int c = 0; c < 4; ++c) expectNear(vec3(a[c]), vec3(b[c]), 1e-5f);
}

// ---- Lights ----

TEST(LightKeyframes, AreLinearAndConstantOutside) {
  const scene::Scene scene = lamp(
      "keyframes = [{ time = 1, position = [0, 0, 0], color = [1, 0.5, 0] },\n"
      "{ time = 3, position = [4, 0, 2], intensity = 8 }, { time = 4, color = [0, 0, 1], range = 5 }]\n"
      "range = 9\n");
  EXPECT_FALSE(scene.lights[0].node != scene::kNone);
  EXPECT_EQ(scene::lastFrame(scene), 4 * kRate);
  for (const double before : {-1.0, 0.0, 1.0}) {
    expectNear(lightIn(scene, before).position, {0, 0, 0});
    expectNear(lightIn(scene, before).intensity, {4, 2, 0});
  }
  expectNear(lightIn(scene, 1.5).position, {1, 0, 0.5f});
  expectNear(lightIn(scene, 1.5).intensity, {5, 2.5f, 0}, 1e-5f);
  EXPECT_EQ(lightIn(scene, 1.5).range, 9);  // of the light
  expectNear(lightIn(scene, 3.5).position, {4, 0, 2});
  expectNear(lightIn(scene, 3.5).intensity, {4, 2, 4}, 1e-5f);  // 8 times the mean of both colors
  EXPECT_NEAR(lightIn(scene, 3.5).range, 7, 1e-5f);
  expectNear(lightIn(scene, 100).intensity, {0, 0, 8});
}

TEST(LightKeyframes, AtRestTheSceneIsThatOfFrame0) {
  const scene::Scene scene = lamp("keyframes = [{ time = -1, intensity = 2 }, { time = 3, intensity = 10 }]\n");
  expectNear(scene.lights[0].intensity, vec3(4.0f));
  EXPECT_TRUE(scene::isAnimated(scene));
  EXPECT_FALSE(scene::isAnimated(lamp("")));
  EXPECT_EQ(lamp("").nodeAnimation, nullptr);
}

TEST(LightKeyframes, CountTimesInFramesToo) {
  const scene::Scene seconds = lamp("keyframes = [{ time = 0.5, intensity = 1 }, { time = 2.5, intensity = 9 }]\n");
  const scene::Scene frames = lamp("keyframes = [{ frame = 12, intensity = 1 }, { frame = 60, intensity = 9 }]\n");
  for (const double time : {0.0, 0.7, 1.5, 2.5})
    EXPECT_EQ(lightIn(seconds, time).intensity, lightIn(frames, time).intensity);
  scene::LoadOptions options;
  options.framesPerSecond = 10;
  const scene::Scene slow = scene::parseSceneToml(
      "[[light]]\ntype = 'point'\nposition = [0, 0, 0]\nkeyframes = [{ frame = 0, intensity = 0 },\n"
      "{ frame = 10, intensity = 1 }]\n[[mesh]]\nshape = 'quad'\nname = 'q'\n[[instance]]\nof = 'q'\n"
      "keyframes = [{ time = 0 }, { time = 1, translate = [1, 0, 0] }]\n",
      "slow.toml", options);
  const scene::Pose middle = scene::poseAt(slow.nodeAnimation.get(), 5);
  EXPECT_NEAR(scene::lightAt(slow.lights[0], middle).intensity.x, 0.5f, 1e-6f);
  EXPECT_NEAR(scene::worldFromObjectAt(slow.instances[0], middle)[3].x, 0.5f, 1e-6f);
}

TEST(LightKeyframes, SpotsFollowTheirTarget) {
  const std::string spot = "[[light]]\ntype = 'spot'\nposition = [0, 2, 0]\nouter_angle = 60\ninner_angle = 10\n";
  const scene::Scene aimed = parse(spot +
                                   "target = [0, 0, 0]\nkeyframes = [{ time = 0 },\n"
                                   "{ time = 2, position = [4, 2, 0], outer_angle = 30, inner_angle = 30 }]\n");
  const scene::Light light = lightIn(aimed, 1);
  expectNear(light.direction, glm::normalize(vec3(-2, -2, 0)));
  EXPECT_NEAR(glm::degrees(light.outerConeAngle), 45, 1e-4f);
  EXPECT_NEAR(glm::degrees(light.innerConeAngle), 20, 1e-4f);
  expectNear(lightIn(aimed, 0).direction, {0, -1, 0});
  // The direction of a light without a target does not follow its position.
  const scene::Scene free =
      parse(spot + "direction = [0, -2, 0]\nkeyframes = [{ time = 0 }, { time = 2, position = [4, 2, 0] }]\n");
  expectNear(lightIn(free, 1).direction, {0, -1, 0});
  // Between opposite directions it turns at once, since the mean has no direction.
  const scene::Scene sun = parse(
      "[[light]]\ntype = 'directional'\ndirection = [0, -1, 0]\n"
      "keyframes = [{ time = 0 }, { time = 1, direction = [3, 0, 0] }, { time = 2, direction = [-1, 0, 0] }]\n");
  expectNear(lightIn(sun, 0.5).direction, glm::normalize(vec3(1, -1, 0)));
  expectNear(lightIn(sun, 1.25).direction, {1, 0, 0});
  expectNear(lightIn(sun, 1.5).direction, {0, -1, 0});  // that of frame 0
  expectNear(lightIn(sun, 1.75).direction, {-1, 0, 0});
}

// ---- Interpolation ----

TEST(SceneKeyframes, InterpolateAsTheFileStates) {
  const std::string keys =
      "keyframes = [{ time = 0, intensity = 1, position = [0, 0, 0] },\n"
      "{ time = 2, intensity = 5, position = [2, 0, 0] }]\n";
  EXPECT_EQ(lightIn(lamp("interpolation = 'step'\n" + keys), 1.99).intensity.x, 1);
  EXPECT_EQ(lightIn(lamp("interpolation = 'step'\n" + keys), 2).intensity.x, 5);
  EXPECT_EQ(lightIn(lamp("interpolation = 'linear'\n" + keys), 0.5).intensity.x, 2);
  const scene::Scene mixed = lamp("interpolation = { intensity = 'step' }\n" + keys);
  EXPECT_EQ(lightIn(mixed, 1).intensity.x, 1);
  EXPECT_EQ(lightIn(mixed, 1).position.x, 1);
}

TEST(SceneKeyframes, CubicSplinesPassTheirKeyframesSmoothly) {
  const scene::Scene scene = lamp(
      "interpolation = 'cubic'\nkeyframes = [{ time = 0, position = [0, 1, 0] }, { time = 1, position = [2, 1, 0] },\n"
      "{ time = 4, position = [5, 1, 0] }, { time = 5, position = [0, 1, 0] }]\n");
  const double tangents[] = {2, 5.0 / 4, -2.0 / 4, -5};
  const double times[] = {0, 1, 4, 5}, values[] = {0, 2, 5, 0};
  for (std::size_t i = 0; i < 3; ++i)
    for (const double t : {0.0, 0.25, 0.5, 0.9}) {
      const double length = times[i + 1] - times[i];
      const vec3 position = lightIn(scene, times[i] + t * length).position;
      EXPECT_NEAR(position.x, bezier(values[i], tangents[i], values[i + 1], tangents[i + 1], length, t), 1e-5)
          << i << t;
      EXPECT_EQ(position.y, 1);
    }
  expectNear(lightIn(lamp("interpolation = 'cubic'\nkeyframes = [{ time = 1, position = [7, 8, 9] }]\n"), 3).position,
             {7, 8, 9});
}

TEST(SceneKeyframes, CubicSplinesCanHaveTangents) {
  const scene::Scene scene = viewer(
      "interpolation = { fov = 'cubic' }\n"
      "keyframes = [{ time = 0, fov = 30, look_from = [0, 0, 4], out_tangent = { fov = 0 } },\n"
      "{ time = 2, fov = 50, look_from = [0, 0, 8], in_tangent = { fov = 30 }, out_tangent = { fov = -40 } },\n"
      "{ time = 3, fov = 40 }]\n");
  for (const double t : {0.1, 0.5, 0.75}) {
    EXPECT_NEAR(glm::degrees(cameraIn(scene, 2 * t).verticalFov), bezier(30, 0, 50, 30, 2, t), 1e-4);
    EXPECT_NEAR(glm::degrees(cameraIn(scene, 2 + t).verticalFov), bezier(50, -40, 40, -10, 1, t), 1e-4);
    EXPECT_NEAR(cameraIn(scene, 2 * t).worldFromCamera[3].z, 4 + 4 * t, 1e-5);
  }
}

TEST(SceneKeyframes, StayFinite) {
  const scene::Scene scene = parse(
      "[[light]]\ntype = 'point'\nposition = [0, 0, 0]\ninterpolation = 'cubic'\nkeyframes = [{ time = 0 },\n"
      "{ time = 1e9, position = [1e38, 0, 0], color = [1e12, 0, 0], in_tangent = { position = [-1e38, 0, 0] } }]\n"
      "[[mesh]]\nname = 'q'\nshape = 'quad'\n[[instance]]\nof = 'q'\ninterpolation = 'cubic'\n"
      "keyframes = [{ time = 0, translate = [1e18, 0, 0] }, { time = 1, translate = [-1e18, 0, 0] }]\n");
  for (const double time : {0.5, 0.4e9, 0.9e9, 1e9}) {
    EXPECT_TRUE(isFinite(lightIn(scene, time).position)) << time;
    EXPECT_TRUE(isFinite(lightIn(scene, time).intensity)) << time;
    EXPECT_TRUE(isFinite(vec3(scene::worldFromObjectAt(scene.instances.at(0), poseOf(scene, time))[3]))) << time;
  }
}

// ---- Cameras ----

TEST(CameraKeyframes, LookFromAndAtInterpolatedPoints) {
  const scene::Scene scene = viewer(
      "fov = 40\nup = [0, 2, 0]\nkeyframes = [{ time = 0 }, { time = 1, look_from = [4, 2, 0], look_at = [1, 1, 1] },\n"
      "{ time = 2, up = [0, 0, -1], fov = 60, aperture = 0.5 }]\n");
  const scene::Camera half = cameraIn(scene, 0.5);
  const scene::Camera expected = scene::lookAtCamera({2, 1, 2}, {0.5f, 0.5f, 0.5f}, {0, 1, 0}, 0, 0);
  expectSameFrame(half.worldFromCamera, expected.worldFromCamera);
  EXPECT_NEAR(half.focusDistance, expected.focusDistance, 1e-5f);  // follows look_at
  EXPECT_NEAR(glm::degrees(half.verticalFov), 40, 1e-4f);
  const scene::Camera later = cameraIn(scene, 1.5);
  expectSameFrame(later.worldFromCamera,
                  scene::lookAtCamera({4, 2, 0}, {1, 1, 1}, {0, 0.5f, -0.5f}, 0, 0).worldFromCamera);
  EXPECT_NEAR(glm::degrees(later.verticalFov), 50, 1e-4f);
  EXPECT_NEAR(later.apertureRadius, 0.25f, 1e-6f);
  expectSameFrame(cameraIn(scene, 9).worldFromCamera,
                  scene::lookAtCamera({4, 2, 0}, {1, 1, 1}, {0, 0, -1}, 0, 0).worldFromCamera);
  expectSameFrame(scene.cameras[0].worldFromCamera,
                  scene::lookAtCamera({0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 0, 0).worldFromCamera);
}

TEST(CameraKeyframes, KeepOrMoveTheFocus) {
  const std::string dolly = "keyframes = [{ time = 0 }, { time = 2, look_from = [0, 0, 8] }]\n";
  EXPECT_NEAR(cameraIn(viewer(dolly), 1).focusDistance, 6, 1e-5f);
  EXPECT_NEAR(cameraIn(viewer("focus = 3\n" + dolly), 1).focusDistance, 3, 1e-6f);
  const scene::Scene pull = viewer("keyframes = [{ time = 0 }, { time = 2, focus = 8 }]\n");
  EXPECT_NEAR(cameraIn(pull, 0).focusDistance, 4, 1e-6f);  // the distance of look_at
  EXPECT_NEAR(cameraIn(pull, 1).focusDistance, 6, 1e-6f);
  const scene::Scene zoom = parse(
      "[[camera]]\nlook_from = [0, 0, 4]\nlook_at = [0, 0, 0]\northographic = [4, 2]\n"
      "keyframes = [{ time = 0 }, { time = 2, orthographic = [8, 4] }]\n");
  EXPECT_EQ(cameraIn(zoom, 1).orthographicHalfSize, vec2(3, 1.5f));
  EXPECT_EQ(cameraIn(zoom, 1).aspect, 2);
}

TEST(CameraKeyframes, StayRigidWhereTheViewIsUndefined) {
  // The camera passes the point that it looks at, and then looks along `up`.
  const scene::Scene scene =
      viewer("keyframes = [{ time = 0 }, { time = 2, look_from = [0, 0, -4] }, { time = 4, look_from = [0, 4, 0] }]\n");
  for (const double time : {0.0, 0.9, 1.0, 1.1, 2.0, 4.0}) {
    const mat4 frame = cameraIn(scene, time).worldFromCamera;
    EXPECT_NEAR(glm::determinant(mat3(frame)), 1.0f, 1e-5f) << time;
    EXPECT_NEAR(frame[3].z, time < 2 ? 4 - 4 * time : 2 * time - 8, 1e-5) << time;
  }
  expectNear(vec3(cameraIn(scene, 1).worldFromCamera[2]), {0, 0, 1});
  expectNear(vec3(cameraIn(scene, 1.1).worldFromCamera[2]), {0, 0, -1});
}

// ---- Environment and instances ----

TEST(EnvironmentKeyframes, TurnAndFade) {
  const scene::Scene scene = parse(
      "[environment]\ncolor = [1, 2, 3]\nrotation = 10\n"
      "keyframes = [{ time = 0, intensity = 0 }, { time = 1, intensity = 4, rotation = 370 }]\n");
  EXPECT_EQ(scene.environment.intensity, 0);
  EXPECT_NEAR(environmentIn(scene, 0.25).intensity, 1, 1e-6f);
  EXPECT_NEAR(glm::degrees(environmentIn(scene, 0.25).rotation), 100, 1e-3f) << "a whole turn";
  EXPECT_EQ(environmentIn(scene, 2).intensity, 4);
}

TEST(InstanceKeyframes, AreStepsOrSplines) {
  const std::string quad = "[[mesh]]\nname = 'q'\nshape = 'quad'\n[[instance]]\nof = 'q'\n";
  const std::string keys =
      "keyframes = [{ time = 0 }, { time = 1, translate = [2, 0, 0], rotate = [0, 90, 0] },\n"
      "{ time = 3, translate = [2, 0, 6], rotate = [0, 180, 0], scale = 0.5 }]\n";
  const auto at = [&](const std::string& interpolation, double seconds) {
    const scene::Scene scene = parse(quad + interpolation + keys);
    return scene::worldFromObjectAt(scene.instances.at(0), poseOf(scene, seconds));
  };
  expectSameFrame(at("interpolation = 'step'\n", 0.9), mat4(1.0f));
  expectSameFrame(at("interpolation = 'step'\n", 2.9), at("", 1));
  const vec3 spline(at("interpolation = 'cubic'\n", 0.5)[3]);
  EXPECT_NEAR(spline.x, bezier(0, 2, 2, 2.0 / 3, 1, 0.5), 1e-5);
  EXPECT_NEAR(spline.z, bezier(0, 0, 0, 2, 1, 0.5), 1e-5);
  const mat4 mixed = at("interpolation = { translate = 'cubic' }\n", 0.5);
  EXPECT_NEAR(mixed[3].x, spline.x, 1e-6f);
  expectNear(vec3(mixed[0]), {std::sqrt(0.5f), 0, -std::sqrt(0.5f)});
  // A cubic rotation is one, passes the keyframes, and turns smoothly: it leaves 90 degrees as fast as it arrives.
  for (const double time : {0.0, 1.0, 3.0}) expectSameFrame(at("interpolation = 'cubic'\n", time), at("", time));
  const auto angle = [&](double time) {
    const vec3 x(at("interpolation = { rotate = 'cubic' }\n", time)[0]);
    return glm::degrees(std::atan2(-x.z, x.x));
  };
  EXPECT_NEAR((angle(1.0) - angle(0.99)) / (angle(1.01) - angle(1.0)), 1.0, 0.02);
  EXPECT_GT(angle(1.0) - angle(0.99), 0.3f);
  EXPECT_NEAR(glm::determinant(mat3(at("interpolation = { rotate = 'cubic' }\n", 0.3))), 1.0f, 1e-5f);
  const float least = glm::length(vec3(at("interpolation = { scale = 'cubic' }\n", 2.9)[0]));
  EXPECT_TRUE(least >= 0.5f && least < 0.6f) << least;
}

// ---- Materials ----

TEST(MaterialKeyframes, ChangeFactorsAndEmission) {
  const scene::Scene scene = parse(
      "[[material]]\nname = 'm'\nbase_color = [1, 0, 0]\nalpha = 0.5\nemissive = [1, 0.5, 0]\n"
      "interpolation = { roughness = 'step' }\n"
      "keyframes = [{ time = 0, emissive_strength = 0, roughness = 0.2 },\n"
      "{ time = 1, emissive_strength = 8, base_color = [0, 1, 0], roughness = 0.6, anisotropy_rotation = 90 },\n"
      "{ time = 2, transmission = 1, attenuation_color = [0.5, 0.5, 1] }]\n"
      "[[material]]\nname = 'still'\nlike = 'm'\n");
  const auto at = [&](double seconds) {
    const scene::AnimatedMaterial& animated = scene.nodeAnimation->materials.at(0);
    return scene::materialAt(scene.materials[0], animated.values, poseOf(scene, seconds));
  };
  ASSERT_EQ(scene.nodeAnimation->materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].emissive, vec3(0.0f)) << "at frame 0";
  expectNear(at(0.25).emissive, {2, 1, 0}, 1e-5f);
  expectNear(vec3(at(0.25).baseColor), {0.75f, 0.25f, 0});
  EXPECT_EQ(at(0.25).baseColor.a, 0.5f);
  EXPECT_EQ(at(0.9).roughness, 0.2f);
  EXPECT_EQ(at(1).roughness, 0.6f);
  EXPECT_NEAR(glm::degrees(at(0.5).anisotropyRotation), 45, 1e-4f);
  EXPECT_NEAR(at(1.5).transmission, 0.5f, 1e-6f);
  expectNear(at(9).attenuationColor, {0.5f, 0.5f, 1});
  EXPECT_EQ(scene.materials[1].emissive, vec3(1, 0.5f, 0)) << "a copy without keyframes";
  // The states decide which shaders the scene needs.
  ASSERT_EQ(scene.materialStates.size(), 2u);
  const auto ever = [&](auto condition) { return std::ranges::any_of(scene.materialStates[0], condition); };
  EXPECT_TRUE(ever([](const scene::Material& m) { return m.transmission > 0.0f; }));
  EXPECT_TRUE(ever([](const scene::Material& m) { return m.emissive == vec3(8, 4, 0); }));
  EXPECT_TRUE(scene.materialStates[1].empty());
}

// A lamp that is off at frame 0 still lights the scene, so that it gets no default environment.
TEST(MaterialKeyframes, LightTheSceneLater) {
  const std::string lamp = "[[material]]\nname = 'lamp'\nemissive = [1, 1, 1]\nemissive_strength = 0\n";
  const std::string quad = "[[mesh]]\nshape = 'quad'\nmaterial = 'lamp'\n";
  EXPECT_EQ(scene::ownLight(parse(lamp + quad)), scene::OwnLight::none);
  const std::string later = "keyframes = [{ time = 0 }, { time = 1, emissive_strength = 5 }]\n";
  EXPECT_EQ(scene::ownLight(parse(lamp + later + quad)), scene::OwnLight::emission);
}

// ---- Documentation ----

// The first TOML example of docs/scenes.md after "## Keyframes".
std::string documentedKeyframes() {
  const std::string page = readTextFile(QUINTET_SOURCE_ROOT "/docs/scenes.md");
  const std::string fence = "```toml\n";
  const std::size_t begin = page.find(fence, page.find("\n## Keyframes\n")) + fence.size();
  return page.substr(begin, page.find("```", begin) - begin);
}

TEST(SceneKeyframes, MoveAsTheDocumentationSays) {
  const scene::Scene scene = parse(documentedKeyframes());
  EXPECT_EQ(scene::lastFrame(scene), 3 * kRate);
  expectNear(vec3(cameraIn(scene, 1).worldFromCamera[3]), {3, 1, 3});
  EXPECT_NEAR(glm::degrees(cameraIn(scene, 1).verticalFov), 35, 1e-4f);
  expectNear(vec3(cameraIn(scene, 2.5).worldFromCamera[3]), {6, 1, 0});  // the pause
  EXPECT_EQ(lightIn(scene, 0.9).intensity, vec3(0.0f));
  EXPECT_EQ(lightIn(scene, 1.0).intensity, vec3(50.0f));
  const auto aim = [&](double x, double z) { return glm::normalize(vec3(x, -4, z)); };
  expectNear(lightIn(scene, 0).direction, aim(-2, 0));
  expectNear(lightIn(scene, 1).direction, aim(0, 1), 1e-5f);
  expectNear(lightIn(scene, 0.5).direction, aim(bezier(-2, 2, 0, 4.0 / 3, 1, 0.5), bezier(0, 1, 1, 0, 1, 0.5)), 1e-5f);
  expectNear(lightIn(scene, 3).direction, aim(2, 0), 1e-5f);
}

// ---- Report and errors ----

TEST(SceneKeyframes, AreInTheReport) {
  const scene::Scene scene = parse(
      "[[light]]\nname = 'lamp'\ntype = 'point'\nposition = [1, 2, 3]\ninterpolation = { intensity = 'step' }\n"
      "keyframes = [{ time = 1, position = [1, 2, 4] }, { time = 1.5, intensity = 3 }]\n"
      "[[camera]]\nlook_from = [0, 0, 4]\nlook_at = [0, 0, 0]\ninterpolation = 'cubic'\n"
      "keyframes = [{ frame = 48, look_at = [0, 1, 0] }]\n");
  const std::vector<scene::KeyframeSummary>& all = scene.report.keyframes;
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].object, "[[light]] 'lamp'");
  EXPECT_EQ(all[0].count, 2u);
  EXPECT_EQ(all[0].lastSeconds, 1.5);
  ASSERT_EQ(all[0].keys.size(), 2u);
  EXPECT_EQ(all[0].keys[0].name, "intensity");
  EXPECT_EQ(all[0].keys[0].interpolation, scene::Interpolation::step);
  EXPECT_EQ(all[0].keys[1].name, "position");
  EXPECT_EQ(all[1].firstSeconds, 2);
  ASSERT_EQ(all[1].keys.size(), 1u) << "not the keys that are animated with look_at";
  EXPECT_EQ(all[1].keys[0].name, "look_at");
}

TEST(SceneKeyframes, AreInTheHash) {
  const auto hash = [](const std::string& more) { return scene::contentHash(lamp(more)).hex(); };
  const std::string keys = "keyframes = [{ time = 0 }, { time = 2, intensity = 8 }]\n";
  EXPECT_NE(hash(keys), hash(""));
  EXPECT_NE(hash(keys), hash("interpolation = 'step'\n" + keys));
  EXPECT_EQ(hash(keys), hash("interpolation = 'linear'\n" + keys));
}

struct WrongKeyframes {
  const char* text;
  int line;  // after that of the table
  std::vector<std::string> words;
};

void expectErrors(const std::string& object, const std::vector<WrongKeyframes>& all) {
  const auto lines = static_cast<int>(std::ranges::count(object, '\n'));
  for (const WrongKeyframes& wrong : all) {
    const std::string message = errorOfToml(object + wrong.text);
    EXPECT_THAT(message, testing::StartsWith("test.scene.toml: line " + std::to_string(lines + wrong.line) + ": "));
    for (const std::string& word : wrong.words) EXPECT_THAT(message, HasSubstr(word)) << wrong.text;
  }
}

TEST(SceneKeyframes, ErrorsNameTheKeyAndTheLine) {
  expectErrors(
      "[[light]]\nname = 'lamp'\ntype = 'point'\nposition = [0, 0, 0]\n",
      {{"keyframes = 3\n", 1, {"'keyframes'", "[[light]] 'lamp'", "a list"}},
       {"keyframes = [{ time = 0 },\n{ intensity = 3 }]\n",
        2,
        {"keyframes[1] of [[light]] 'lamp'", "'time' or 'frame'"}},
       {"keyframes = [{ time = 1 },\n{ time = 0.5 }]\n",
        2,
        {"'time' of keyframes[1]", "0.5", "not after 1", "times must ascend"}},
       {"keyframes = [{ time = 1 },\n{ time = 1 }]\n", 2, {"'time' of keyframes[1]", "not after 1"}},
       {"keyframes = [{ time = 1 },\n{ time = 1.000000000001 }]\n", 2, {"'time' of keyframes[1]", "not after 1"}},
       {"keyframes = [{ frame = 3 },\n{ frame = 2 }]\n", 2, {"'frame' of keyframes[1]", "frames must ascend"}},
       {"keyframes = [{ time = 1, frame = 24 }]\n", 1, {"'time' and 'frame'", "keyframes[0]", "exclusive"}},
       {"keyframes = [{ time = 1 },\n{ frame = 48 }]\n", 2, {"'time' and 'frame'", "[[light]] 'lamp'", "exclusive"}},
       {"keyframes = [{ time = 3e38 }]\n", 1, {"'time' of keyframes[0]", "too large"}},
       {"keyframes = [{ time = nan }]\n", 1, {"'time'", "a number"}},
       {"keyframes = [{ time = 0, intensity = -1 }]\n", 1, {"'intensity' of keyframes[0]", "a number"}},
       {"keyframes = [{ time = 0, colr = [1, 1, 1] }]\n", 1, {"keyframes[0]", "'colr'", "'color'"}},
       {"keyframes = [{ time = 0, direction = [1, 1, 1] }]\n", 1, {"keyframes[0]", "'direction'"}},
       {"keyframes = [{ time = 0 },\n{ time = 1, range = 3 }]\n", 1, {"'range'", "keyframes[0]", "set it in"}},
       {"keyframes = [{ time = 0, intensity = 1e38, color = [9, 9, 9] }]\n",
        1,
        {"intensity", "keyframes[0]", "too large"}},
       {"interpolation = 'linear'\n", 1, {"'interpolation'", "'keyframes'"}},
       {"interpolation = 'bezier'\nkeyframes = [{ time = 0 }]\n", 1, {"'interpolation'", "'bezier'", "cubic"}},
       {"keyframes = [{ time = 0, intensity = 2 }]\ninterpolation = { intensity = 'smooth' }\n",
        2,
        {"'intensity'", "'smooth'"}},
       {"keyframes = [{ time = 0, intensity = 2 }]\ninterpolation = { position = 'step' }\n",
        2,
        {"'interpolation' of", "'position'"}},
       {"keyframes = [{ time = 0, intensity = 2, in_tangent = { intensity = 2 } }]\n",
        1,
        {"tangent", "'intensity'", "cubic"}},
       {"interpolation = 'cubic'\nkeyframes = [{ time = 0, intensity = 2, out_tangent = { color = [0, 0, 0] } },\n"
        "{ time = 1 }]\n",
        2,
        {"'out_tangent' of keyframes[0]", "'color'"}},
       {"interpolation = 'cubic'\nkeyframes = [{ time = 0 },\n{ time = 1, intensity = 2, in_tangent = { intensity = "
        "[1] } }]\n",
        3,
        {"'intensity'", "keyframes[1]", "a number"}},
       {"interpolation = 'cubic'\nkeyframes = [{ time = 0, position = [-3e38, 0, 0] },\n{ time = 1, position = [3e38, "
        "0, 0] }]\n",
        2,
        {"'position'", "changes too fast", "keyframes[0]"}}});
  expectErrors("[[light]]\ntype = 'spot'\nposition = [0, 0, 0]\ntarget = [0, 0, 1]\n",
               {{"keyframes = [{ time = 0, target = [0, 0, 0] }]\n", 1, {"'target' of keyframes[0]", "position"}},
                {"keyframes = [{ time = 0, position = [0, 0, 1] }]\n", 1, {"'target' of keyframes[0]", "position"}},
                {"keyframes = [{ time = 0, direction = [0, 0, 1] }]\n", 1, {"'direction'"}},
                {"keyframes = [{ time = 0, outer_angle = 95 }]\n", 1, {"'outer_angle' of keyframes[0]", "90"}}});
  expectErrors(
      "[[camera]]\nlook_from = [0, 0, 1]\nlook_at = [0, 0, 0]\n",
      {{"keyframes = [{ time = 0 },\n{ time = 1, look_at = [0, 0, 1] }]\n", 2, {"keyframes[1]", "camera position"}},
       {"keyframes = [{ time = 0, up = [0, 0, 0] }]\n", 1, {"keyframes[0]", "up"}},
       {"keyframes = [{ time = 0, fov = 180 }]\n", 1, {"'fov' of keyframes[0]", "180"}},
       {"keyframes = [{ time = 0, focus = 0 }]\n", 1, {"'focus' of keyframes[0]"}},
       {"keyframes = [{ time = 0, orthographic = [1, 1] }]\n", 1, {"'orthographic'"}}});
  expectErrors("[[material]]\nname = 'm'\n",
               {{"keyframes = [{ time = 0, roughness = 2 }]\n", 1, {"'roughness' of keyframes[0] of [[material]] 'm'"}},
                {"keyframes = [{ time = 0, unlit = true }]\n", 1, {"keyframes[0]", "'unlit'"}},
                {"keyframes = [{ time = 0, base_color_texture = 'a.png' }]\n", 1, {"'base_color_texture'"}},
                {"keyframes = [{ time = 0 },\n{ time = 1, attenuation_distance = 2 }]\n",
                 1,
                 {"'attenuation_distance'", "keyframes[0]"}}});
  expectErrors("[environment]\ncolor = [1, 1, 1]\n",
               {{"keyframes = [{ time = 0, intensity = -1 }]\n", 1, {"'intensity' of keyframes[0]", "[environment]"}},
                {"keyframes = [{ time = 0, color = [0, 0, 0] }]\n", 1, {"keyframes[0]", "'color'"}}});
  expectErrors(
      "[[mesh]]\nname = 'm'\nshape = 'quad'\n[[instance]]\nof = 'm'\n",
      {{"keyframes = [{ time = 0 },\n{ time = 0, translate = [1, 0, 0] }]\n",
        2,
        {"keyframes[1]", "[[instance]] ", "times must ascend"}},
       {"keyframes = [{}]\n", 1, {"keyframes[0] of [[instance]]", "'time' or 'frame'"}},
       {"keyframes = [{ time = 0, in_tangent = { translate = [1, 0, 0] } }]\n", 1, {"'in_tangent'", "'translate'"}}});
}

}  // namespace
}  // namespace quintet::test

// SPDX-License-Identifier: Apache-2.0
// Camera, image size and environment of a render, by the rules of docs/cli.md.
#include "job/view.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/file.h"
#include "io/exr/exr.h"
#include "scene/defaults/default_environment.h"
#include "scene/model/limits.h"
#include "temp_folder.h"

namespace quintet::job {
namespace {

// A triangle around the origin; cameras "a" (aspect 2) and "b" (orthographic).
scene::Scene makeScene() {
  scene::Scene scene;
  scene.name = "scene.glb";
  scene::Geometry triangle;
  triangle.positions = {{-1, -1, -1}, {1, -1, 0}, {0, 1, 1}};
  triangle.triangles = {{0, 1, 2}};
  triangle.material = 0;
  scene.materials.resize(1);
  scene.meshes.push_back({"triangle", {triangle}});
  scene.instances.push_back({"node", 0, mat4(1.0f)});
  scene::Camera a;
  a.name = "a";
  a.aspect = 2.0f;
  scene::Camera b;
  b.name = "b";
  b.orthographic = true;
  scene.cameras = {a, b};
  return scene;
}

vec3 eyeOf(const scene::Camera& camera) { return vec3(camera.worldFromCamera[3]); }
vec3 directionOf(const scene::Camera& camera) { return -vec3(camera.worldFromCamera[2]); }

void expectNear(const vec3& a, const vec3& b) {
  EXPECT_LT(glm::length(a - b), 1e-5f) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST(ChooseCamera, UsesTheFirstSpecified) {
  scene::Scene scene = makeScene();
  CameraRequest request;
  EXPECT_EQ(chooseCamera(scene, request, 0).description, "camera 0 'a'");
  request.name = "b";
  EXPECT_EQ(chooseCamera(scene, request, 0).description, "camera 1 'b'");
  request.name = "1";
  EXPECT_EQ(chooseCamera(scene, request, 0).description, "camera 1 'b'");
  for (const char* wrong : {"2", "-1", "c", "1x"}) {
    request.name = wrong;
    EXPECT_THROW(chooseCamera(scene, request, 0), UsageError) << wrong;
  }
  scene.cameras.clear();
  const CameraChoice automatic = chooseCamera(scene, {}, 0);
  EXPECT_EQ(automatic.description, "automatic");
  const vec3 toCenter = -eyeOf(automatic.camera);  // focused at the center of the scene
  EXPECT_NEAR(automatic.camera.focusDistance, glm::dot(toCenter, directionOf(automatic.camera)), 1e-4f);
  request.name = "0";
  EXPECT_THROW(chooseCamera(scene, request, 0), UsageError);
}

// Exporters name the node after the camera that users see, and the camera after its data.
TEST(ChooseCamera, UsesNamesOfNodes) {
  scene::Scene scene = makeScene();
  scene.cameras[0].nodeName = "Hero";
  scene.cameras[1].nodeName = "a";  // a name of a camera comes first
  scene.cameras.emplace_back().nodeName = "1";
  const auto indexOf = [&](const char* name) {
    CameraRequest request;
    request.name = name;
    const std::string text = chooseCamera(scene, request, 0).description;
    return text.substr(0, 8);
  };
  EXPECT_EQ(indexOf("Hero"), "camera 0");
  EXPECT_EQ(indexOf("a"), "camera 0");
  EXPECT_EQ(indexOf("1"), "camera 2");  // a name comes before an index
  EXPECT_EQ(indexOf("0"), "camera 0");
  const auto errorFor = [&](const char* name) -> std::string {
    try {
      indexOf(name);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(errorFor("Herp"),
            "camera 'Herp' not found in scene.glb (did you mean 'Hero'?); available: 0 'a' (node 'Hero'), 1 'b' (node "
            "'a'), 2 (node '1')");
  scene.cameras.resize(25);
  EXPECT_TRUE(errorFor("x").ends_with(", 19, and 5 more")) << errorFor("x");
}

TEST(ChooseCamera, LooksFromAndAt) {
  const scene::Scene scene = makeScene();
  CameraRequest request;
  request.lookFrom = vec3(1, 2, 3);
  request.lookAt = vec3(1, 2, -7);
  request.verticalFov = 60.0f;
  const scene::Camera camera = chooseCamera(scene, request, 0).camera;
  expectNear(eyeOf(camera), {1, 2, 3});
  expectNear(directionOf(camera), {0, 0, -1});
  EXPECT_FLOAT_EQ(camera.verticalFov, glm::radians(60.0f));
  EXPECT_FLOAT_EQ(camera.focusDistance, 10.0f);
  request.lookAt.reset();  // the center of the scene
  expectNear(directionOf(chooseCamera(scene, request, 0).camera), -glm::normalize(vec3(1, 2, 3)));
}

TEST(ChooseCamera, AcceptsAViewAlongTheUpVector) {
  CameraRequest request;
  request.lookFrom = vec3(0, 5, 0);
  request.lookAt = vec3(0);
  const scene::Camera camera = chooseCamera(makeScene(), request, 0).camera;
  expectNear(directionOf(camera), {0, -1, 0});
  EXPECT_TRUE(isFinite(vec3(camera.worldFromCamera[0])));
  request.up = vec3(0, 0, 3);
  EXPECT_TRUE(isFinite(vec3(chooseCamera(makeScene(), request, 0).camera.worldFromCamera[0])));
}

TEST(ChooseCamera, Lens) {
  scene::Scene scene = makeScene();
  scene.cameras[0].worldFromCamera[3] = vec4(0, 0, 4, 1);
  CameraRequest request;
  request.apertureRadius = 0.1f;
  scene::Camera camera = chooseCamera(scene, request, 0).camera;
  EXPECT_FLOAT_EQ(camera.apertureRadius, 0.1f);
  EXPECT_FLOAT_EQ(camera.focusDistance, 4.0f);  // the center of the scene
  request.focusDistance = 2.5f;
  EXPECT_FLOAT_EQ(chooseCamera(scene, request, 0).camera.focusDistance, 2.5f);
  request.name = "b";
  request.verticalFov = 30.0f;
  EXPECT_THROW(chooseCamera(scene, request, 0), UsageError);
}

// The center of the scene is 3 along the optical axis.
TEST(ChooseCamera, FocusesOnThePointThatItLooksAt) {
  const scene::Scene scene = makeScene();
  CameraRequest request;
  request.lookFrom = vec3(1, 2, 3);
  request.lookAt = vec3(1, 2, -7);
  request.apertureRadius = 0.1f;
  const scene::Camera camera = chooseCamera(scene, request, 0).camera;
  EXPECT_FLOAT_EQ(camera.apertureRadius, 0.1f);
  EXPECT_FLOAT_EQ(camera.focusDistance, 10.0f);
  request.focusDistance = 2.5f;
  EXPECT_FLOAT_EQ(chooseCamera(scene, request, 0).camera.focusDistance, 2.5f);
}

TEST(ChooseImageSize, FollowsTheAspect) {
  scene::Camera camera;
  EXPECT_EQ(chooseImageSize({0, 0}, camera), uvec2(1280, 720));
  EXPECT_EQ(chooseImageSize({640, 0}, camera), uvec2(640, 360));
  camera.aspect = 2.0f;
  EXPECT_EQ(chooseImageSize({0, 0}, camera), uvec2(1280, 640));
  EXPECT_EQ(chooseImageSize({300, 0}, camera), uvec2(300, 150));
  EXPECT_EQ(chooseImageSize({300, 17}, camera), uvec2(300, 17));
  camera.aspect = 0.5f;
  EXPECT_EQ(chooseImageSize({0, 0}, camera), uvec2(640, 1280));
  camera.aspect = 1e30f;
  EXPECT_EQ(chooseImageSize({1, 0}, camera), uvec2(1, 1));
}

TEST(ChooseEnvironment, UsesTheFirstSpecified) {
  scene::Scene scene = makeScene();
  EXPECT_TRUE(chooseEnvironment(scene, {}).isFallback());
  scene.lights.resize(1);  // behind the triangle
  EXPECT_TRUE(chooseEnvironment(scene, {}).isFallback());
  scene.lights[0].position = {0, 0, 5};
  scene.lights[0].intensity = vec3(100);
  EnvironmentChoice none = chooseEnvironment(scene, {});
  EXPECT_FALSE(none.isFallback());
  EXPECT_EQ(none.description, "none");
  EXPECT_TRUE(none.environment.image.empty());
  scene.environment.present = true;
  scene.environment.constant = vec3(1);
  EXPECT_EQ(chooseEnvironment(scene, {}).environment.constant, vec3(1));

  EnvironmentRequest request;
  request.source = "default";
  EXPECT_FALSE(chooseEnvironment(scene, request).environment.image.empty());
  request.source = "none";
  EXPECT_EQ(chooseEnvironment(scene, request).environment.constant, vec3(0));
  request.source = "0.5,1,2";
  request.intensity = 3.0f;
  request.rotation = 90.0f;
  const scene::Environment colored = chooseEnvironment(scene, request).environment;
  EXPECT_EQ(colored.constant, vec3(0.5f, 1, 2));
  EXPECT_FLOAT_EQ(colored.intensity, 3.0f);
  EXPECT_FLOAT_EQ(colored.rotation, kPi / 2);
  request.source = "no/such/sky.hdr";
  EXPECT_THROW(chooseEnvironment(scene, request), FileError);
}

TEST(ChooseEnvironment, ClampsTexelsThatAreNotFinite) {
  const quintet::test::TempFolder folder;
  io::ExrImage image{3, 2, {}};
  for (const char* name : {"R", "G", "B"})
    image.channels.push_back({name, io::ExrType::f32, std::vector<float>(6, 1.0f)});
  image.channels[0].samples[4] = std::numeric_limits<float>::infinity();
  writeFile(folder / "sky.exr", io::encodeExr(image));
  EnvironmentRequest request;
  request.source = folder / "sky.exr";
  const EnvironmentChoice chosen = chooseEnvironment(makeScene(), request);
  EXPECT_EQ(chosen.environment.image.pixel<float>(1, 1)[0], scene::kMaxRadiance);
  EXPECT_NE(chosen.repair.find("sky.exr: 1 pixel is NaN, infinite or above 1e+12"), std::string::npos) << chosen.repair;
  EXPECT_NE(chosen.repair.find("(1, 1)"), std::string::npos) << chosen.repair;
  request.source = "1e12,0,0";
  EXPECT_EQ(chooseEnvironment(makeScene(), request).repair, "");
  for (const char* wrong : {"1e13,0,0", "1,inf,1", "1,nan,1", "0,0,1e39"}) {
    request.source = wrong;
    EXPECT_THROW(chooseEnvironment(makeScene(), request), UsageError) << wrong;
  }
}

// The header states 192 MiB of pixels, which do not follow.
TEST(ChooseEnvironment, LimitsTheMemory) {
  const quintet::test::TempFolder folder;
  writeFile(folder / "sky.hdr", std::string_view("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4096 +X 4096\n"));
  EnvironmentRequest request;
  request.source = folder / "sky.hdr";
  EXPECT_THROW(chooseEnvironment(makeScene(), request, std::size_t{1} << 20), MemoryError);
}

}  // namespace
}  // namespace quintet::job

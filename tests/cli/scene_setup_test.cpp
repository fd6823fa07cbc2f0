// Which camera looks and what light surrounds the scene, by the rules of docs/cli.md.
#include "scene_setup.h"

#include <cmath>

#include <gtest/gtest.h>

#include "base/error.h"
#include "scene/default_environment.h"

namespace quintet::app {
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
vec3 wayOf(const scene::Camera& camera) { return -vec3(camera.worldFromCamera[2]); }

void expectNear(const vec3& a, const vec3& b) {
  EXPECT_LT(glm::length(a - b), 1e-5f) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST(ChooseCamera, TheFirstThatIsGiven) {
  scene::Scene scene = makeScene();
  CameraOptions options;
  EXPECT_EQ(chooseCamera(scene, options, 0).description, "camera 0 'a'");
  options.camera = "b";
  EXPECT_EQ(chooseCamera(scene, options, 0).description, "camera 1 'b'");
  options.camera = "1";
  EXPECT_EQ(chooseCamera(scene, options, 0).description, "camera 1 'b'");
  for (const char* wrong : {"2", "-1", "c", "1x"}) {
    options.camera = wrong;
    EXPECT_THROW(chooseCamera(scene, options, 0), UsageError) << wrong;
  }
  scene.cameras.clear();
  EXPECT_EQ(chooseCamera(scene, {}, 0).description, "automatic");
  options.camera = "0";
  EXPECT_THROW(chooseCamera(scene, options, 0), UsageError);
}

TEST(ChooseCamera, LookFromAndAt) {
  const scene::Scene scene = makeScene();
  CameraOptions options;
  options.lookFrom = vec3(1, 2, 3);
  options.lookAt = vec3(1, 2, -7);
  options.fov = 60.0f;
  const scene::Camera camera = chooseCamera(scene, options, 0).camera;
  expectNear(eyeOf(camera), {1, 2, 3});
  expectNear(wayOf(camera), {0, 0, -1});
  EXPECT_FLOAT_EQ(camera.verticalFov, glm::radians(60.0f));
  EXPECT_FLOAT_EQ(camera.focusDistance, 10.0f);
  options.lookAt.reset();  // the middle of the scene
  expectNear(wayOf(chooseCamera(scene, options, 0).camera), -glm::normalize(vec3(1, 2, 3)));
}

TEST(ChooseCamera, LookingAlongUpIsFine) {
  CameraOptions options;
  options.lookFrom = vec3(0, 5, 0);
  options.lookAt = vec3(0);
  const scene::Camera camera = chooseCamera(makeScene(), options, 0).camera;
  expectNear(wayOf(camera), {0, -1, 0});
  EXPECT_TRUE(isFinite(vec3(camera.worldFromCamera[0])));
  options.up = vec3(0, 0, 3);
  EXPECT_TRUE(isFinite(vec3(chooseCamera(makeScene(), options, 0).camera.worldFromCamera[0])));
}

TEST(ChooseCamera, Lens) {
  scene::Scene scene = makeScene();
  scene.cameras[0].worldFromCamera[3] = vec4(0, 0, 4, 1);
  CameraOptions options;
  options.aperture = 0.1f;
  scene::Camera camera = chooseCamera(scene, options, 0).camera;
  EXPECT_FLOAT_EQ(camera.apertureRadius, 0.1f);
  EXPECT_FLOAT_EQ(camera.focusDistance, 4.0f);  // the middle of the scene
  options.focus = 2.5f;
  EXPECT_FLOAT_EQ(chooseCamera(scene, options, 0).camera.focusDistance, 2.5f);
  options.camera = "b";
  options.fov = 30.0f;
  EXPECT_THROW(chooseCamera(scene, options, 0), UsageError);
}

TEST(ChooseSize, FollowsTheAspect) {
  scene::Camera camera;
  EXPECT_EQ(chooseSize({0, 0}, camera), uvec2(1280, 720));
  EXPECT_EQ(chooseSize({640, 0}, camera), uvec2(640, 360));
  camera.aspect = 2.0f;
  EXPECT_EQ(chooseSize({0, 0}, camera), uvec2(1280, 640));
  EXPECT_EQ(chooseSize({300, 0}, camera), uvec2(300, 150));
  EXPECT_EQ(chooseSize({300, 17}, camera), uvec2(300, 17));
  camera.aspect = 0.5f;
  EXPECT_EQ(chooseSize({0, 0}, camera), uvec2(640, 1280));
  camera.aspect = 1e30f;
  EXPECT_EQ(chooseSize({1, 0}, camera), uvec2(1, 1));
}

TEST(GivesLight, LightsAndVisibleEmission) {
  scene::Scene scene = makeScene();
  EXPECT_FALSE(scene::givesLight(scene));
  scene.materials[0].emissive = vec3(0, 1, 0);
  EXPECT_TRUE(scene::givesLight(scene));
  scene.instances.clear();
  EXPECT_FALSE(scene::givesLight(scene));
  scene.lights.resize(1);
  EXPECT_TRUE(scene::givesLight(scene));
}

TEST(ChooseEnvironment, TheFirstThatIsGiven) {
  scene::Scene scene = makeScene();
  EXPECT_TRUE(chooseEnvironment(scene, {}).isDefault);
  scene.lights.resize(1);
  ChosenEnvironment none = chooseEnvironment(scene, {});
  EXPECT_FALSE(none.isDefault);
  EXPECT_EQ(none.description, "none");
  EXPECT_TRUE(none.environment.image.empty());
  scene.environment.present = true;
  scene.environment.constant = vec3(1);
  EXPECT_EQ(chooseEnvironment(scene, {}).environment.constant, vec3(1));

  EnvironmentOptions options;
  options.source = "default";
  EXPECT_FALSE(chooseEnvironment(scene, options).environment.image.empty());
  options.source = "none";
  EXPECT_EQ(chooseEnvironment(scene, options).environment.constant, vec3(0));
  options.source = "0.5,1,2";
  options.intensity = 3.0f;
  options.rotation = 90.0f;
  const scene::Environment colored = chooseEnvironment(scene, options).environment;
  EXPECT_EQ(colored.constant, vec3(0.5f, 1, 2));
  EXPECT_FLOAT_EQ(colored.intensity, 3.0f);
  EXPECT_FLOAT_EQ(colored.rotation, kPi / 2);
  options.source = "no/such/sky.hdr";
  EXPECT_THROW(chooseEnvironment(scene, options), FileError);
}

}  // namespace
}  // namespace quintet::app

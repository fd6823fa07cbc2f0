// SPDX-License-Identifier: Apache-2.0
// Animations of glTF files that a scene file contains ([[file]]).
#include <gmock/gmock.h>

#include "base/error.h"
#include "base/file.h"
#include "scene/animation/pose.h"
#include "scene/gltf_animation.h"
#include "scene/load.h"
#include "scene/model/content_hash.h"
#include "scene/model/validate.h"

namespace quintet::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// Two files: a strip with a skin, and a triangle with a material, a light and a camera, which move.
class FileAnimation : public testing::Test {
 protected:
  FileAnimation() {
    strip_ = bendingStrip();
    triangle_ = movingTriangle();
    triangle_.addAnimation("Walk");
    triangle_.addChannel(1, "translation", {0, 1}, {0, 0, 0, 4, 0, 0});
    triangle_.add("materials", {{"name", "M"}});
    triangle_.primitive()["material"] = 0;
    triangle_.root["extensionsUsed"] = {"KHR_lights_punctual"};
    triangle_.root["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({{{"type", "point"}}});
    triangle_.root["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    triangle_.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
    triangle_.root["nodes"][0]["camera"] = 0;
    triangle_.addPointer("/materials/0/pbrMetallicRoughness/roughnessFactor", {0, 1}, {0, 1}, "SCALAR");
    triangle_.addPointer("/extensions/KHR_lights_punctual/lights/0/intensity", {0, 1}, {2, 4}, "SCALAR");
    triangle_.addPointer("/cameras/0/perspective/yfov", {0, 1}, {0.5f, 1}, "SCALAR");
    triangle_.addPointer("/nodes/0/extensions/KHR_node_visibility/visible", {0, 0.75f}, {1, 0}, "SCALAR", "STEP");
    triangle_.addAnimation("Jump");
    triangle_.addChannel(1, "translation", {0, 0.5f}, {0, 0, 0, 0, 4, 0});
    writeFile(folder_ / "strip.glb", strip_.glb());
    writeFile(folder_ / "triangle.glb", triangle_.glb());
  }
  scene::Scene load(const std::string& text, const std::optional<std::string>& animation = "") const {
    writeFile(folder_ / "x.scene.toml", text);
    return scene::loadScene(folder_ / "x.scene.toml", {.animation = animation});
  }
  static scene::Scene posed(scene::Scene scene, double frame) {
    scene::applyPose(scene, scene::poseAt(scene.nodeAnimation.get(), frame), scene::Hidden::keep);
    return scene;
  }
  static void expectSame(const mat4& a, const mat4& b) {
    for (glm::length_t c = 0; c < 4; ++c) EXPECT_LT(glm::distance(a[c], b[c]), 1e-5f);
  }

  const TempFolder folder_;
  AnimationBuilder strip_, triangle_;
  const std::string both_ = "[[file]]\nname = 's'\npath = 'strip.glb'\n[[file]]\nname = 't'\npath = 'triangle.glb'\n";
};

TEST_F(FileAnimation, PlaysAsInTheFilesAlone) {
  const scene::Scene scene = load(both_);
  EXPECT_EQ(scene.report.ignoredAnimations, 0u);
  EXPECT_EQ(scene::lastFrame(scene), 24);
  for (const double frame : {0.0, 6.0, 18.0}) {
    const scene::Scene together = posed(scene, frame);
    const scene::Scene strip = posed(strip_.loadAnimated(), frame), triangle = posed(triangle_.loadAnimated(), frame);
    ASSERT_EQ(together.instances.size(), 2u);
    EXPECT_EQ(together.meshes[0].geometries[0].positions, strip.meshes[0].geometries[0].positions);
    expectSame(together.instances[1].worldFromObject, triangle.instances[0].worldFromObject);
    EXPECT_EQ(together.materials.back().roughness, triangle.materials[0].roughness);
    EXPECT_EQ(together.lights[0].intensity, triangle.lights[0].intensity);
    EXPECT_EQ(together.lights[0].position, triangle.lights[0].position);
    EXPECT_EQ(together.cameras[0].verticalFov, triangle.cameras[0].verticalFov);
    expectSame(together.cameras[0].worldFromCamera, triangle.cameras[0].worldFromCamera);
  }
  EXPECT_EQ(
      glm::determinant(mat3(scene::shownTransformAt(scene.instances[1], scene::poseAt(scene.nodeAnimation.get(), 20)))),
      0.0f)
      << "hidden";
}

TEST_F(FileAnimation, FollowsThePlacement) {
  const scene::Scene scene = load(both_ + R"(
[[instance]]
of = "t"
translate = [0, 10, 0]
rotate = [0, 0, 90]
[[instance]]
of = "t"
keyframes = [{ frame = 0 }, { frame = 24, translate = [0, 0, 2] }]
[[instance]]
of = "s"
translate = [5, 0, 0]
)");
  ASSERT_EQ(scene.instances.size(), 3u);
  const scene::Scene middle = posed(scene, 12);
  // The file alone is 3 m to the right at this frame.
  const vec3 turned(middle.instances[0].worldFromObject[3]), keyed(middle.instances[1].worldFromObject[3]);
  const vec3 file(posed(triangle_.loadAnimated(), 12).instances[0].worldFromObject[3]);
  EXPECT_LT(glm::distance(turned, vec3(-file.y, 10 + file.x, file.z)), 1e-5f);
  EXPECT_LT(glm::distance(keyed, file + vec3(0, 0, 1)), 1e-5f);
  EXPECT_LT(glm::distance(middle.lights[0].position, turned), 1e-5f);
  EXPECT_EQ(middle.instances[2].worldFromObject[3].x, 5);
  EXPECT_NO_THROW(scene::validate(middle));
}

TEST_F(FileAnimation, PlaysWithKeyframesOfTheSceneFile) {
  const scene::Scene scene = load(both_ + R"(
[[light]]
type = "point"
position = [0, 0, 0]
keyframes = [{ time = 0, intensity = 1 }, { time = 2, intensity = 5 }]
[[camera]]
look_from = [0, 0, 8]
look_at = [0, 0, 0]
keyframes = [{ time = 0 }, { time = 2, look_from = [0, 0, 4] }]
)");
  EXPECT_EQ(scene::lastFrame(scene), 48);
  ASSERT_EQ(scene.lights.size(), 2u);
  ASSERT_EQ(scene.cameras.size(), 2u);
  const scene::Scene later = posed(scene, 18), triangle = posed(triangle_.loadAnimated(), 18);
  EXPECT_EQ(later.lights[0].intensity, triangle.lights[0].intensity);
  EXPECT_EQ(later.lights[0].position, triangle.lights[0].position);
  EXPECT_NEAR(later.lights[1].intensity.x, 2.5f, 1e-6f);
  EXPECT_NEAR(later.cameras[0].worldFromCamera[3].z, 6.5f, 1e-5f);
  EXPECT_EQ(later.cameras[1].verticalFov, triangle.cameras[0].verticalFov);
  EXPECT_EQ(later.materials.back().roughness, triangle.materials[0].roughness);
  expectSame(later.instances[1].worldFromObject, triangle.instances[0].worldFromObject);
  // Keyframes play although the animations do not.
  const scene::Scene rest = load(
      "[[file]]\nname = 't'\npath = 'triangle.glb'\n[[light]]\ntype = 'point'\n"
      "position = [0, 0, 0]\nkeyframes = [{ time = 0, intensity = 0 }, { time = 1, intensity = 1 }]\n",
      std::nullopt);
  EXPECT_NEAR(posed(rest, 12).lights[1].intensity.x, 0.5f, 1e-6f);
  expectSame(posed(rest, 12).instances[0].worldFromObject, rest.instances[0].worldFromObject);
}

TEST_F(FileAnimation, IsChosenPerFile) {
  const std::string file = "[[file]]\nname = 't'\npath = 'triangle.glb'\n";
  const auto heightAt = [&](const std::string& text) {
    return posed(load(text), 12).instances[0].worldFromObject[3].y;
  };
  EXPECT_EQ(heightAt(file), 0);
  EXPECT_EQ(heightAt(file + "animation = 'Jump'\n"), 4);
  EXPECT_EQ(heightAt(file + "animation = '1'\n"), 4);
  EXPECT_EQ(load(file + "animation = 'none'\n").nodeAnimation, nullptr);
  EXPECT_EQ(load(file, std::nullopt).nodeAnimation, nullptr) << "the scene does not play";
  EXPECT_THAT(load(file, std::nullopt).report.ignored,
              ElementsAre(HasSubstr("t: /animations: 2 not played; the rest pose is used")));
  try {
    load(file + "animation = 'Jum'\n");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("x.scene.toml: line 4"));
    EXPECT_THAT(error.problem(), HasSubstr("no animation 'Jum'"));
  }
}

}  // namespace
}  // namespace quintet::test

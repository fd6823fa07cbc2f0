// SPDX-License-Identifier: Apache-2.0
// The command that renders the image of the window. tests/window runs one.
#include "reproduce.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace quintet::viewer {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

Snapshot snapshotOf(const std::string& scene, const std::string& program) {
  Snapshot snapshot;
  snapshot.phase = Snapshot::Phase::ready;
  auto request = std::make_shared<job::interactive::SessionRequest>();
  request->render.scene = scene;
  snapshot.request = request;
  auto description = std::make_shared<program::Program>();
  description->outputs = {{.name = "color"}, {.name = "albedo"}};
  snapshot.program = description;
  auto outline = std::make_shared<SceneOutline>();
  outline->materialNames = {"Gold"};
  outline->materials.resize(1);
  outline->lightNames = {"Lamp"};
  outline->lights.resize(1);
  outline->instances.resize(1);
  outline->instances[0].name = "it's";
  snapshot.scene = outline;
  snapshot.state.program = program;
  snapshot.state.output = "color";
  snapshot.state.size = {640, 480};
  snapshot.state.samples = 16;
  return snapshot;
}

TEST(ReproducingCommand, IsARenderOfTheScene) {
  EXPECT_EQ(reproducingCommand(snapshotOf("a b.glb", "pathtracer")),
            "quintet render 'a b.glb' -o image.png --size 640x480 --spp 16");
  EXPECT_EQ(reproducingCommand(snapshotOf("a.glb", "ao")),
            "quintet render a.glb -o image.png --program ao --size 640x480 --spp 16");
}

TEST(ReproducingCommand, IsARunOfAProgramOnItsOwnScene) {
  EXPECT_EQ(reproducingCommand(snapshotOf("", "lessons/05_shadow")),
            "quintet run lessons/05_shadow -o image.png --size 640x480 --spp 16");
  Snapshot output = snapshotOf("a.glb", "pathtracer");
  output.state.output = "albedo";
  output.state.frame = 7;
  EXPECT_EQ(reproducingCommand(output),
            "quintet run pathtracer a.glb -o image.png --output albedo --frame 7 --size 640x480 --spp 16");
}

// What a new process gets after a hang.
TEST(ViewArguments, OpenTheSceneAgain) {
  Snapshot snapshot = snapshotOf("a.glb", "broken.rt.glsl");
  snapshot.state.assignments = {"depth=3"};
  EXPECT_EQ(viewArguments(snapshot, /*fixedSize=*/false),
            (std::vector<std::string>{"a.glb", "--program", "broken.rt.glsl", "--spp", "16", "--set", "depth=3"}));
  EXPECT_EQ(viewArguments(snapshot, /*fixedSize=*/true)[3], "--size");
  snapshot.program = nullptr;  // it was never shown
  auto request = std::make_shared<job::interactive::SessionRequest>();
  request->program = "other.rt.glsl";
  request->render.limits.samples = 8;
  snapshot.request = request;
  EXPECT_EQ(viewArguments(snapshot, false), (std::vector<std::string>{"--program", "other.rt.glsl", "--spp", "8"}));
}

TEST(ReproducingCommand, HasAllOptionsOfTheState) {
  Snapshot snapshot = snapshotOf("a.glb", "pathtracer");
  auto request = *snapshot.request;
  request.render.seed = 3;
  request.render.transparent = true;
  snapshot.request = std::make_shared<job::interactive::SessionRequest>(request);
  snapshot.state.camera = {.lookFrom = vec3(1, 2.5f, -3),
                           .lookAt = vec3(0.1f, 0, 0),
                           .up = {0, 0, 1},
                           .verticalFov = 35.0f,
                           .apertureRadius = 0.01f,
                           .focusDistance = 2.0f};
  snapshot.state.environment = {.source = "sky.hdr", .intensity = 2.0f, .rotation = 90.0f};
  snapshot.state.assignments = {"bounces=3", "name=a b"};
  snapshot.state.exposure = -0.5;
  snapshot.state.toneMap = render::ToneMap::agx;
  EXPECT_EQ(reproducingCommand(snapshot),
            "quintet render a.glb -o image.png --size 640x480 --spp 16 --seed 3 --transparent --look-from 1,2.5,-3 "
            "--look-at 0.100000001,0,0 --up 0,0,1 --fov 35 --aperture 0.00999999978 --focus 2 --env sky.hdr "
            "--env-intensity 2 --env-rotation 90 --set bounces=3 --set 'name=a b' --exposure -0.5 --tonemap agx");
  snapshot.state.environmentOn = false;
  EXPECT_THAT(reproducingCommand(snapshot), HasSubstr("--env none"));
  snapshot.state.camera = {.name = "front"};
  EXPECT_THAT(reproducingCommand(snapshot), HasSubstr("--camera front"));
}

TEST(ReproducingCommand, EditsTheSceneByAScript) {
  Snapshot snapshot = snapshotOf("a.glb", "pathtracer");
  scene::Material gold = snapshot.scene->materials[0];
  gold.roughness = 0.25f;
  gold.doubleSided = true;
  snapshot.state.materials[0] = std::make_shared<scene::Material>(gold);
  mat4 moved(1.0f);
  moved[3] = {1, 2, 3, 1};
  snapshot.state.transforms[0] = moved;
  snapshot.state.exposure = 1;
  const std::string command = reproducingCommand(snapshot);
  EXPECT_THAT(command, StartsWith("printf '%s\\n' '{\"do\":\"material\",\"name\":\"Gold\",\"roughness\":0.25,"
                                  "\"doubleSided\":1.0}'"));
  EXPECT_THAT(command, Not(HasSubstr("metallic"))) << "only what differs";
  EXPECT_THAT(command, HasSubstr("\"matrix\":[1.0,0.0,0.0,1.0,0.0,1.0,0.0,2.0,0.0,0.0,1.0,3.0]"));
  EXPECT_THAT(command, HasSubstr("it'\\''s")) << "quoted for the shell";
  EXPECT_THAT(command, HasSubstr("{\"do\":\"exposure\",\"stops\":1.0}"));
  EXPECT_THAT(command,
              HasSubstr("{\"do\":\"save\",\"file\":\"image.png\"}' | quintet view a.glb --program pathtracer"));
  EXPECT_THAT(command, testing::EndsWith("--script -"));
}

TEST(ExplainingCommand, ExplainsThePixelOfTheState) {
  EXPECT_EQ(explainingCommand(snapshotOf("a.glb", "pathtracer"), {3, 4}, 0),
            "quintet explain-pixel a.glb --pixel 3,4 --size 640x480 --spp 16");
  Snapshot snapshot = snapshotOf("", "lessons/05_shadow");
  snapshot.state.frame = 2;
  EXPECT_EQ(
      explainingCommand(snapshot, {3, 4}, 5),
      "quintet explain-pixel --pixel 3,4 --sample 5 --program lessons/05_shadow --frame 2 --size 640x480 --spp 16");
  snapshot.state.transforms[0] = mat4(2.0f);
  EXPECT_THAT(explainingCommand(snapshot, {3, 4}, 5),
              HasSubstr("{\"do\":\"explain\",\"x\":3,\"y\":4,\"sample\":5,\"file\":\"pixel.json\"}' | quintet view "
                        "--program lessons/05_shadow"));
}

TEST(ReproducingCommand, EditsLightsByAScript) {
  Snapshot snapshot = snapshotOf("a.glb", "pathtracer");
  auto lamp = std::make_shared<job::interactive::LightState>();
  lamp->light = snapshot.scene->lights[0];
  lamp->light.intensity = {0, 5, 10};
  lamp->on = false;
  snapshot.state.lights[0] = lamp;
  const std::string command = reproducingCommand(snapshot);
  EXPECT_THAT(command, HasSubstr("{\"do\":\"light\",\"name\":\"Lamp\",\"on\":false"));
  EXPECT_THAT(command, HasSubstr("\"intensity\":10.0"));
  EXPECT_THAT(command, HasSubstr("\"color\":[0.0,0.5,1.0]"));
}

}  // namespace
}  // namespace quintet::viewer

// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/session.h"

#include <gmock/gmock.h>

namespace quintet::job::interactive {
namespace {

TEST(SessionRequest, GetsTheStateAndKeepsTheRest) {
  SessionRequest request;
  request.render.scene = "a.glb";
  request.render.load.variant = "night";
  request.render.seed = 3;
  SessionState state;
  state.program = "ao";
  state.parameterFile = "p.json";
  state.assignments = {"radius=2"};
  state.camera.lookFrom = vec3(1, 2, 3);
  state.environment = {.source = "sky.hdr", .intensity = 2.0f};
  state.size = {64, 32};
  state.samples = 5;
  const SessionRequest next = withState(request, state);
  EXPECT_EQ(next.program, "ao");
  EXPECT_EQ(next.render.scene, "a.glb");
  EXPECT_EQ(next.render.load.variant, "night");
  EXPECT_EQ(next.render.seed, 3u);
  EXPECT_EQ(next.render.parameterFile, "p.json");
  EXPECT_THAT(next.render.assignments, testing::ElementsAre("radius=2"));
  EXPECT_EQ(next.render.camera, state.camera);
  EXPECT_EQ(next.render.environment, state.environment);
  EXPECT_EQ(next.render.size, state.size);
  EXPECT_EQ(next.render.limits.samples, 5u);
}

TEST(SessionRequest, HasNoEnvironmentIfItIsOff) {
  SessionState state;
  state.environment = {.source = "sky.hdr", .rotation = 30.0f};
  state.environmentOn = false;
  EXPECT_EQ(withState({}, state).render.environment.source, "none");
}

}  // namespace
}  // namespace quintet::job::interactive

// SPDX-License-Identifier: Apache-2.0
#include "viewer/navigation.h"

#include <cmath>
#include <variant>

#include <gtest/gtest.h>

namespace quintet::viewer {
namespace {

namespace interactive = job::interactive;

TEST(Navigation, FitsTheImageIntoItsArea) {
  const overlay::ImagePlacement wide = overlay::fitImage({200, 100}, {10, 20}, {100, 100}, 8.0f);
  EXPECT_FLOAT_EQ(wide.scale, 0.5f);
  EXPECT_EQ(wide.origin, vec2(10, 45));
  const overlay::ImagePlacement tall = overlay::fitImage({100, 200}, {0, 0}, {400, 400}, 8.0f);
  EXPECT_FLOAT_EQ(tall.scale, 2.0f);
  EXPECT_EQ(tall.origin, vec2(100, 0));
  const overlay::ImagePlacement limited = overlay::fitImage({101, 100}, {0, 0}, {400, 400}, 1.0f);
  EXPECT_FLOAT_EQ(limited.scale, 1.0f);
  EXPECT_EQ(limited.origin, vec2(149, 150)) << "whole pixels, so that the image stays sharp";
}

TEST(Navigation, SurvivesAreasWithoutPixels) {
  EXPECT_GT(overlay::fitImage({200, 100}, {0, 0}, {0, 0}, 8.0f).scale, 0.0f);
  EXPECT_EQ(overlay::fitImage({0, 0}, {0, 0}, {100, 100}, 8.0f).size, uvec2(0));
}

TEST(Navigation, FindsThePixelBelowAPosition) {
  const overlay::ImagePlacement placement = overlay::fitImage({200, 100}, {10, 20}, {100, 100}, 8.0f);
  EXPECT_EQ(placement.pixelAt({10, 45}), uvec2(0, 0));
  EXPECT_EQ(placement.pixelAt({109.9f, 94.9f}), uvec2(199, 99));
  EXPECT_EQ(placement.pixelAt({9.9f, 50}), std::nullopt);
  EXPECT_EQ(placement.pixelAt({50, 95}), std::nullopt);
  EXPECT_EQ(placement.pixelAt({110, 50}), std::nullopt);
}

TEST(Navigation, DragsTheSceneWithThePointer) {
  const overlay::ImagePlacement placement = overlay::fitImage({200, 100}, {0, 0}, {100, 50}, 8.0f);  // scale 0.5
  // To the right: the scene turns to the right, so the camera moves to the left. Down: the camera moves up.
  const auto orbit = std::get<interactive::Orbit>(dragCommand(Drag::orbit, {10, 20}, {0, 0}, placement));
  EXPECT_LT(orbit.right, 0.0f);
  EXPECT_GT(orbit.up, 0.0f);
  EXPECT_FLOAT_EQ(orbit.up, -2.0f * orbit.right);
  // The scene stays below the pointer: twice as many pixels of the image.
  const auto pan = std::get<interactive::Pan>(dragCommand(Drag::pan, {10, -4}, {0, 0}, placement));
  EXPECT_EQ(pan.pixels, vec2(20, -8));
  // Up moves closer to where the drag began.
  const auto zoom = std::get<interactive::Zoom>(dragCommand(Drag::zoom, {0, -10}, {30, 20}, placement));
  EXPECT_GT(zoom.factor, 1.0f);
  EXPECT_EQ(zoom.pixel, vec2(60, 40));
  const auto back = std::get<interactive::Zoom>(dragCommand(Drag::zoom, {0, 10}, {30, 20}, placement));
  EXPECT_FLOAT_EQ(zoom.factor * back.factor, 1.0f);
  // To the right: the camera turns to the right, which is a negative yaw.
  const auto look = std::get<interactive::Fly>(dragCommand(Drag::look, {10, 0}, {0, 0}, placement));
  EXPECT_LT(look.yaw, 0.0f);
  EXPECT_EQ(look.meters, vec3(0.0f));
}

TEST(Navigation, ZoomsToThePointerWithTheWheel) {
  const overlay::ImagePlacement placement = overlay::fitImage({200, 100}, {0, 0}, {100, 50}, 8.0f);
  const auto closer = std::get<interactive::Zoom>(wheelCommand(2.0f, {10, 5}, placement));
  const auto away = std::get<interactive::Zoom>(wheelCommand(-2.0f, {10, 5}, placement));
  EXPECT_GT(closer.factor, 1.0f);
  EXPECT_FLOAT_EQ(closer.factor * away.factor, 1.0f);
  EXPECT_EQ(closer.pixel, vec2(20, 10));
}

TEST(Navigation, FliesAtASpeedThatFitsTheScene) {
  const auto command = flyCommand({Fly::forward}, 0.5, 8.0f, false);
  ASSERT_TRUE(command);
  const vec3 meters = std::get<interactive::Fly>(*command).meters;
  EXPECT_EQ(meters, vec3(0, 0, 1)) << "8 m in 4 s";
  const auto fast = flyCommand({Fly::left}, 0.5, 8.0f, true);
  EXPECT_EQ(std::get<interactive::Fly>(*fast).meters, vec3(-4, 0, 0));
  const auto diagonal = flyCommand({Fly::right, Fly::up}, 0.5, 8.0f, false);
  EXPECT_NEAR(glm::length(std::get<interactive::Fly>(*diagonal).meters), 1.0f, 1e-6f) << "not faster";
  EXPECT_FALSE(flyCommand({Fly::forward, Fly::backward}, 0.5, 8.0f, false));
  EXPECT_FALSE(flyCommand({}, 0.5, 8.0f, false));
}

}  // namespace
}  // namespace quintet::viewer

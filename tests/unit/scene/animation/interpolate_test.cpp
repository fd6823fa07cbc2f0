// SPDX-License-Identifier: Apache-2.0
// Samplers: step, linear and cubic spline, for vectors and rotations, between, before and after their times.
#include "scene/animation/interpolate.h"

#include <gtest/gtest.h>

#include <array>

namespace quintet::test {
namespace {

using scene::AnimationSampler;
using scene::Interpolation;

float at(const AnimationSampler& sampler, double seconds) {
  std::array<float, 1> value{};
  scene::interpolate(sampler, seconds, value);
  return value[0];
}

double degreesAboutZ(const glm::dquat& q) { return glm::degrees(2.0 * std::atan2(q.z, q.w)); }

// x, y, z, w
std::array<float, 4> aboutZ(double degrees) {
  const double half = glm::radians(0.5 * degrees);
  return {0.0f, 0.0f, static_cast<float>(std::sin(half)), static_cast<float>(std::cos(half))};
}

TEST(Interpolate, StepKeepsTheLastValue) {
  const AnimationSampler sampler{Interpolation::step, {1, 2, 4}, {10, 20, 40}, 1};
  EXPECT_EQ(at(sampler, 0.0), 10);
  EXPECT_EQ(at(sampler, 1.999), 10);
  EXPECT_EQ(at(sampler, 2.0), 20) << "the value of a time begins at it";
  EXPECT_EQ(at(sampler, 3.9), 20);
  EXPECT_EQ(at(sampler, 9.0), 40);
}

TEST(Interpolate, LinearIsClampedToItsTimes) {
  const AnimationSampler sampler{Interpolation::linear, {1, 2, 4}, {10, 20, 40}, 1};
  EXPECT_EQ(at(sampler, -5.0), 10);
  EXPECT_EQ(at(sampler, 1.0), 10);
  EXPECT_FLOAT_EQ(at(sampler, 1.25), 12.5f);
  EXPECT_FLOAT_EQ(at(sampler, 3.0), 30);
  EXPECT_EQ(at(sampler, 4.0), 40);
  EXPECT_EQ(at(sampler, 5.0), 40);
}

TEST(Interpolate, OneTimeIsConstant) {
  for (const Interpolation kind : {Interpolation::step, Interpolation::linear})
    for (const double seconds : {0.0, 1.0, 2.0}) EXPECT_EQ(at({kind, {1}, {7}, 1}, seconds), 7);
}

// A frame number divided by the rate meets a time that is stored as a float.
TEST(Interpolate, TimesAreComparedAsFloats) {
  const AnimationSampler sampler{Interpolation::step, {0, 0.1f, 0.7f}, {0, 1, 2}, 1};
  EXPECT_EQ(at(sampler, 0.1), 1);
  EXPECT_EQ(at(sampler, 21.0 / 30.0), 2);
}

// The Hermite spline reproduces a cubic polynomial, whose derivatives are its tangents.
TEST(Interpolate, CubicSplineReproducesAPolynomial) {
  const auto value = [](double t) { return 2.0 - t + 0.5 * t * t + 0.25 * t * t * t; };
  const auto slope = [](double t) { return -1.0 + t + 0.75 * t * t; };
  AnimationSampler sampler{Interpolation::cubicSpline, {0, 2, 5}, {}, 1};
  for (const float t : sampler.times)
    for (const double v : {slope(t), value(t), slope(t)}) sampler.values.push_back(static_cast<float>(v));
  for (const double t : {0.0, 0.5, 1.9, 2.0, 3.5, 4.99, 5.0}) EXPECT_NEAR(at(sampler, t), value(t), 1e-4) << t;
  EXPECT_NEAR(at(sampler, 6.0), value(5.0), 1e-4) << "constant after the last time";
}

TEST(Interpolate, CubicSplineUsesEachTangentOnItsSide) {
  // In-tangents of 100 at the first and out-tangents of 100 at the last time must have no effect.
  const AnimationSampler sampler{Interpolation::cubicSpline, {0, 1}, {100, 1, 0, 0, 1, 100}, 1};
  for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) EXPECT_NEAR(at(sampler, t), 1.0, 1e-6) << t;
}

TEST(Interpolate, VectorsComponentByComponent) {
  const AnimationSampler sampler{Interpolation::linear, {0, 1}, {0, 1, 2, 10, 11, 12}, 3};
  std::array<float, 3> value{};
  scene::interpolate(sampler, 0.5, value);
  EXPECT_EQ(value, (std::array<float, 3>{5, 6, 7}));
}

AnimationSampler rotations(Interpolation interpolation, const std::vector<double>& degrees) {
  AnimationSampler sampler{interpolation, {}, {}, 4};
  for (std::size_t i = 0; i < degrees.size(); ++i) {
    sampler.times.push_back(static_cast<float>(i));
    const std::array<float, 4> q = aboutZ(degrees[i]);
    const std::array<float, 4> none{};
    if (interpolation == Interpolation::cubicSpline)
      sampler.values.insert(sampler.values.end(), none.begin(), none.end());
    sampler.values.insert(sampler.values.end(), q.begin(), q.end());
    if (interpolation == Interpolation::cubicSpline)
      sampler.values.insert(sampler.values.end(), none.begin(), none.end());
  }
  return sampler;
}

TEST(Interpolate, RotationsAreSpherical) {
  const AnimationSampler sampler = rotations(Interpolation::linear, {0, 100});
  for (const double t : {0.0, 0.2, 0.5, 1.0})  // equal steps of time are equal angles
    EXPECT_NEAR(degreesAboutZ(scene::interpolateRotation(sampler, t)), 100 * t, 1e-4);
}

TEST(Interpolate, RotationsTakeTheShorterArc) {
  AnimationSampler sampler = rotations(Interpolation::linear, {10, 50});
  for (std::size_t i = 4; i < 8; ++i) sampler.values[i] = -sampler.values[i];  // the same rotation
  EXPECT_NEAR(degreesAboutZ(scene::interpolateRotation(sampler, 0.5)), 30, 1e-4);
}

TEST(Interpolate, RotationsAreNormalized) {
  AnimationSampler sampler = rotations(Interpolation::linear, {0, 80});
  for (float& v : sampler.values) v *= 3.0f;
  for (const double t : {0.0, 0.5, 1.0}) {
    const glm::dquat q = scene::interpolateRotation(sampler, t);
    EXPECT_NEAR(glm::length(q), 1.0, 1e-9);
    EXPECT_NEAR(degreesAboutZ(q), 80 * t, 1e-4);
  }
  // The spline of two unit quaternions is shorter than 1 in the middle.
  const glm::dquat q = scene::interpolateRotation(rotations(Interpolation::cubicSpline, {0, 80}), 0.5);
  EXPECT_NEAR(glm::length(q), 1.0, 1e-9);
  EXPECT_NEAR(degreesAboutZ(q), 40, 1e-4);
  const AnimationSampler zero{Interpolation::step, {0}, {0, 0, 0, 0}, 4};
  EXPECT_EQ(scene::interpolateRotation(zero, 0.0), glm::dquat(1, 0, 0, 0));
}

}  // namespace
}  // namespace quintet::test

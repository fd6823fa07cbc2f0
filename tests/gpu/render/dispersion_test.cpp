// SPDX-License-Identifier: Apache-2.0
// KHR_materials_dispersion in rendered images, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "program/load.h"
#include "rendered_image.h"

namespace quintet::test {
namespace {

// A wedge of glass: a horizontal top and a bottom that is inclined around z.
constexpr double kWedge = 0.35;  // radians
constexpr double kDispersion = 2.0;

scene::Geometry wedge() {
  const float slope = static_cast<float>(std::tan(kWedge));
  scene::Geometry g;
  for (const float z : {-1.0f, 1.0f})
    for (const vec2& p : {vec2(-1, 0), vec2(1, 0), vec2(1, -0.5f + slope), vec2(-1, -0.5f - slope)})
      g.positions.emplace_back(p.x, p.y, z);
  const auto face = [&](unsigned a, unsigned b, unsigned c, unsigned d) {
    g.triangles.push_back({a, b, c}), g.triangles.push_back({a, c, d});
  };
  face(0, 4, 5, 1), face(7, 3, 2, 6), face(4, 7, 6, 5), face(1, 2, 3, 0), face(0, 3, 7, 4), face(5, 6, 2, 1);
  return g;
}

double indexOf(int channel) { return 1.5 + (channel - 1) * 0.025 * kDispersion * 0.5; }

double fresnelOf(double cosine, double eta) {
  const double refracted = std::sqrt(1.0 - (1.0 - cosine * cosine) / (eta * eta));
  const double s = (cosine - eta * refracted) / (cosine + eta * refracted);
  const double p = (eta * cosine - refracted) / (eta * cosine + refracted);
  return 0.5 * (s * s + p * p);
}

// Where a vertical ray at x = 0 arrives at the plane y = -3, and the part of the light that passes the wedge.
struct Arrival {
  double x, passed;
};
Arrival arrivalOf(int channel) {
  const double index = indexOf(channel), bent = std::asin(index * std::sin(kWedge)) - kWedge;
  return {-2.5 * std::tan(bent), (1.0 - fresnelOf(1.0, index)) * (1.0 - fresnelOf(std::cos(kWedge), 1.0 / index))};
}

// A narrow emitter below the wedge at the place of one channel is seen in this channel only.
void expectSeparation(const std::string& program) {
  for (int channel = 0; channel < 3; ++channel) {
    SCOPED_TRACE(channel);
    const Arrival arrival = arrivalOf(channel);
    const float x = static_cast<float>(arrival.x), width = 0.004f;
    EXPECT_GT(std::abs(arrivalOf(channel == 0 ? 1 : 0).x - arrival.x), 2.0 * double{width});
    scene::Material glass = clearGlass(1.5f, 1.0f);
    glass.dispersion = static_cast<float>(kDispersion);
    SceneBuilder scene;
    scene.add(wedge(), glass).add(quad({x - width, -3, 1}, {2 * width, 0, 0}, {0, 0, -2}), emitter(vec3(2.0f)));
    scene.camera(orthographic({0, 2, 0}, vec3(0.0f), 0.001f));
    vec4 expected(0, 0, 0, 1);
    expected[channel] = static_cast<float>(2.0 * arrival.passed);
    ImageOptions options;
    options.program = program::loadProgram(program);
    options.set = {"bounces=2"};
    expectUniform(renderImage(scene, options), expected, {.error = 0.05, .rounding = 1e-3});
  }
}

TEST(DispersionRender, WedgeSeparatesTheChannels) { expectSeparation("pathtracer"); }
TEST(DispersionRender, WedgeSeparatesTheChannelsOfNaive) { expectSeparation("naive"); }

// A white sky stays white in each channel: the wedge absorbs nothing. A thin wall has no dispersion.
TEST(DispersionRender, GlassIsInvisibleInAFurnace) {
  for (const float thickness : {1.0f, 0.0f}) {
    scene::Material glass = clearGlass(1.5f, thickness);
    glass.dispersion = 1.0f;
    SceneBuilder scene;
    scene.add(wedge(), glass).sky(vec3(1.0f)).camera(orthographic({0, 2, 0}, vec3(0.0f), 0.2f));
    ImageOptions options;
    options.set = {"bounces=40"};
    expectUniform(renderImage(scene, options), vec4(1.0f), {.error = 0.05, .rounding = 2e-3});
  }
}

}  // namespace
}  // namespace quintet::test

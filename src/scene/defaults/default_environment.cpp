// SPDX-License-Identifier: Apache-2.0
#include "scene/defaults/default_environment.h"

#include <algorithm>

namespace quintet::scene {
namespace {

using glm::dvec3;

constexpr std::uint32_t kWidth = 512, kHeight = 256;

dvec3 radiance(const dvec3& direction) {
  const double h = direction.y;
  const dvec3 sky = glm::mix(dvec3(1.0), dvec3(0.55, 0.65, 0.80), std::pow(std::max(h, 0.0), 0.6));
  const dvec3 ground = glm::mix(dvec3(0.38, 0.36, 0.33), dvec3(0.24, 0.22, 0.20), std::max(-h, 0.0));
  const auto lobe = [&](const dvec3& axis, double sharpness) {
    return std::exp(sharpness * (glm::dot(direction, glm::normalize(axis)) - 1.0));
  };
  return glm::mix(ground, sky, glm::smoothstep(-0.06, 0.06, h)) +
         dvec3(14.0, 13.2, 12.0) * lobe({0.5, 0.75, 0.55}, 60.0) + dvec3(1.0, 1.1, 1.3) * lobe({-0.8, 0.3, 0.2}, 8.0);
}

}  // namespace

Environment defaultEnvironment() {
  Environment environment;
  environment.name = "default sky";
  environment.present = true;
  environment.image = io::makeImage(kWidth, kHeight, 3, io::PixelType::f32, io::ColorEncoding::linear);

  std::vector<dvec3> values;
  values.reserve(environment.image.pixelCount());
  dvec3 sum(0.0);
  double weights = 0.0;
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    const double theta = glm::pi<double>() * (y + 0.5) / kHeight;
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const double phi = glm::two_pi<double>() * ((x + 0.5) / kWidth - 0.5);
      const double sine = std::sin(theta);
      values.push_back(radiance({sine * std::cos(phi), std::cos(theta), sine * std::sin(phi)}));
      sum += sine * values.back();
      weights += sine;
    }
  }
  const dvec3 scale = kDefaultRadiance * weights / sum;
  auto samples = environment.image.samples<float>();
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) samples[3 * i + c] = static_cast<float>(values[i][c] * scale[c]);
  return environment;
}

Environment effectiveEnvironment(const Scene& scene) {
  if (scene.environment.present) return scene.environment;
  return needsEnvironment(ownLight(scene)) ? defaultEnvironment() : Environment{};
}

}  // namespace quintet::scene

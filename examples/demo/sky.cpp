// SPDX-License-Identifier: Apache-2.0
#include "demo/sky.h"

#include <algorithm>

#include "base/parallel.h"
#include "demo/noise.h"

namespace quintet::demo {
namespace {

const vec3 kLuminance{0.2126f, 0.7152f, 0.0722f};

vec3 rgbFromYxy(float luminance, float x, float y) {
  const vec3 xyz(luminance * x / y, luminance, luminance * (1.0f - x - y) / y);
  const mat3 rgbFromXyz(3.2404542f, -0.9692660f, 0.0556434f, -1.5371385f, 1.8760108f, -0.2040259f, -0.4985314f,
                        0.0415560f, 1.0572252f);
  return glm::max(rgbFromXyz * xyz, vec3(0.0f));
}

// Color of the sun through the air, from the appendix of the paper (Rayleigh and aerosols; Iqbal 1983).
vec3 sunColor(float thetaSun, float turbidity) {
  const float degrees = glm::degrees(thetaSun);
  const float mass = 1.0f / (std::cos(thetaSun) + 0.15f * std::pow(93.885f - degrees, -1.253f));
  const float beta = 0.04608f * turbidity - 0.04586f;
  vec3 color;
  const vec3 wavelengths(0.61f, 0.55f, 0.465f);  // wavelengths of red, green and blue, micrometers
  for (glm::length_t i = 0; i < 3; ++i) {
    color[i] = std::exp(-0.008735f * std::pow(wavelengths[i], -4.08f) * mass) *
               std::exp(-beta * std::pow(wavelengths[i], -1.3f) * mass);
  }
  return color / glm::dot(color, kLuminance);
}

// The disc has full radiance in the center and fades outwards.
float discProfile(float gamma, float radius) { return 1.0f - glm::smoothstep(0.25f * radius, radius, gamma); }

float discSolidAngle(float radius) {
  constexpr int kSteps = 1000;
  float sum = 0.0f;
  for (int i = 0; i < kSteps; ++i) {
    const float gamma = radius * (static_cast<float>(i) + 0.5f) / kSteps;
    sum += discProfile(gamma, radius) * std::sin(gamma);
  }
  return sum * 2.0f * kPi * radius / kSteps;
}

// Zenith chromaticity: (T² T 1) · rows · (θ³ θ² θ 1).
float zenithChromaticity(float t, float theta, const vec4& row2, const vec4& row1, const vec4& row0) {
  const vec4 powers(theta * theta * theta, theta * theta, theta, 1.0f);
  return t * t * glm::dot(row2, powers) + t * glm::dot(row1, powers) + glm::dot(row0, powers);
}

}  // namespace

float Sky::Perez::at(float cosTheta, float gamma) const {
  const float cosGamma = std::cos(gamma);
  return (1.0f + a * std::exp(b / cosTheta)) * (1.0f + c * std::exp(d * gamma) + e * cosGamma * cosGamma);
}

float Sky::Perez::ratio(float cosTheta, float gamma, float thetaSun) const {
  return zenith * at(cosTheta, gamma) / at(1.0f, thetaSun);
}

Sky::Sky(const SkySettings& settings)
    : settings_(settings), thetaSun_(std::acos(glm::clamp(settings.sunDirection.y, 0.0f, 1.0f))) {
  const float t = settings.turbidity;
  const float chi = (4.0f / 9.0f - t / 120.0f) * (kPi - 2.0f * thetaSun_);
  luminance_ = {0.1787f * t - 1.4630f,  -0.3554f * t + 0.4275f,
                -0.0227f * t + 5.3251f, 0.1206f * t - 2.5771f,
                -0.0670f * t + 0.3703f, (4.0453f * t - 4.9710f) * std::tan(chi) - 0.2155f * t + 2.4192f};
  x_ = {-0.0193f * t - 0.2592f,
        -0.0665f * t + 0.0008f,
        -0.0004f * t + 0.2125f,
        -0.0641f * t - 0.8989f,
        -0.0033f * t + 0.0452f,
        zenithChromaticity(t, thetaSun_, {0.00166f, -0.00375f, 0.00209f, 0.0f},
                           {-0.02903f, 0.06377f, -0.03202f, 0.00394f}, {0.11693f, -0.21196f, 0.06052f, 0.25886f})};
  y_ = {-0.0167f * t - 0.2608f,
        -0.0950f * t + 0.0092f,
        -0.0079f * t + 0.2102f,
        -0.0441f * t - 1.6537f,
        -0.0109f * t + 0.0529f,
        zenithChromaticity(t, thetaSun_, {0.00275f, -0.00610f, 0.00317f, 0.0f},
                           {-0.04214f, 0.08970f, -0.04153f, 0.00516f}, {0.15346f, -0.26756f, 0.06670f, 0.26688f})};

  // Scales the kcd/m² of the model to the requested irradiance.
  constexpr int kRows = 64, kColumns = 128;
  float irradiance = 0.0f;
  for (int j = 0; j < kRows; ++j) {
    const float theta = 0.5f * kPi * (static_cast<float>(j) + 0.5f) / kRows;
    for (int i = 0; i < kColumns; ++i) {
      const float phi = 2.0f * kPi * static_cast<float>(i) / kColumns;
      const vec3 d(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
      irradiance += glm::dot(dome(d), kLuminance) * d.y * std::sin(theta);
    }
  }
  irradiance *= 0.5f * kPi / kRows * 2.0f * kPi / kColumns;
  scale_ = settings.skyIrradiance / irradiance;
  sunColor_ = sunColor(thetaSun_, t);
  whiteLight_ = (settings.skyIrradiance + 0.7f * settings.sunIrradiance * sunColor_) * 0.75f / kPi;
  sunRadiance_ = sunColor_ * settings.sunIrradiance / discSolidAngle(settings.sunRadius);
}

vec3 Sky::dome(const vec3& d) const {
  const float cosTheta = std::max(d.y, 0.02f);
  const float gamma = std::acos(glm::clamp(glm::dot(d, settings_.sunDirection), -1.0f, 1.0f));
  return scale_ * rgbFromYxy(luminance_.ratio(cosTheta, gamma, thetaSun_), x_.ratio(cosTheta, gamma, thetaSun_),
                             y_.ratio(cosTheta, gamma, thetaSun_));
}

vec3 Sky::sun(const vec3& d) const {
  const float gamma = std::acos(glm::clamp(glm::dot(d, settings_.sunDirection), -1.0f, 1.0f));
  return sunRadiance_ * discProfile(gamma, settings_.sunRadius);
}

// Water that reflects the sky (Schlick 1994, ior 1.34), blurred by waves, over a dark blue-green depth. It fades into
// the haze towards the horizon.
vec3 Sky::sea(const vec3& d) const {
  constexpr float kWaves = 0.12f;  // raises the reflected ray, because a grazing view sees the slopes of waves
  const float down = -d.y;
  const vec3 reflected = glm::normalize(vec3(d.x, down + kWaves, d.z));
  const float fresnel = 0.021f + 0.979f * std::pow(1.0f - std::min(down + kWaves, 1.0f), 5.0f);
  const vec3 depth = vec3(0.020f, 0.045f, 0.055f) * (settings_.skyIrradiance + settings_.sunIrradiance) / kPi;
  const vec3 water = fresnel * dome(reflected) + (1.0f - fresnel) * depth;
  return glm::mix(water, haze(d), std::exp(-down / 0.012f));
}

vec3 Sky::haze(const vec3& d) const { return hazy(dome(glm::normalize(vec3(d.x, 1e-3f, d.z))), 0.0f); }

// Moist air near the horizon, white in the light of sun and sky. Without it, the model is mauve there.
vec3 Sky::hazy(const vec3& clear, float height) const {
  return glm::mix(clear, whiteLight_, 0.8f * settings_.haze * std::exp(-height / 0.07f));
}

// A thin layer of streaky cloud on a plane overhead, lit by sun and sky.
vec3 Sky::cloudy(const vec3& clear, const vec3& d) const {
  const vec2 p = vec2(d.x, d.z) / (d.y + 0.10f);
  const vec3 q(0.55f * p.x, 1.5f * p.y, 3.0f);
  const float warp = fbm(0.7f * q, 3, 101);
  const float density = glm::smoothstep(-0.05f, 0.55f, fbm(q + 0.9f * warp, 6, 103));
  return glm::mix(clear, 1.2f * whiteLight_, settings_.clouds * density * glm::smoothstep(0.0f, 0.10f, d.y));
}

// Three ridges, the nearest one darkest, with colors faded by the air.
vec3 Sky::hilly(const vec3& behind, const vec3& d) const {
  struct Ridge {
    float height, amplitude, frequency, air;
  };
  constexpr Ridge kRidges[] = {
      {0.034f, 0.060f, 2.2f, 0.74f}, {0.014f, 0.046f, 3.1f, 0.55f}, {-0.006f, 0.034f, 4.3f, 0.36f}};
  const vec3 ground = vec3(0.10f, 0.13f, 0.12f) / kPi * (settings_.skyIrradiance + 0.4f * settings_.sunIrradiance);
  const vec2 around = glm::normalize(vec2(d.x, d.z) + vec2(1e-9f, 0.0f));
  const vec3 air = 0.5f * haze(d) + 0.5f * dome(glm::normalize(vec3(around.x, 0.6f, around.y)));
  vec3 result = behind;
  std::uint32_t seed = 211;
  for (const Ridge& ridge : kRidges) {
    const float top = ridge.height + ridge.amplitude * fbm(vec3(ridge.frequency * around, 0.7f), 5, seed++);
    const float inside = glm::smoothstep(-0.0015f, 0.0015f, top - d.y);
    result = glm::mix(result, glm::mix(ground, air, ridge.air), inside);
  }
  return result;
}

vec3 Sky::radiance(const vec3& d) const {
  if (d.y <= 0.0f) return sea(d);
  vec3 result = hazy(dome(d), d.y);
  if (settings_.clouds > 0.0f) result = cloudy(result, d);
  if (settings_.hills) result = hilly(result, d);
  return result + sun(d);
}

io::Image skyImage(const SkySettings& settings, std::uint32_t width, std::uint32_t height) {
  const Sky sky(settings);
  io::Image image = io::makeImage(width, height, 3, io::PixelType::f32, io::ColorEncoding::linear);
  parallelFor(height, [&](std::size_t row) {
    const auto y = static_cast<std::uint32_t>(row);
    for (std::uint32_t x = 0; x < width; ++x) {
      vec3 sum(0.0f);
      for (unsigned sample = 0; sample < 4; ++sample) {  // the edges of sun and horizon are smooth at this scale
        const float u = (static_cast<float>(x) + (sample & 1u ? 0.75f : 0.25f)) / static_cast<float>(width);
        const float v = (static_cast<float>(y) + (sample & 2u ? 0.75f : 0.25f)) / static_cast<float>(height);
        const float phi = 2.0f * kPi * (u - 0.5f), theta = kPi * v;
        sum += sky.radiance({std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)});
      }
      const auto pixel = image.pixel<float>(x, y);
      for (unsigned c = 0; c < 3; ++c) pixel[c] = 0.25f * sum[c];
    }
  });
  return image;
}

}  // namespace quintet::demo

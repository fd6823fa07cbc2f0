// Albedos by quadrature over the visible micronormals: a grid on the spherical cap of Dupuy and Benyoub
// 2023, whose points are equally likely, so that an albedo is a plain mean of Fresnel times shadowing.
#include "render/albedo_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/math.h"
#include "base/parallel.h"
#include "quintet/shared/albedo.h"

namespace quintet::render {
namespace {

using glm::vec2;
using glm::vec3;
using namespace shared;

// Points of the grid: along the cap's axis, and around half of it (the other half mirrors it).
constexpr int kRings = 16;
constexpr int kSectors = 12;

struct Azimuths {
  std::array<float, kSectors> cosine, sine;
  Azimuths() {
    for (int i = 0; i < kSectors; ++i) {
      const double phi = std::numbers::pi * (i + 0.5) / kSectors;
      cosine[i] = static_cast<float>(std::cos(phi));
      sine[i] = static_cast<float>(std::sin(phi));
    }
  }
};

// cos theta (1 + 2 Lambda), ggxStretch in the shader.
float stretch(float cosine, float alpha) {
  return std::sqrt(cosine * cosine + alpha * alpha * std::max(1.0f - cosine * cosine, 0.0f));
}

// The mean of value(m) over the micronormals visible from wo = (sine, 0, cosine).
template <class Value>
vec2 meanOverVisible(vec3 wo, float alpha, const Value& value) {
  static const Azimuths azimuths;
  const vec3 o = glm::normalize(vec3(alpha * wo.x, 0.0f, wo.z));
  vec2 sum(0.0f);
  for (int ring = 0; ring < kRings; ++ring) {
    const float z = 1.0f - (static_cast<float>(ring) + 0.5f) / kRings * (1.0f + o.z);
    const float r = std::sqrt(std::max(1.0f - z * z, 0.0f));
    for (int i = 0; i < kSectors; ++i) {
      const vec3 m = o + vec3(r * azimuths.cosine[i], r * azimuths.sine[i], z);
      sum += value(glm::normalize(vec3(alpha * m.x, alpha * m.y, m.z)));
    }
  }
  return sum / static_cast<float>(kRings * kSectors);
}

// A micronormal, seen from wo.
struct Encounter {
  float cosO;    // of wo at the surface
  float cosine;  // of wo at the micronormal
  float normalZ;
};

// G2 / G1(wo) for reflection.
float reflectedShadowing(const Encounter& e, float alpha) {
  const float cosI = 2.0f * e.cosine * e.normalZ - e.cosO;
  if (cosI <= 0.0f) return 0.0f;
  const float o = stretch(e.cosO, alpha);
  return cosI * (e.cosO + o) / (e.cosO * stretch(cosI, alpha) + cosI * o);
}

// G1(wi) for refraction; eta: far over near index.
float refractedShadowing(const Encounter& e, float eta, float alpha) {
  const float refracted = std::sqrt(std::max(1.0f + (e.cosine * e.cosine - 1.0f) / (eta * eta), 0.0f));
  const float cosI = (refracted - e.cosine / eta) * e.normalZ + e.cosO / eta;
  return cosI <= 0.0f ? 0.0f : 2.0f * cosI / (cosI + stretch(cosI, alpha));
}

// Walter et al. 2007, eq. 22.
float fresnel(float cosine, float eta) {
  const float g2 = eta * eta - 1.0f + cosine * cosine;
  if (g2 <= 0.0f) return 1.0f;
  const float g = std::sqrt(g2);
  const float a = (g - cosine) / (g + cosine);
  const float b = (cosine * (g + cosine) - 1.0f) / (cosine * (g - cosine) + 1.0f);
  return 0.5f * a * a * (1.0f + b * b);
}

// The value at index 0 stands for a grazing direction and for a mirror, which the limits below reach.
float axis(std::size_t index, uint count) {
  return std::max(static_cast<float>(index) / static_cast<float>(count - 1), 1e-3f);
}

vec3 directionAt(std::size_t index, uint count) {
  const float cosine = axis(index, count) * axis(index, count);
  return {std::sqrt(1.0f - cosine * cosine), 0.0f, cosine};
}

float alphaAt(std::size_t index, uint count) { return axis(index, count) * axis(index, count); }

vec2 schlickAlbedo(vec3 wo, float alpha) {
  return meanOverVisible(wo, alpha, [&](vec3 m) {
    const Encounter e{wo.z, wo.x * m.x + wo.z * m.z, m.z};
    const float shadowing = reflectedShadowing(e, alpha);
    const float x = std::clamp(1.0f - e.cosine, 0.0f, 1.0f);
    const float weight = x * x * x * x * x;
    return vec2(shadowing * (1.0f - weight), shadowing * weight);
  });
}

vec2 glassAlbedo(vec3 wo, float alpha, float eta) {
  return meanOverVisible(wo, alpha, [&](vec3 m) {
    const Encounter e{wo.z, std::min(wo.x * m.x + wo.z * m.z, 1.0f), m.z};
    const float reflectance = fresnel(e.cosine, eta);
    const float reflected = reflectedShadowing(e, alpha);
    const float refracted = reflectance < 1.0f ? refractedShadowing(e, eta, alpha) : reflected;
    return vec2(refracted + (reflected - refracted) * reflectance, refracted);
  });
}

// Averages over one row of (A, B) as the shader interpolates it: ∫ 4 x³ … dx over x = sqrt(cos theta).
vec4 averageRow(const float* row) {
  constexpr int kPoints = 8;  // of the midpoint rule in each cell
  constexpr uint kCells = kAlbedoCosines - 1;
  vec4 sum(0.0f);
  for (uint cell = 0; cell < kCells; ++cell) {
    for (int i = 0; i < kPoints; ++i) {
      const float t = (static_cast<float>(i) + 0.5f) / kPoints;
      const float x = (static_cast<float>(cell) + t) / kCells;
      const vec2 ab = glm::mix(vec2(row[2 * cell], row[2 * cell + 1]), vec2(row[2 * cell + 2], row[2 * cell + 3]), t);
      const float lost = 1.0f / (ab.x + ab.y) - 1.0f;
      sum += vec4(ab.x, ab.y, ab.x * lost, ab.y * lost) * (4.0f * x * x * x);
    }
  }
  return sum / static_cast<float>(kCells * kPoints);
}

void store(float* to, vec2 value) { to[0] = value.x, to[1] = value.y; }

}  // namespace

std::vector<float> computeAlbedoTables() {
  std::vector<float> table(kAlbedoFloatCount);
  parallelFor(kAlbedoRoughnesses, [&](std::size_t row) {
    float* cells = table.data() + row * kAlbedoCosines * 2;
    for (uint i = 0; i < kAlbedoCosines; ++i)
      store(cells + 2 * i, schlickAlbedo(directionAt(i, kAlbedoCosines), alphaAt(row, kAlbedoRoughnesses)));
    const vec4 average = averageRow(cells);
    for (int i = 0; i < 4; ++i) table[kAlbedoAverageOffset + row * 4 + i] = average[i];
  });
  parallelFor(2 * kGlassIors * kGlassRoughnesses, [&](std::size_t row) {
    const std::size_t layer = row / kGlassRoughnesses;
    const float r = 0.5f * static_cast<float>(layer % kGlassIors) / (kGlassIors - 1);  // (ior - 1) / (ior + 1)
    const float eta = layer < kGlassIors ? (1.0f + r) / (1.0f - r) : (1.0f - r) / (1.0f + r);
    for (uint i = 0; i < kGlassCosines; ++i)
      store(table.data() + kGlassOffset + (row * kGlassCosines + i) * 2,
            glassAlbedo(directionAt(i, kGlassCosines), alphaAt(row % kGlassRoughnesses, kGlassRoughnesses), eta));
  });
  return table;
}

}  // namespace quintet::render

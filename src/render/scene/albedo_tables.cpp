// SPDX-License-Identifier: Apache-2.0
// An albedo is the mean of Fresnel times shadowing over the visible micronormals. It is integrated by Gauss-Legendre
// quadrature along the axis of the spherical cap of Dupuy and Benyoub 2023, and by the midpoint rule around it, on one
// half of the symmetric cap. The sheen, which has no visible normals, is integrated over the incident directions.
#include "render/scene/albedo_tables.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/math.h"
#include "base/parallel.h"
#include "quintet/shared/albedo.h"

namespace quintet::render {
namespace {

using namespace shared;

struct Ring {
  float position;  // along the cap, in (0, 1)
  float weight;    // of each point of the ring; the weights of all points add up to 1
};

struct Quadrature {
  Quadrature(int ringCount, int sectorCount);
  std::vector<Ring> rings;
  std::vector<vec2> sectors;  // cosine and sine of the azimuth
};

// Finds the Gauss-Legendre roots by Newton's method. The rings are denser toward the end of the cap, where the
// integrand is steep: position = 1 - (1 - t)².
Quadrature::Quadrature(int ringCount, int sectorCount) {
  for (int i = 0; i < ringCount; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (ringCount + 0.5));
    double slope = 0.0;
    for (int iteration = 0; iteration < 10; ++iteration) {
      double previous = 1.0, value = x;
      for (int k = 2; k <= ringCount; ++k) {
        const double next = ((2 * k - 1) * x * value - (k - 1) * previous) / k;
        previous = value;
        value = next;
      }
      slope = ringCount * (x * value - previous) / (x * x - 1.0);
      x -= value / slope;
    }
    const double rest = 0.5 * (1.0 + x);
    const double weight = 2.0 * rest / ((1.0 - x * x) * slope * slope) / sectorCount;
    rings.push_back({static_cast<float>(1.0 - rest * rest), static_cast<float>(weight)});
  }
  for (int i = 0; i < sectorCount; ++i) {
    const double phi = std::numbers::pi * (i + 0.5) / sectorCount;
    sectors.emplace_back(std::cos(phi), std::sin(phi));
  }
}

// An outgoing direction and the roughness of the surface.
struct Outgoing {
  float cosine;
  float alpha;
  float stretch;  // cos theta (1 + 2 Lambda)
};

float stretch(float cosine, float alpha) {
  return std::sqrt(cosine * cosine + alpha * alpha * std::max(1.0f - cosine * cosine, 0.0f));
}

float fourth(float x) { return x * x * x * x; }

float position(std::size_t index, uint count) { return static_cast<float>(index) / static_cast<float>(count - 1); }

// Returns the cosine of a table node. Node 0 holds the limit at cosine 0.
float cosineOf(std::size_t index, uint count) { return fourth(std::max(position(index, count), 0.01f)); }

// Returns the cosine of a table node inside glass, where total reflection starts below the cosine `edge`.
float cosineInside(std::size_t index, float edge) {
  const float x = 2.0f * position(index, kGlassCosines);
  return x <= 1.0f ? edge * fourth(std::max(x, 0.01f)) : edge + (1.0f - edge) * (x - 1.0f) * (x - 1.0f);
}

float alphaOf(std::size_t index, uint count) {
  constexpr float kFirst = 0.14953488f;  // kDeltaAlpha^(1/4)
  return fourth(kFirst + (1.0f - kFirst) * position(index, count));
}

// Returns the mean of value(wo.m, m.z) over the micronormals m visible from wo.
template <class Value>
vec2 meanOverVisible(const Outgoing& wo, const Quadrature& quadrature, const Value& value) {
  const float sine = std::sqrt(1.0f - wo.cosine * wo.cosine);
  const float axisX = wo.alpha * sine / wo.stretch;
  const float axisZ = wo.cosine / wo.stretch;
  vec2 sum(0.0f);
  for (const Ring& ring : quadrature.rings) {
    const float z = 1.0f - ring.position * (1.0f + axisZ);
    const float r = std::sqrt(std::max(1.0f - z * z, 0.0f));
    for (const vec2& sector : quadrature.sectors) {
      const float x = wo.alpha * (axisX + r * sector.x);
      const float y = wo.alpha * r * sector.y;
      const float scale = 1.0f / std::sqrt(x * x + y * y + (axisZ + z) * (axisZ + z));
      const float normalZ = (axisZ + z) * scale;
      sum += ring.weight * value(std::min(sine * x * scale + wo.cosine * normalZ, 1.0f), normalZ);
    }
  }
  return sum;
}

// Returns G2 / G1(wo) for reflection.
float reflectedShadowing(const Outgoing& wo, float cosine, float normalZ) {
  const float cosI = 2.0f * cosine * normalZ - wo.cosine;
  if (cosI <= 0.0f) return 0.0f;
  return cosI * (wo.cosine + wo.stretch) / (wo.cosine * stretch(cosI, wo.alpha) + cosI * wo.stretch);
}

vec2 schlickAlbedo(const Outgoing& wo, const Quadrature& quadrature) {
  return meanOverVisible(wo, quadrature, [&](float cosine, float normalZ) {
    const float x = std::max(1.0f - cosine, 0.0f);
    const float weight = x * x * x * x * x;
    const float shadowing = std::min(reflectedShadowing(wo, cosine, normalZ), 1.0f);
    return vec2(1.0f - shadowing, shadowing * weight);
  });
}

// Uses equation 22 of Walter et al. 2007 for the Fresnel reflectance. `eta` is the index of the far side over that of
// the near side.
vec2 glassAlbedo(const Outgoing& wo, float eta, const Quadrature& quadrature) {
  return meanOverVisible(wo, quadrature, [&](float cosine, float normalZ) {
    const float reflected = reflectedShadowing(wo, cosine, normalZ);
    const float g2 = eta * eta - 1.0f + cosine * cosine;
    if (g2 <= 0.0f) return vec2(reflected);
    const float g = std::sqrt(g2);
    const float a = (g - cosine) / (g + cosine);
    const float b = (cosine * (g + cosine) - 1.0f) / (cosine * (g - cosine) + 1.0f);
    const float reflectance = 0.5f * a * a * (1.0f + b * b);
    // g / eta is the cosine of refraction at the micronormal.
    const float cosI = ((g - cosine) * normalZ + wo.cosine) / eta;
    const float refracted = cosI <= 0.0f ? 0.0f : 2.0f * cosI / (cosI + stretch(cosI, wo.alpha));
    return vec2(glm::mix(refracted, reflected, reflectance), refracted);
  });
}

// Returns the average of one row of (L, B) as the shader interpolates it: ∫ 8 x⁷ … dx over x = cos^(1/4).
vec2 averageRow(const vec2* row) {
  constexpr int kPoints = 8;  // points of the midpoint rule in each cell
  constexpr uint kCells = kAlbedoCosines - 1;
  vec2 sum(0.0f);
  for (uint cell = 0; cell < kCells; ++cell) {
    for (int i = 0; i < kPoints; ++i) {
      const float t = (static_cast<float>(i) + 0.5f) / kPoints;
      const float x = (static_cast<float>(cell) + t) / kCells;
      sum += glm::mix(row[cell], row[cell + 1], t) * (8.0f * fourth(x) * x * x * x);
    }
  }
  return sum / static_cast<float>(kCells * kPoints);
}

// Lambda of the sheen: the fit of Estevez and Kulla 2017, as in quintet/bsdf/sheen.glsl.
float sheenLambda(float cosine, float alpha) {
  const float t = (1.0f - alpha) * (1.0f - alpha);
  const auto logLambda = [&](float x) {
    const float a = glm::mix(21.5473f, 25.3245f, t), b = glm::mix(3.82987f, 3.32435f, t);
    const float c = glm::mix(0.19823f, 0.16801f, t), d = glm::mix(-1.97760f, -1.27393f, t);
    return a / (1.0f + b * std::pow(x, c)) + d * x + glm::mix(-4.32054f, -4.85967f, t);
  };
  return std::exp(cosine < 0.5f ? logLambda(cosine)
                                : 2.0f * logLambda(0.5f) - logLambda(std::max(1.0f - cosine, 1e-6f)));
}

// Incident directions for the sheen: cosines, denser toward the horizon, and azimuths, denser toward that of wo.
class SheenQuadrature {
 public:
  SheenQuadrature(int cosineCount, int azimuthCount);
  struct Node {
    float value;  // cosine of the direction, or cosine of the azimuth
    float weight;
  };
  std::vector<Node> cosines;
  std::vector<Node> azimuths;  // of one half; the weights add up to 2 pi
};

SheenQuadrature::SheenQuadrature(int cosineCount, int azimuthCount) {
  for (int i = 0; i < cosineCount; ++i) {
    const double x = (i + 0.5) / cosineCount;
    cosines.push_back({static_cast<float>(x * x * x), static_cast<float>(3.0 * x * x / cosineCount)});
  }
  for (int i = 0; i < azimuthCount; ++i) {
    const double x = (i + 0.5) / azimuthCount;
    const double phi = std::numbers::pi * x * x;
    azimuths.push_back(
        {static_cast<float>(std::cos(phi)), static_cast<float>(4.0 * std::numbers::pi * x / azimuthCount)});
  }
}

// Computes one row of (E, A) of the sheen.
void sheenRow(float alpha, const SheenQuadrature& quadrature, vec2* row) {
  const auto bounded = [](float cosine) { return std::max(cosine, 1e-4f); };
  std::vector<float> lambdas;
  for (const auto& [cosine, weight] : quadrature.cosines) lambdas.push_back(sheenLambda(bounded(cosine), alpha));
  // Part of the albedo at `cosine` for each incident cosine.
  const auto integrate = [&](float cosine, std::size_t i) {
    const float cosI = quadrature.cosines[i].value;
    const float sines = std::sqrt((1.0f - cosine * cosine) * (1.0f - cosI * cosI));
    float sum = 0.0f;
    for (const auto& [azimuth, weight] : quadrature.azimuths) {
      const float height = (cosine + cosI) * (cosine + cosI);
      const float length = 2.0f + 2.0f * (sines * azimuth + cosine * cosI);
      sum += weight * std::pow(std::max(1.0f - height / length, 0.0f), 0.5f / alpha);
    }
    const float scale = (2.0f + 1.0f / alpha) / (8.0f * std::numbers::pi_v<float> * bounded(cosine) * bounded(cosI));
    return sum * scale * cosI * quadrature.cosines[i].weight /
           (1.0f + sheenLambda(bounded(cosine), alpha) + lambdas[i]);
  };
  std::vector<float> parts;
  for (uint c = 0; c < kAlbedoCosines; ++c) {
    row[c] = vec2(0.0f);
    for (std::size_t i = 0; i < lambdas.size(); ++i) {
      parts.push_back(integrate(cosineOf(c, kAlbedoCosines), i));
      row[c].x += parts.back();
    }
  }
  // E, as the shader interpolates it, limits the lobe.
  const auto limit = [&](float cosine) {
    const float x = std::sqrt(std::sqrt(cosine)) * (kAlbedoCosines - 1);
    const uint cell = std::min(static_cast<uint>(x), kAlbedoCosines - 2);
    return glm::mix(row[cell].x, row[cell + 1].x, x - static_cast<float>(cell));
  };
  for (uint c = 0; c < kAlbedoCosines; ++c)
    for (std::size_t i = 0; i < lambdas.size(); ++i)
      row[c].y += parts[c * lambdas.size() + i] / std::max({1.0f, row[c].x, limit(quadrature.cosines[i].value)});
}

// Computes the tables of the sheen. Those of the base's (L, B) must be complete.
void computeSheen(std::vector<float>& table) {
  const SheenQuadrature quadrature(40, 12);
  parallelFor(kSheenRoughnesses, [&](std::size_t row) {
    vec2 cells[kAlbedoCosines];
    sheenRow(alphaOf(row, kSheenRoughnesses), quadrature, cells);
    std::copy_n(&cells[0].x, kAlbedoCosines * 2, table.begin() + kSheenOffset + row * kAlbedoCosines * 2);
    vec2 albedo[kAlbedoCosines], products[kAlbedoCosines];
    for (uint i = 0; i < kAlbedoCosines; ++i) albedo[i] = vec2(cells[i].y, 0.0f);
    table[kSheenAverageOffset + row * 2] = averageRow(albedo).x;
    for (uint base = 0; base < kAlbedoRoughnesses; ++base) {
      const float* lb = table.data() + base * kAlbedoCosines * 2;
      for (uint i = 0; i < kAlbedoCosines; ++i) products[i] = cells[i].y * vec2(lb[2 * i], lb[2 * i + 1]);
      const vec2 average = averageRow(products);
      std::copy_n(&average.x, 2, table.begin() + kSheenBaseOffset + (row * kAlbedoRoughnesses + base) * 2);
    }
  });
}

}  // namespace

std::vector<float> computeAlbedoTables() {
  std::vector<float> table(kAlbedoFloatCount);
  // The albedo inside glass has a kink at the edge of total reflection, and takes more points.
  const Quadrature smooth(24, 8), outside(8, 8), inside(32, 16);
  parallelFor(kAlbedoRoughnesses, [&](std::size_t row) {
    const float alpha = alphaOf(row, kAlbedoRoughnesses);
    vec2 cells[kAlbedoCosines];
    for (uint i = 0; i < kAlbedoCosines; ++i) {
      const float cosine = cosineOf(i, kAlbedoCosines);
      cells[i] = schlickAlbedo({cosine, alpha, stretch(cosine, alpha)}, smooth);
    }
    std::copy_n(&cells[0].x, kAlbedoCosines * 2, table.begin() + row * kAlbedoCosines * 2);
    const vec2 average = averageRow(cells);
    std::copy_n(&average.x, 2, table.begin() + kAlbedoAverageOffset + row * 2);
  });
  parallelFor(2 * kGlassIors * kGlassRoughnesses, [&](std::size_t row) {
    const std::size_t layer = row / kGlassRoughnesses;
    const float x = static_cast<float>(layer % kGlassIors) / (kGlassIors - 1);
    const float r = 0.5f * x * x;  // (ior - 1) / (ior + 1)
    const float eta = layer < kGlassIors ? (1.0f + r) / (1.0f - r) : (1.0f - r) / (1.0f + r);
    const float alpha = alphaOf(row % kGlassRoughnesses, kGlassRoughnesses);
    const float edge = std::sqrt(std::max(1.0f - eta * eta, 1e-6f));
    float* cells = table.data() + kGlassOffset + row * kGlassCosines * 2;
    for (uint i = 0; i < kGlassCosines; ++i) {
      const float cosine = eta < 1.0f ? cosineInside(i, edge) : cosineOf(i, kGlassCosines);
      const vec2 glass = glassAlbedo({cosine, alpha, stretch(cosine, alpha)}, eta, eta < 1.0f ? inside : outside);
      cells[2 * i] = glass.x;
      cells[2 * i + 1] = glass.y;
    }
  });
  computeSheen(table);
  return table;
}

const std::vector<float>& albedoTables() {
  static const std::vector<float> kTables = computeAlbedoTables();
  return kTables;
}

}  // namespace quintet::render

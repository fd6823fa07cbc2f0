// SPDX-License-Identifier: Apache-2.0
// An albedo is the mean of Fresnel times shadowing over the visible micronormals. It is integrated by Gauss-Legendre
// quadrature along the axis of the spherical cap of Dupuy and Benyoub 2023, and by the midpoint rule around it, on one
// half of the symmetric cap; for an anisotropic surface, on the whole cap. The sheen, which has no visible normals, is integrated over the incident directions.
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

// Returns (L, B) of an anisotropic surface with the widths `alpha` along x and y, seen from wo.
vec2 anisotropicAlbedo(const vec2& alpha, const vec3& wo, const Quadrature& quadrature) {
  const auto stretchOf = [&](const vec3& w) { return glm::length(vec3(alpha.x * w.x, alpha.y * w.y, w.z)); };
  const float stretchO = stretchOf(wo);
  const vec3 axis = vec3(alpha.x * wo.x, alpha.y * wo.y, wo.z) / stretchO;
  vec2 sum(0.0f);
  const auto add = [&](const vec3& onCap, float weight) {
    const vec3 m = glm::normalize(vec3(alpha.x * onCap.x, alpha.y * onCap.y, onCap.z));
    const float cosine = std::min(glm::dot(wo, m), 1.0f);
    const vec3 wi = 2.0f * cosine * m - wo;
    const float shadowing =
        wi.z <= 0.0f ? 0.0f : std::min(wi.z * (wo.z + stretchO) / (wo.z * stretchOf(wi) + wi.z * stretchO), 1.0f);
    const float x = std::max(1.0f - cosine, 0.0f);
    sum += weight * vec2(1.0f - shadowing, shadowing * x * x * x * x * x);
  };
  for (const Ring& ring : quadrature.rings) {
    const float z = 1.0f - ring.position * (1.0f + axis.z);
    const float r = std::sqrt(std::max(1.0f - z * z, 0.0f));
    for (const vec2& sector : quadrature.sectors)
      for (const float side : {-0.5f, 0.5f})
        add(axis + vec3(r * sector.x, 2.0f * side * r * sector.y, z), 0.5f * ring.weight);
  }
  return sum;
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

// The widths of an anisotropic surface and their fourth roots, between which the tables interpolate.
struct Widths {
  float rootX, rootY;
  vec2 alpha() const { return {fourth(rootX), fourth(rootY)}; }
  // Returns the direction at `cosine` whose azimuth has the width w, with w^(1/4) = mix(rootY, rootX, part).
  vec3 directionAt(float cosine, float part) const {
    const float width = fourth(glm::mix(rootY, rootX, part)), x = alpha().x, y = alpha().y;
    const float cos2 = x > y ? std::clamp((width * width - y * y) / (x * x - y * y), 0.0f, 1.0f) : 0.0f;
    const float sine = std::sqrt(1.0f - cosine * cosine);
    return {sine * std::sqrt(cos2), sine * std::sqrt(1.0f - cos2), cosine};
  }
};

// Returns the cosine-weighted average of (L, B) over the hemisphere. `cells` are interpolated as in the shader.
vec2 averageAnisotropic(const Widths& widths, const vec2* cells) {
  constexpr int kAzimuths = 32, kCosines = 64;  // points of the midpoint rule
  const vec2 alpha = widths.alpha();
  vec2 sum(0.0f);
  for (int i = 0; i < kAzimuths; ++i) {
    const float phi = kPi / 2.0f * (static_cast<float>(i) + 0.5f) / kAzimuths;
    const float width = glm::length(alpha * vec2(std::cos(phi), std::sin(phi)));
    const float range = widths.rootX - widths.rootY;
    const float part = range > 1e-6f ? (std::sqrt(std::sqrt(width)) - widths.rootY) / range : 0.0f;
    const float x = std::clamp(part, 0.0f, 1.0f) * (kAnisotropyWidths - 1);
    const uint column = std::min(static_cast<uint>(x), kAnisotropyWidths - 2);
    for (int k = 0; k < kCosines; ++k) {
      const float root = (static_cast<float>(k) + 0.5f) / kCosines, y = root * (kAnisotropyCosines - 1);
      const uint row = std::min(static_cast<uint>(y), kAnisotropyCosines - 2);
      const vec2* at = cells + row * kAnisotropyWidths + column;
      const float offset = x - static_cast<float>(column);
      const vec2 value =
          glm::mix(glm::mix(at[0], at[1], offset), glm::mix(at[kAnisotropyWidths], at[kAnisotropyWidths + 1], offset),
                   y - static_cast<float>(row));
      sum += value * (8.0f * fourth(root) * root * root * root);
    }
  }
  return sum / static_cast<float>(kAzimuths * kCosines);
}

void computeAnisotropy(std::vector<float>& table) {
  const Quadrature quadrature(12, 6);
  constexpr uint kCells = kAnisotropyCosines * kAnisotropyWidths;
  parallelFor(kAnisotropyRoughnesses * kAnisotropyRatios, [&](std::size_t node) {
    Widths widths;
    widths.rootY = std::sqrt(std::sqrt(alphaOf(node / kAnisotropyRatios, kAnisotropyRoughnesses)));
    widths.rootX = glm::mix(widths.rootY, 1.0f, position(node % kAnisotropyRatios, kAnisotropyRatios));
    vec2 cells[kCells];
    for (uint i = 0; i < kCells; ++i) {
      const float cosine = cosineOf(i / kAnisotropyWidths, kAnisotropyCosines);
      const vec3 wo = widths.directionAt(cosine, position(i % kAnisotropyWidths, kAnisotropyWidths));
      cells[i] = anisotropicAlbedo(widths.alpha(), wo, quadrature);
    }
    std::copy_n(&cells[0].x, kCells * 2, table.begin() + kAnisotropyOffset + node * kCells * 2);
    const vec2 average = averageAnisotropic(widths, cells);
    std::copy_n(&average.x, 2, table.begin() + kAnisotropyAverageOffset + node * 2);
  });
}

// Computes the albedos of the nodes of a thin film.
void computeFilm(std::vector<float>& table) {
  const Quadrature quadrature(24, 8);
  parallelFor(kFilmRoughnesses, [&](std::size_t row) {
    const float alpha = alphaOf(row, kFilmRoughnesses);
    for (uint node = 0; node < kFilmNodes; node += 2) {
      vec2 cells[kAlbedoCosines];
      for (uint i = 0; i < kAlbedoCosines; ++i) {
        const float cosine = cosineOf(i, kAlbedoCosines);
        const Outgoing wo{cosine, alpha, stretch(cosine, alpha)};
        cells[i] = meanOverVisible(wo, quadrature, [&](float cosMicro, float normalZ) {
          const float x = std::sqrt(std::max(cosMicro, 0.0f)) * (kFilmNodes - 1) - static_cast<float>(node);
          const vec2 hats = glm::max(1.0f - glm::abs(vec2(x, x - 1.0f)), vec2(0.0f));
          return std::min(reflectedShadowing(wo, cosMicro, normalZ), 1.0f) * hats;
        });
        std::copy_n(&cells[i].x, 2, table.begin() + kFilmOffset + (row * kAlbedoCosines + i) * kFilmNodes + node);
      }
      const vec2 average = averageRow(cells);
      std::copy_n(&average.x, 2, table.begin() + kFilmAverageOffset + row * kFilmNodes + node);
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
  computeAnisotropy(table);
  computeFilm(table);
  return table;
}

const std::vector<float>& albedoTables() {
  static const std::vector<float> kTables = computeAlbedoTables();
  return kTables;
}

}  // namespace quintet::render

// SPDX-License-Identifier: Apache-2.0
#include "bsdf/reference.h"

#include <algorithm>
#include <numbers>

#include "quintet/shared/albedo.h"

namespace quintet::test {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double kDoublePi = std::numbers::pi;
constexpr double kSmallestAlpha = 5e-4;  // narrower lobes are deltas

// GGX widths along x and y.
dvec2 widthsOf(const BsdfCase& c) {
  const double alpha = std::max(double{c.alpha}, kSmallestAlpha);
  const double strength = c.anisotropy;
  return {std::max(c.alpha + (1.0 - c.alpha) * strength * strength, kSmallestAlpha), alpha};
}
double meanWidth(const dvec2& widths) { return glm::length(widths) / std::sqrt(2.0); }

double tangentSquared(double cosine) { return 1.0 / (cosine * cosine) - 1.0; }

// Walter et al. 2007, eq. 33.
double distribution(double cosine, double alpha) {
  const double q = alpha * alpha + tangentSquared(cosine);
  return alpha * alpha / (kDoublePi * std::pow(cosine, 4.0) * q * q);
}

// Heitz 2014, eq. 72.
double lambda(double cosine, double alpha) {
  return 0.5 * (std::sqrt(1.0 + alpha * alpha * tangentSquared(cosine)) - 1.0);
}

// Heitz 2014, eq. 85 and 80: both with the tangent and the azimuth of the direction.
double distribution(const dvec3& m, const dvec2& widths) {
  const dvec2 slope = dvec2(m) / m.z / widths;
  const double q = 1.0 + glm::dot(slope, slope);
  return 1.0 / (kDoublePi * widths.x * widths.y * std::pow(m.z, 4.0) * q * q);
}
double lambda(const dvec3& w, const dvec2& widths) {
  const dvec2 stretched = widths * dvec2(w) / w.z;
  return 0.5 * (std::sqrt(1.0 + glm::dot(stretched, stretched)) - 1.0);
}

dvec3 schlick(const dvec3& f0, double f90, double cosine) {
  return f0 + (dvec3(f90) - f0) * std::pow(1.0 - cosine, 5.0);
}

// Reflection by micronormals around `normal`, without Fresnel: D G / (4 cos_o cos_i).
double reflection(const dvec3& wo, const dvec3& wi, const dvec3& normal, double alpha) {
  const dvec3 m = glm::normalize(wo + wi);
  const double cosO = glm::dot(wo, normal), cosI = glm::dot(wi, normal);
  if (cosO <= 0.0 || cosI <= 0.0) return 0.0;
  const double masking = 1.0 / (1.0 + lambda(cosO, alpha) + lambda(cosI, alpha));
  return distribution(glm::dot(m, normal), alpha) * masking / (4.0 * cosO * cosI);
}

// The same around z, with two widths.
double reflection(const dvec3& wo, const dvec3& wi, const dvec2& widths) {
  if (wo.z <= 0.0 || wi.z <= 0.0) return 0.0;
  const double masking = 1.0 / (1.0 + lambda(wo, widths) + lambda(wi, widths));
  return distribution(glm::normalize(wo + wi), widths) * masking / (4.0 * wo.z * wi.z);
}

double schlickOf(double low, double cosine) { return low + (1.0 - low) * std::pow(1.0 - cosine, 5.0); }

// From Snell's law and Fresnel's two amplitudes; 1 for total reflection.
double fresnel(double cosine, double eta) {
  const double sine2 = (1.0 - cosine * cosine) / (eta * eta);
  if (sine2 >= 1.0) return 1.0;
  const double refracted = std::sqrt(1.0 - sine2);
  const double s = (cosine - eta * refracted) / (cosine + eta * refracted);
  const double p = (eta * cosine - refracted) / (eta * cosine + refracted);
  return 0.5 * (s * s + p * p);
}

// Lambda of the sheen. Estevez and Kulla 2017, table 1: a, b, c, d, e for alpha 1 and alpha 0.
double sheenLambda(double cosine, double alpha) {
  if (cosine >= 0.5) return std::pow(sheenLambda(0.5 - 1e-12, alpha), 2.0) / sheenLambda(1.0 - cosine, alpha);
  const double rough[] = {21.5473, 3.82987, 0.19823, -1.97760, -4.32054};
  const double smooth[] = {25.3245, 3.32435, 0.16801, -1.27393, -4.85967};
  double fit[5];
  for (int i = 0; i < 5; ++i) fit[i] = rough[i] + (1.0 - alpha) * (1.0 - alpha) * (smooth[i] - rough[i]);
  return std::exp(fit[0] / (1.0 + fit[1] * std::pow(std::max(cosine, 1e-6), fit[2])) + fit[3] * cosine + fit[4]);
}

// The "Charlie" distribution with its masking, without the cosine of wi.
double charlie(const dvec3& wo, const dvec3& wi, double alpha) {
  const double sine = glm::length(glm::cross(glm::normalize(wo + wi), dvec3(0.0, 0.0, 1.0)));
  const double distribution = (2.0 + 1.0 / alpha) / (2.0 * kDoublePi) * std::pow(sine, 1.0 / alpha);
  return distribution / (4.0 * wo.z * wi.z * (1.0 + sheenLambda(wo.z, alpha) + sheenLambda(wi.z, alpha)));
}

// Sum over the orders of multiple scattering from the second on, for the average reflectance f; Kulla and Conty 2017.
double multipleFactor(double f, double lost) {
  double sum = 0.0, rest = f * f * (1.0 - lost);
  for (int i = 0; i < 4000 && rest > 1e-15; ++i) sum += rest, rest *= f * lost;
  return sum;
}

double multipleFactor(double f0, double f90, double lost) { return multipleFactor(f0 + (f90 - f0) / 21.0, lost); }

double largest(const dvec3& v) { return std::max({v.x, v.y, v.z}); }

// Linear interpolation on an axis of `count` nodes.
struct Cell {
  std::size_t index;
  double part;
};
Cell cellOf(double position, std::size_t count) {
  const double x = std::clamp(position, 0.0, 1.0) * static_cast<double>(count - 1);
  const auto index = std::min(static_cast<std::size_t>(x), count - 2);
  return {index, x - static_cast<double>(index)};
}
double root4(double x) { return std::pow(x, 0.25); }
Cell rowOf(double alpha, std::size_t count) {
  return cellOf((root4(alpha) - root4(kSmallestAlpha)) / (1.0 - root4(kSmallestAlpha)), count);
}

dvec3 film(const BsdfCase& c, double cosine, const dvec3& baseF0) {
  return referenceFilm({c.iridescenceIor, c.iridescenceThickness}, cosine, baseF0);
}

// The widths' cells of the anisotropic tables.
struct WidthCells {
  Cell across, ratio;
  explicit WidthCells(const dvec2& widths)
      : across(rowOf(widths.y, shared::kAnisotropyRoughnesses)),
        ratio(cellOf((root4(widths.x) - root4(widths.y)) / (1.0 - root4(widths.y)), shared::kAnisotropyRatios)) {}
};

}  // namespace

// The sum over paths that cross the film up to three times, with cosines of the phase instead of complex numbers.
glm::dvec3 referenceFilm(const ReferenceFilm& film, double cosine, const glm::dvec3& baseF0) {
  const double n = film.ior, thickness = film.thickness;
  const double cosineInside = std::sqrt(1.0 - (1.0 - cosine * cosine) / (n * n));
  const double top = schlickOf(std::pow((n - 1.0) / (n + 1.0), 2.0), cosine);
  dvec3 result(top), waves[2];
  dvec3 rest, amplitude;
  for (glm::length_t k = 0; k < 3; ++k) {
    const double root = std::sqrt(std::clamp(baseF0[k], 0.0, 0.9999)), baseIor = (1.0 + root) / (1.0 - root);
    const double bottom = schlickOf(std::pow((baseIor - n) / (baseIor + n), 2.0), cosineInside);
    const double between = std::clamp(top * bottom, 1e-5, 0.9999);
    rest[k] = (1.0 - top) * (1.0 - top) * bottom / (1.0 - between);
    amplitude[k] = std::sqrt(between);
    result[k] += rest[k];
    waves[0][k] = kDoublePi + (baseIor < n ? kDoublePi : 0.0);
    waves[1][k] = 2.0 * waves[0][k];
  }
  const glm::dmat3 rgbFromXyz = glm::transpose(glm::dmat3(3.2404542, -1.5371385, -0.4985314, -0.9692660, 1.8760108,
                                                          0.0415560, 0.0556434, -0.2040259, 1.0572252));
  for (int order = 1; order <= 2; ++order) {
    const double phase = 2.0 * kDoublePi * order * 2.0 * n * thickness * cosineInside * 1e-9;
    const auto gaussian = [&](double height, double center, double variance, double shift) {
      return height * std::sqrt(2.0 * kDoublePi * variance) * std::cos(phase * center + shift) *
             std::exp(-variance * phase * phase) / 1.0685e-7;
    };
    const dvec3& shift = waves[order - 1];
    const dvec3 xyz(
        gaussian(5.4856e-13, 1.6810e6, 4.3278e9, shift.x) + gaussian(9.7470e-14, 2.2399e6, 4.5282e9, shift.x),
        gaussian(4.4201e-13, 1.7953e6, 9.3046e9, shift.y), gaussian(5.2481e-13, 2.2084e6, 6.6121e9, shift.z));
    result += 2.0 * (rest - dvec3(1.0 - top)) * (order == 1 ? amplitude : amplitude * amplitude) * (rgbFromXyz * xyz);
  }
  return glm::clamp(result, 0.0, 1.0);
}

ReferenceBsdf::Layer ReferenceBsdf::layer(double alpha, double cosine) const {
  const Cell row = rowOf(alpha, shared::kAlbedoRoughnesses), column = cellOf(root4(cosine), shared::kAlbedoCosines);
  dvec2 sum(0.0);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) {
      const std::size_t at = 2 * ((row.index + i) * shared::kAlbedoCosines + column.index + j);
      sum +=
          (i ? row.part : 1.0 - row.part) * (j ? column.part : 1.0 - column.part) * dvec2(tables_[at], tables_[at + 1]);
    }
  return {sum.x, sum.y};
}

ReferenceBsdf::Layer ReferenceBsdf::averages(double alpha) const {
  const Cell row = rowOf(alpha, shared::kAlbedoRoughnesses);
  const std::size_t at = shared::kAlbedoAverageOffset + 2 * row.index;
  return {glm::mix(double{tables_[at]}, double{tables_[at + 2]}, row.part),
          glm::mix(double{tables_[at + 1]}, double{tables_[at + 3]}, row.part)};
}

ReferenceBsdf::Layer ReferenceBsdf::layer(const dvec2& widths, const dvec3& w) const {
  if (widths.x <= 1.0001 * widths.y) return layer(widths.y, std::abs(w.z));
  const WidthCells rows(widths);
  const double azimuth = std::atan2(w.y, w.x);
  const double width = glm::length(widths * dvec2(std::cos(azimuth), std::sin(azimuth)));
  const Cell cells[] = {
      rows.across, rows.ratio, cellOf(root4(std::abs(w.z)), shared::kAnisotropyCosines),
      cellOf((root4(width) - root4(widths.y)) / (root4(widths.x) - root4(widths.y)), shared::kAnisotropyWidths)};
  const std::size_t counts[] = {shared::kAnisotropyRoughnesses, shared::kAnisotropyRatios, shared::kAnisotropyCosines,
                                shared::kAnisotropyWidths};
  dvec2 sum(0.0);
  for (std::size_t corner = 0; corner < 16; ++corner) {
    std::size_t at = 0;
    double weight = 1.0;
    for (std::size_t axis = 0; axis < 4; ++axis) {
      const std::size_t up = corner >> axis & 1;
      at = at * counts[axis] + cells[axis].index + up;
      weight *= up ? cells[axis].part : 1.0 - cells[axis].part;
    }
    at = shared::kAnisotropyOffset + 2 * at;
    sum += weight * dvec2(tables_[at], tables_[at + 1]);
  }
  return {sum.x, sum.y};
}

ReferenceBsdf::Layer ReferenceBsdf::averages(const dvec2& widths) const {
  if (widths.x <= 1.0001 * widths.y) return averages(widths.y);
  const WidthCells rows(widths);
  dvec2 sum(0.0);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) {
      const std::size_t node = (rows.across.index + i) * shared::kAnisotropyRatios + rows.ratio.index + j;
      const double weight =
          (i ? rows.across.part : 1.0 - rows.across.part) * (j ? rows.ratio.part : 1.0 - rows.ratio.part);
      const std::size_t at = shared::kAnisotropyAverageOffset + 2 * node;
      sum += weight * dvec2(tables_[at], tables_[at + 1]);
    }
  return {sum.x, sum.y};
}

// Albedo that the film adds to the layer at `cosine`, or its average over the hemisphere if the cosine is negative.
double ReferenceBsdf::filmExtra(const BsdfCase& c, double cosine) const {
  if (c.iridescence == 0.0f) return 0.0;
  const double r = (c.ior - 1.0) / (c.ior + 1.0);
  const dvec3 clear = glm::min(r * r * dvec3(c.specularColor), dvec3(1.0));
  const Cell row = rowOf(meanWidth(widthsOf(c)), shared::kFilmRoughnesses);
  const Cell column = cosine < 0.0 ? Cell{0, 0.0} : cellOf(root4(cosine), shared::kAlbedoCosines);
  double sum = 0.0;
  for (std::size_t k = 0; k < shared::kFilmNodes; ++k) {
    const double at = std::pow(static_cast<double>(k) / (shared::kFilmNodes - 1), 2.0);
    const double extra =
        double{c.iridescence} * double{c.specular} * (largest(film(c, at, clear)) - schlickOf(largest(clear), at));
    for (std::size_t i = 0; i < 2; ++i) {
      const double part = i ? row.part : 1.0 - row.part;
      if (cosine < 0.0)
        sum += extra * part * tables_[shared::kFilmAverageOffset + (row.index + i) * shared::kFilmNodes + k];
      for (std::size_t j = 0; j < 2 && cosine >= 0.0; ++j)
        sum += extra * part * (j ? column.part : 1.0 - column.part) *
               tables_[shared::kFilmOffset +
                       ((row.index + i) * shared::kAlbedoCosines + column.index + j) * shared::kFilmNodes + k];
    }
  }
  return sum;
}

// Averages of the film's reflectance: four times the integral of t^3 F(t^2) for t from 0 to 1, F linear between nodes.
dvec3 ReferenceBsdf::filmAverage(const BsdfCase& c, const dvec3& baseF0) const {
  constexpr int kCells = static_cast<int>(shared::kFilmNodes) - 1;
  const auto node = [&](int k) { return film(c, std::pow(static_cast<double>(k) / kCells, 2.0), baseF0); };
  dvec3 sum(0.0), left = node(0);
  for (int k = 0; k < kCells; ++k) {
    const dvec3 right = node(k + 1);
    for (int i = 0; i < 200; ++i) {
      const double part = (i + 0.5) / 200.0, t = (k + part) / kCells;
      sum += 4.0 * t * t * t * glm::mix(left, right, part) / (200.0 * kCells);
    }
    left = right;
  }
  return sum;
}

ReferenceBsdf::Sheen ReferenceBsdf::sheen(double alpha, double cosine) const {
  const Cell row = rowOf(alpha, shared::kSheenRoughnesses), column = cellOf(root4(cosine), shared::kAlbedoCosines);
  dvec2 sum(0.0);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) {
      const std::size_t at = shared::kSheenOffset + 2 * ((row.index + i) * shared::kAlbedoCosines + column.index + j);
      sum +=
          (i ? row.part : 1.0 - row.part) * (j ? column.part : 1.0 - column.part) * dvec2(tables_[at], tables_[at + 1]);
    }
  return {sum.x, sum.y};
}

// Averages of the sheen's albedo, and of its products with the base's lost and Schlick parts.
dvec3 ReferenceBsdf::sheenAverages(double alpha, double baseAlpha) const {
  const Cell row = rowOf(alpha, shared::kSheenRoughnesses), base = rowOf(baseAlpha, shared::kAlbedoRoughnesses);
  dvec3 sum(0.0);
  for (std::size_t i = 0; i < 2; ++i) {
    const double part = i ? row.part : 1.0 - row.part;
    sum.x += part * tables_[shared::kSheenAverageOffset + 2 * (row.index + i)];
    for (std::size_t j = 0; j < 2; ++j) {
      const std::size_t at =
          shared::kSheenBaseOffset + 2 * ((row.index + i) * shared::kAlbedoRoughnesses + base.index + j);
      const double weight = part * (j ? base.part : 1.0 - base.part);
      sum.y += weight * tables_[at];
      sum.z += weight * tables_[at + 1];
    }
  }
  return sum;
}

// The albedos of rough anisotropic glass with and without Fresnel: averages over 5 rings of 8 visible micronormals, which
// are the sums of wo and points of the unit sphere in the space where the widths are 1 (Dupuy and Benyoub 2023).
dvec2 ReferenceBsdf::anisotropicGlass(const BsdfCase& c, const dvec3& wo) const {
  const dvec2 widths = widthsOf(c);
  const double eta = c.entering ? double{c.ior} : 1.0 / c.ior;
  const dvec3 stretch(widths, 1.0), axis = glm::normalize(stretch * wo);
  // Gauss-Legendre nodes of [-1, 1] for five points.
  const double inner = std::sqrt(5.0 - 2.0 * std::sqrt(10.0 / 7.0)) / 3.0;
  const double outer = std::sqrt(5.0 + 2.0 * std::sqrt(10.0 / 7.0)) / 3.0;
  const double innerWeight = (322.0 + 13.0 * std::sqrt(70.0)) / 900.0,
               outerWeight = (322.0 - 13.0 * std::sqrt(70.0)) / 900.0;
  const std::pair<double, double> nodes[] = {
      {-outer, outerWeight}, {-inner, innerWeight}, {0.0, 128.0 / 225.0}, {inner, innerWeight}, {outer, outerWeight}};
  dvec2 sum(0.0);
  for (const auto& [node, weight] : nodes)
    for (int sector = 0; sector < 8; ++sector) {
      const double t = 0.5 + 0.5 * node, z = 1.0 - (1.0 - t * t) * (1.0 + axis.z),
                   phi = kDoublePi / 8.0 * (2 * sector + 1);
      const double r = std::sqrt(1.0 - z * z);
      const dvec3 m = glm::normalize(stretch * (axis + dvec3(r * std::cos(phi), r * std::sin(phi), z)));
      const double cosine = glm::dot(wo, m), reflectance = fresnel(cosine, eta);
      const dvec3 up = 2.0 * cosine * m - wo;
      const double reflected =
          up.z > 0.0 ? (1.0 + lambda(wo, widths)) / (1.0 + lambda(wo, widths) + lambda(up, widths)) : 0.0;
      double passed = reflected;
      if (reflectance < 1.0) {
        const double bent = std::sqrt(1.0 - (1.0 - cosine * cosine) / (eta * eta));
        const dvec3 down = (cosine / eta - bent) * m - wo / eta;
        passed = down.z < 0.0 ? 1.0 / (1.0 + lambda(down, widths)) : 0.0;
      }
      sum += weight * t / 8.0 * dvec2(glm::mix(passed, reflected, reflectance), passed);
    }
  return sum;
}

dvec2 ReferenceBsdf::glass(const BsdfCase& c, double cosine) const {
  const double ior = c.ior, edge = c.entering ? 0.0 : std::sqrt(1.0 - 1.0 / (ior * ior));
  double position = root4(cosine);
  if (!c.entering)
    position = cosine < edge ? 0.5 * root4(cosine / edge) : 0.5 + 0.5 * std::sqrt((cosine - edge) / (1.0 - edge));
  const Cell cells[] = {cellOf(std::sqrt(2.0 * (ior - 1.0) / (ior + 1.0)), shared::kGlassIors),
                        rowOf(meanWidth(widthsOf(c)), shared::kGlassRoughnesses),
                        cellOf(position, shared::kGlassCosines)};
  dvec2 sum(0.0);
  for (std::size_t corner = 0; corner < 8; ++corner) {
    std::size_t at = c.entering ? 0 : shared::kGlassIors;
    double weight = 1.0;
    const std::size_t counts[] = {1, shared::kGlassRoughnesses, shared::kGlassCosines};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t up = corner >> axis & 1;
      at = at * counts[axis] + cells[axis].index + up;
      weight *= up ? cells[axis].part : 1.0 - cells[axis].part;
    }
    at = shared::kGlassOffset + 2 * at;
    sum += weight * dvec2(tables_[at], tables_[at + 1]);
  }
  return sum;
}

// Walter et al. 2007, eq. 20 and 21, for radiance, without the cosine of wi. The reflectance goes from the material's f0
// to 1 as Fresnel's does.
dvec3 ReferenceBsdf::refractive(const BsdfCase& c, const dvec3& wo, const dvec3& wi) const {
  const double eta = c.entering ? double{c.ior} : 1.0 / c.ior;
  const double r = (c.ior - 1.0) / (c.ior + 1.0);
  const dvec3 f0 = glm::min(r * r * dvec3(c.specularColor), dvec3(1.0));
  const auto reflectance = [&](double cosine) {
    const double exact = fresnel(cosine, eta);
    if (exact >= 1.0) return dvec3(1.0);
    const dvec3 bare =
        glm::max(double{c.specular} * (f0 + (dvec3(1.0) - f0) * ((exact - r * r) / (1.0 - r * r))), dvec3(0.0));
    if (c.iridescence == 0.0f) return bare;
    const double outside = c.entering ? cosine : std::sqrt(1.0 - (1.0 - cosine * cosine) * c.ior * c.ior);
    return glm::mix(bare, double{c.specular} * film(c, outside, f0), double{c.iridescence});
  };
  const dvec2 widths = widthsOf(c);
  const dvec2 albedo = widths.x > 1.0001 * widths.y ? anisotropicGlass(c, wo) : glass(c, wo.z);
  const double scale = 1.0 / (albedo.y + double{c.specular} * (albedo.x - albedo.y));
  if (wi.z > 0.0) return scale * reflection(wo, wi, widthsOf(c)) * reflectance(glm::dot(wo, glm::normalize(wo + wi)));
  dvec3 m = -glm::normalize(wo + eta * wi);
  if (m.z < 0.0) m = -m;
  const double cosO = glm::dot(wo, m), cosI = glm::dot(wi, m);
  if (cosO <= 0.0 || cosI >= 0.0) return dvec3(0.0);
  const double masking = 1.0 / ((1.0 + lambda(wo, widthsOf(c))) * (1.0 + lambda(wi, widthsOf(c))));
  const double q = cosO + eta * cosI;
  const double value =
      std::abs(cosO * cosI / (wo.z * wi.z)) * eta * eta * masking * distribution(m, widthsOf(c)) / (q * q);
  return scale * value / (eta * eta) * (1.0 - largest(reflectance(cosO))) * glm::clamp(dvec3(c.baseColor), 0.0, 1.0);
}

dvec3 ReferenceBsdf::eval(const BsdfCase& c, const dvec3& wi) const {
  const dvec3 wo = glm::normalize(dvec3(c.wo)), color = c.baseColor,
              coatNormal = glm::normalize(dvec3(c.clearcoatNormal));
  const double metal = c.metallic, opaque = (1.0 - metal) * (1.0 - c.transmission),
               clear = (1.0 - metal) * c.transmission;
  // Sheen and clearcoat of a solid are on its outside only.
  const bool solid = !c.thin && (clear > 0.0 || opaque * c.diffuseTransmission > 0.0),
             bends = !c.thin && clear > 0.0 && c.ior >= 1.0f, rough = c.alpha >= static_cast<float>(kSmallestAlpha);
  const dvec2 widths = widthsOf(c);
  const double filmWeight = c.iridescence;
  const double r = (c.ior - 1.0) / (c.ior + 1.0), f90 = c.specular;
  const dvec3 f0 = f90 * glm::min(r * r * dvec3(c.specularColor), dvec3(1.0));
  const Layer o = layer(widths, wo), i = layer(widths, wi), mean = averages(widths);
  const double extraO = filmExtra(c, wo.z), extraI = filmExtra(c, std::abs(wi.z)), extraMean = filmExtra(c, -1.0);
  const dvec3 h = glm::normalize(wo + wi);
  dvec3 f(0.0);

  // Multiple scattering by a layer, and the fraction of light that passes the layer.
  dvec3 layerMultiple, metalMultiple;
  for (glm::length_t k = 0; k < 3; ++k) {
    layerMultiple[k] = multipleFactor(f0[k], f90, mean.lost);
    metalMultiple[k] = multipleFactor(color[k], 1.0, mean.lost);
  }
  const dvec3 clearF0 = glm::min(r * r * dvec3(c.specularColor), dvec3(1.0));
  if (filmWeight > 0.0) {
    const dvec3 layerMean = f90 * filmAverage(c, clearF0), metalMean = filmAverage(c, color);
    for (glm::length_t k = 0; k < 3; ++k) {
      layerMultiple[k] = glm::mix(layerMultiple[k], multipleFactor(layerMean[k], mean.lost), filmWeight);
      metalMultiple[k] = glm::mix(metalMultiple[k], multipleFactor(metalMean[k], mean.lost), filmWeight);
    }
  }
  const double multipleShape = o.lost * i.lost / (kDoublePi * mean.lost);
  const auto passed = [&](const Layer& l, double extra) {
    const double low = largest(f0);
    return 1.0 - low * (1.0 - l.lost - l.schlick) - f90 * l.schlick - extra - largest(layerMultiple) * l.lost;
  };
  // Factors of the sheen for the lobes below: 1 - strength albedo for both directions, on sides with a sheen.
  const double strength = largest(c.sheenColor), sheenAlpha = std::max(double{c.sheenAlpha}, kSmallestAlpha);
  const bool sheenAtO = !solid || c.entering, sheenAtI = !solid || (wi.z > 0.0) == (c.entering != 0);
  const Sheen sheenO = sheen(sheenAlpha, wo.z), sheenI = sheen(sheenAlpha, std::abs(wi.z));
  const double underO = sheenAtO ? 1.0 - strength * std::min(sheenO.albedo, 1.0) : 1.0;
  const double underI = sheenAtI ? 1.0 - strength * std::min(sheenI.albedo, 1.0) : 1.0;
  const double translucent = c.diffuseTransmission;
  const dvec3 diffuseColor = wi.z > 0.0 ? (1.0 - translucent) * color : translucent * dvec3(c.diffuseTransmissionColor);
  dvec3 diffuse = opaque * diffuseColor *
                  (passed(o, extraO) * passed(i, extraI) / (kDoublePi * passed(mean, extraMean))) * underO * underI;
  if (sheenAtO && sheenAtI) {
    const dvec3 products = sheenAverages(sheenAlpha, meanWidth(widths));
    const double low = largest(f0);
    const double covered =
        (1.0 - low - extraMean) * products.x + (low - largest(layerMultiple)) * products.y + (low - f90) * products.z;
    diffuse /= 1.0 - strength * covered / passed(mean, extraMean);
  }
  if (wi.z > 0.0) {
    if (rough) {
      const double shape = reflection(wo, wi, widths), part = bends ? opaque : 1.0 - metal, cosine = glm::dot(wo, h);
      dvec3 fresnel = metal * schlick(color, 1.0, cosine) + part * schlick(f0, f90, cosine);
      if (filmWeight > 0.0)
        fresnel = glm::mix(fresnel, metal * film(c, cosine, color) + part * f90 * film(c, cosine, clearF0), filmWeight);
      f += shape * fresnel + multipleShape * (metal * metalMultiple + part * layerMultiple);
    }
  } else if (clear > 0.0 && c.thin && rough) {
    const dvec3 mirrored(wi.x, wi.y, -wi.z);
    const dvec3 m = glm::normalize(wo + mirrored);
    const double shape = reflection(wo, mirrored, widths), cosine = glm::dot(wo, m);
    double fresnel = schlick(dvec3(largest(f0)), f90, cosine).x;
    if (filmWeight > 0.0) fresnel = glm::mix(fresnel, f90 * largest(film(c, cosine, clearF0)), filmWeight);
    f += clear * color * (shape * (1.0 - fresnel) + multipleShape * (1.0 - largest(layerMultiple)));
  }
  if (bends && rough) f += clear * refractive(c, wo, wi);
  f = std::min(underO, underI) * f + diffuse;
  if (strength > 0.0 && sheenAtO && wi.z > 0.0)
    f += dvec3(c.sheenColor) * (charlie(wo, wi, sheenAlpha) / std::max({1.0, sheenO.limit, sheenI.limit}));
  f *= std::abs(wi.z);

  const double coatO = glm::dot(wo, coatNormal), coatI = glm::dot(wi, coatNormal);
  if (c.clearcoat == 0.0f || coatO <= 0.0 || (solid && !c.entering)) return f;
  const Layer coat = layer(c.clearcoatAlpha, coatO);
  f *= 1.0 - c.clearcoat * (0.04 * (1.0 - coat.lost - coat.schlick) + coat.schlick);
  if (wi.z > 0.0 && coatI > 0.0)
    f += double{c.clearcoat} * schlick(dvec3(0.04), 1.0, glm::dot(wo, h)) *
         reflection(wo, wi, coatNormal, c.clearcoatAlpha) * coatI;
  return f;
}

}  // namespace quintet::test

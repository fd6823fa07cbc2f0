// SPDX-License-Identifier: Apache-2.0
#include "bsdf/reference.h"

#include <algorithm>
#include <numbers>

#include "quintet/shared/albedo.h"

namespace quintet::test {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double kPi = std::numbers::pi;
constexpr double kSmallestAlpha = 5e-4;  // narrower lobes are deltas

double tangentSquared(double cosine) { return 1.0 / (cosine * cosine) - 1.0; }

// Walter et al. 2007, eq. 33.
double distribution(double cosine, double alpha) {
  const double q = alpha * alpha + tangentSquared(cosine);
  return alpha * alpha / (kPi * std::pow(cosine, 4.0) * q * q);
}

// Heitz 2014, eq. 72.
double lambda(double cosine, double alpha) {
  return 0.5 * (std::sqrt(1.0 + alpha * alpha * tangentSquared(cosine)) - 1.0);
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
  const double distribution = (2.0 + 1.0 / alpha) / (2.0 * kPi) * std::pow(sine, 1.0 / alpha);
  return distribution / (4.0 * wo.z * wi.z * (1.0 + sheenLambda(wo.z, alpha) + sheenLambda(wi.z, alpha)));
}

// Sum over the orders of multiple scattering from the second on; Kulla and Conty 2017.
double multipleFactor(double f0, double f90, double lost) {
  const double f = f0 + (f90 - f0) / 21.0;
  double sum = 0.0, rest = f * f * (1.0 - lost);
  for (int i = 0; i < 4000 && rest > 1e-15; ++i) sum += rest, rest *= f * lost;
  return sum;
}

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

}  // namespace

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

dvec2 ReferenceBsdf::glass(const BsdfCase& c, double cosine) const {
  const double ior = c.ior, edge = c.entering ? 0.0 : std::sqrt(1.0 - 1.0 / (ior * ior));
  double position = root4(cosine);
  if (!c.entering)
    position = cosine < edge ? 0.5 * root4(cosine / edge) : 0.5 + 0.5 * std::sqrt((cosine - edge) / (1.0 - edge));
  const Cell cells[] = {cellOf(std::sqrt(2.0 * (ior - 1.0) / (ior + 1.0)), shared::kGlassIors),
                        rowOf(c.alpha, shared::kGlassRoughnesses), cellOf(position, shared::kGlassCosines)};
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
    return glm::max(double{c.specular} * (f0 + (dvec3(1.0) - f0) * ((exact - r * r) / (1.0 - r * r))), dvec3(0.0));
  };
  const dvec2 albedo = glass(c, wo.z);
  const double scale = 1.0 / (albedo.y + double{c.specular} * (albedo.x - albedo.y));
  if (wi.z > 0.0)
    return scale * reflection(wo, wi, {0, 0, 1}, c.alpha) * reflectance(glm::dot(wo, glm::normalize(wo + wi)));
  dvec3 m = -glm::normalize(wo + eta * wi);
  if (m.z < 0.0) m = -m;
  const double cosO = glm::dot(wo, m), cosI = glm::dot(wi, m);
  if (cosO <= 0.0 || cosI >= 0.0) return dvec3(0.0);
  const double masking = 1.0 / ((1.0 + lambda(wo.z, c.alpha)) * (1.0 + lambda(wi.z, c.alpha)));
  const double q = cosO + eta * cosI;
  const double value =
      std::abs(cosO * cosI / (wo.z * wi.z)) * eta * eta * masking * distribution(m.z, c.alpha) / (q * q);
  return scale * value / (eta * eta) * (1.0 - largest(reflectance(cosO))) * glm::clamp(dvec3(c.baseColor), 0.0, 1.0);
}

dvec3 ReferenceBsdf::eval(const BsdfCase& c, const dvec3& wi) const {
  const dvec3 wo = glm::normalize(dvec3(c.wo)), color = c.baseColor, up(0.0, 0.0, 1.0),
              coatNormal = glm::normalize(dvec3(c.clearcoatNormal));
  const double metal = c.metallic, opaque = (1.0 - metal) * (1.0 - c.transmission),
               clear = (1.0 - metal) * c.transmission;
  // Sheen and clearcoat of a solid are on its outside only.
  const bool solid = !c.thin && (clear > 0.0 || opaque * c.diffuseTransmission > 0.0),
             bends = !c.thin && clear > 0.0 && c.ior >= 1.0f, rough = c.alpha >= static_cast<float>(kSmallestAlpha);
  const double r = (c.ior - 1.0) / (c.ior + 1.0), f90 = c.specular;
  const dvec3 f0 = f90 * glm::min(r * r * dvec3(c.specularColor), dvec3(1.0));
  const Layer o = layer(c.alpha, wo.z), i = layer(c.alpha, std::abs(wi.z)), mean = averages(c.alpha);
  const dvec3 h = glm::normalize(wo + wi);
  dvec3 f(0.0);

  // Multiple scattering by a layer, and the fraction of light that passes the layer.
  const auto multiple = [&](double a, double b) { return multipleFactor(a, b, mean.lost); };
  const double multipleShape = o.lost * i.lost / (kPi * mean.lost);
  const auto passed = [&](const Layer& l) {
    const double low = largest(f0);
    return 1.0 - low * (1.0 - l.lost - l.schlick) - f90 * l.schlick - multiple(low, f90) * l.lost;
  };
  // Factors of the sheen for the lobes below: 1 - strength albedo for both directions, on sides with a sheen.
  const double strength = largest(c.sheenColor), sheenAlpha = std::max(double{c.sheenAlpha}, kSmallestAlpha);
  const bool sheenAtO = !solid || c.entering, sheenAtI = !solid || (wi.z > 0.0) == (c.entering != 0);
  const Sheen sheenO = sheen(sheenAlpha, wo.z), sheenI = sheen(sheenAlpha, std::abs(wi.z));
  const double underO = sheenAtO ? 1.0 - strength * std::min(sheenO.albedo, 1.0) : 1.0;
  const double underI = sheenAtI ? 1.0 - strength * std::min(sheenI.albedo, 1.0) : 1.0;
  const double translucent = c.diffuseTransmission;
  const dvec3 diffuseColor = wi.z > 0.0 ? (1.0 - translucent) * color : translucent * dvec3(c.diffuseTransmissionColor);
  dvec3 diffuse = opaque * diffuseColor * (passed(o) * passed(i) / (kPi * passed(mean))) * underO * underI;
  if (sheenAtO && sheenAtI) {
    const dvec3 products = sheenAverages(sheenAlpha, c.alpha);
    const double low = largest(f0);
    const double covered =
        (1.0 - low) * products.x + (low - multiple(low, f90)) * products.y + (low - f90) * products.z;
    diffuse /= 1.0 - strength * covered / passed(mean);
  }
  if (wi.z > 0.0) {
    if (rough) {
      const double shape = reflection(wo, wi, up, c.alpha), part = bends ? opaque : 1.0 - metal;
      f += shape * (metal * schlick(color, 1.0, glm::dot(wo, h)) + part * schlick(f0, f90, glm::dot(wo, h)));
      for (glm::length_t k = 0; k < 3; ++k)
        f[k] += multipleShape * (metal * multiple(color[k], 1.0) + part * multiple(f0[k], f90));
    }
  } else if (clear > 0.0 && c.thin && rough) {
    const dvec3 mirrored(wi.x, wi.y, -wi.z);
    const dvec3 m = glm::normalize(wo + mirrored);
    const double shape = reflection(wo, mirrored, up, c.alpha);
    f += clear * color *
         (shape * (1.0 - schlick(dvec3(largest(f0)), f90, glm::dot(wo, m)).x) +
          multipleShape * (1.0 - multiple(largest(f0), f90)));
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

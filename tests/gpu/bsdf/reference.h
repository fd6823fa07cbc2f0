// SPDX-License-Identifier: Apache-2.0
// A second implementation of the BSDF, in double precision and in the form of the papers: normalized half vectors,
// tangents, Smith's Lambda, polarized Fresnel. It shares only the albedo tables with the shader. albedo_test.cpp tests
// the tables.
#ifndef QUINTET_TESTS_GPU_BSDF_REFERENCE_H
#define QUINTET_TESTS_GPU_BSDF_REFERENCE_H

#include <vector>

#include "bsdf/bsdf_cases.h"

namespace quintet::test {

// A thin film between air and the base.
struct ReferenceFilm {
  double ior, thickness;  // thickness in nanometers
};
// Its reflectance. Belcour and Barla 2017, eq. 3, with the approximations of KHR_materials_iridescence.
glm::dvec3 referenceFilm(const ReferenceFilm& film, double cosine, const glm::dvec3& baseF0);

class ReferenceBsdf {
 public:
  // f(wo, wi) |cos wi| of all lobes that are not deltas; wo is the material's.
  glm::dvec3 eval(const BsdfCase& c, const glm::dvec3& wi) const;

 private:
  struct Layer {
    double lost, schlick;
  };
  Layer layer(double alpha, double cosine) const;
  Layer averages(double alpha) const;
  // The same with the widths of the base along x and y.
  Layer layer(const glm::dvec2& widths, const glm::dvec3& w) const;
  Layer averages(const glm::dvec2& widths) const;
  double filmExtra(const BsdfCase& c, double cosine) const;
  glm::dvec3 filmAverage(const BsdfCase& c, const glm::dvec3& baseF0) const;
  // KHR_materials_sheen over the other lobes.
  struct Sheen {
    double limit, albedo;
  };
  Sheen sheen(double alpha, double cosine) const;
  glm::dvec3 sheenAverages(double alpha, double baseAlpha) const;
  glm::dvec2 anisotropicGlass(const BsdfCase& c, const glm::dvec3& wo) const;
  glm::dvec2 glass(const BsdfCase& c, double cosine) const;
  glm::dvec3 refractive(const BsdfCase& c, const glm::dvec3& wo, const glm::dvec3& wi) const;

  std::vector<float> tables_ = render::computeAlbedoTables();
};

}  // namespace quintet::test
#endif

// SPDX-License-Identifier: Apache-2.0
// The importance sampling table of an environment (shared::EnvironmentData::table).
#ifndef QUINTET_RENDER_LIGHTS_ENVIRONMENT_TABLE_H
#define QUINTET_RENDER_LIGHTS_ENVIRONMENT_TABLE_H

#include "quintet/shared/lights.h"
#include "scene/model/scene.h"

#include <vector>

namespace quintet::render {

// Largest size of a table. The cells of a larger environment's table cover several texels.
inline constexpr std::uint32_t kMaxEnvironmentTableWidth = 4096;
inline constexpr std::uint32_t kMaxEnvironmentTableHeight = 2048;

struct EnvironmentTable {
  std::uint32_t width = 0;  // in cells; 0 means that the environment is always black
  std::uint32_t height = 0;
  std::vector<shared::AliasEntry> entries;  // in row-major order from the top
  // The same cells, by the luminance above its mean over the sphere; 0 elsewhere. For programs that combine light sampling with
  // BSDF sampling, which finds dim parts of the environment at least as well: Karlik et al. 2019, "MIS Compensation: Optimizing
  // Sampling Techniques in Multiple Importance Sampling". Empty if hardly anything is above the mean: use `entries`.
  std::vector<shared::AliasEntry> balanced;
  double integral = 0.0;  // ∫ luminance dω over the sphere, including the intensity; W/m² on a unit cross section
  double unscaledIntegral = 0.0;  // without the intensity
};

// Builds the table of the environment in use; `environment.present` is ignored. A constant environment has one cell.
// The texture must be sampled bilinearly, repeated in u and clamped in v: the weight of a cell is the mean of the
// luminance that is interpolated this way, times the cell's solid angle. Each direction with nonzero interpolated
// radiance therefore has a positive density. Negative samples and NaN count as 0, larger ones than scene::kMaxRadiance as that.
EnvironmentTable buildEnvironmentTable(const scene::Environment& environment);

}  // namespace quintet::render
#endif

// The importance table of an environment (shared::EnvironmentData::table).
#ifndef QUINTET_RENDER_ENVIRONMENT_TABLE_H
#define QUINTET_RENDER_ENVIRONMENT_TABLE_H

#include "quintet/shared/lights.h"
#include "scene/scene.h"

#include <vector>

namespace quintet::render {

// Larger environments get a table of this size, whose cells cover several texels.
inline constexpr std::uint32_t kMaxEnvironmentTableWidth = 4096;
inline constexpr std::uint32_t kMaxEnvironmentTableHeight = 2048;

struct EnvironmentTable {
  std::uint32_t width = 0;  // cells; 0: nothing to sample (black)
  std::uint32_t height = 0;
  std::vector<shared::AliasEntry> entries;  // row by row from the top
  double integral = 0.0;  // ∫ luminance dω over the sphere, intensity included: W/m² on a unit cross section
};

// A constant environment has one cell. `present` is not looked at: pass the environment in use. The
// texture must be sampled bilinearly, repeated in u and clamped in v: a cell's weight is the mean of the
// so interpolated luminance over it, times its solid angle; hence each direction whose interpolated radiance
// is not zero has a density above zero. Negative and NaN samples count as 0, infinite ones as 1e30.
EnvironmentTable buildEnvironmentTable(const scene::Environment& environment);

}  // namespace quintet::render
#endif

// SPDX-License-Identifier: Apache-2.0
// Tables of directional albedos for quintet/bsdf (Frame::albedoTables). Their layout is in quintet/shared/albedo.h.
#ifndef QUINTET_RENDER_SCENE_ALBEDO_TABLES_H
#define QUINTET_RENDER_SCENE_ALBEDO_TABLES_H

#include <vector>

namespace quintet::render {

// Computes kAlbedoFloatCount floats, which do not depend on the scene; about 30 ms on two cores.
std::vector<float> computeAlbedoTables();
// Returns the tables of this process, which are computed on the first call.
const std::vector<float>& albedoTables();

}  // namespace quintet::render
#endif

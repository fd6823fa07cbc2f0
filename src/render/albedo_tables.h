// The directional albedos that quintet/bsdf needs (Frame::albedoTables; layout: quintet/shared/albedo.h).
#ifndef QUINTET_RENDER_ALBEDO_TABLES_H
#define QUINTET_RENDER_ALBEDO_TABLES_H

#include <vector>

namespace quintet::render {

// kAlbedoFloatCount floats, the same at each call; some 10 ms of work on two cores. No scene in it: once
// per process will do.
std::vector<float> computeAlbedoTables();
// Those of this process: computed by whoever asks first.
const std::vector<float>& albedoTables();

}  // namespace quintet::render
#endif

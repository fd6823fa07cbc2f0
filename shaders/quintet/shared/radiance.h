// SPDX-License-Identifier: Apache-2.0
// Largest radiance of surfaces and of the environment, after textures and factors, so that sums over samples stay finite. The same
// as scene::kMaxRadiance (src/scene/model/limits.h).
#ifndef QUINTET_SHARED_RADIANCE_H
#define QUINTET_SHARED_RADIANCE_H

#include "types.h"

QT_SHARED_BEGIN

#ifdef __cplusplus
inline constexpr float kMaxRadiance = 1e12f;
#else
const float kMaxRadiance = 1e12;
#endif

QT_SHARED_END

#endif

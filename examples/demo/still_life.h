// SPDX-License-Identifier: Apache-2.0
// The scene of `make demo` and of the image at the top of README.
#ifndef QUINTET_DEMO_STILL_LIFE_H
#define QUINTET_DEMO_STILL_LIFE_H

#include <cstddef>
#include <vector>

#include "demo/sky.h"

namespace quintet::demo {

struct StillLifeSettings {
  std::uint32_t oakTextureSize = 2048;
  std::uint32_t textureSize = 1024;
};

// demo.glb: camera "hero", 16:9.
std::vector<std::byte> stillLife(const StillLifeSettings& settings = {});

// The sky that lights it.
SkySettings stillLifeSky();

}  // namespace quintet::demo
#endif

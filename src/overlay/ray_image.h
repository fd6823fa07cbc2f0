// SPDX-License-Identifier: Apache-2.0
// An image of a render with the rays of an explained pixel over it.
#ifndef QUINTET_OVERLAY_RAY_IMAGE_H
#define QUINTET_OVERLAY_RAY_IMAGE_H

#include <filesystem>

#include "gpu/context.h"
#include "io/image.h"
#include "job/depth_map.h"
#include "job/pixel_explanation.h"
#include "scene/model/scene.h"

namespace quintet::overlay {

// Throws Error if the program did not use the camera of the scene for the explained pixel: rays cannot be drawn over
// its image.
void requireSceneCamera(const job::PixelExplanation& explanation, const scene::Camera& camera);

// Draws over `image`: 8 bits per sample, sRGB, opaque, seen by the camera of `depth`, which has the depths of its pixels.
// `caches`: job::EngineOptions::caches. Blocks. Throws Error as gpu::requireGraphicsQueue() does, and gpu errors.
io::Image drawRays(gpu::Context& context, const job::PixelExplanation& explanation, const job::DepthMap& depth,
                   const io::Image& image, const std::filesystem::path& caches);

}  // namespace quintet::overlay
#endif

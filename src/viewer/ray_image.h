// SPDX-License-Identifier: Apache-2.0
// An image of a render with the rays of an explained pixel over it.
#ifndef QUINTET_VIEWER_RAY_IMAGE_H
#define QUINTET_VIEWER_RAY_IMAGE_H

#include <cstddef>
#include <filesystem>
#include <optional>

#include "io/image.h"
#include "job/engine.h"
#include "job/pixel_explanation.h"
#include "job/render_job.h"

namespace quintet::viewer {

// Throws Error if the program did not use the camera of the scene for the explained pixel: rays cannot be drawn over
// its image.
void requireSceneCamera(const job::PixelExplanation& explanation, const scene::Camera& camera);

// Draws over `image`, which the job rendered: 8 bits per sample, sRGB, of the whole image. `caches`:
// job::EngineOptions::caches. Traces the depths of the first surfaces with the job's scene. Blocks. Throws Error if the
// device has no graphics queue, and as job::renderDepthMap() does.
io::Image drawRays(job::Engine& engine, job::RenderJob& job, const job::PixelExplanation& explanation,
                   const io::Image& image, const std::filesystem::path& caches);

}  // namespace quintet::viewer
#endif

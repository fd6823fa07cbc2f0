// SPDX-License-Identifier: Apache-2.0
// Draws lines over an image in host memory.
#ifndef QUINTET_OVERLAY_LINE_IMAGE_H
#define QUINTET_OVERLAY_LINE_IMAGE_H

#include <cstdint>
#include <memory>
#include <vector>

#include "base/math.h"
#include "gpu/context.h"
#include "gpu/present/line_list.h"
#include "io/image.h"
#include "overlay/window_shaders.h"

namespace quintet::overlay {

// Returns a copy of `image` (8 bits per sample, sRGB, opaque) with the lines. `depths` has `depthSize` values
// (gpu::LineRenderer::setDepth); null: nothing hides lines. `shaders`: compileLineShaders(). Blocks. Throws Error if
// the device has no graphics queue, and gpu errors.
io::Image drawLines(gpu::Context& context, const WindowShaders& shaders, const io::Image& image,
                    const gpu::LineList& list, uvec2 depthSize, std::shared_ptr<const std::vector<float>> depths);

}  // namespace quintet::overlay
#endif

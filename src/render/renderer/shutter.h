// SPDX-License-Identifier: Apache-2.0
// Motion blur: the times of the samples of a pixel.
//
// Vulkan has no moving geometry without extensions of vendors, so all invocations of a launch see one pose of the scene.
// Sample i of every pixel therefore shows the same time. It is the radical inverse of i in base 2 (van der Corput 1935),
// shifted by a number that depends on the seed (Cranley and Patterson 1976), for these reasons:
//  * It depends on the index and the seed only, so the parts of a render have the same times as the whole render.
//  * Each aligned range of 2^k samples, such as a batch, has one time in each of 2^k equal parts of the interval, so any
//    number of samples covers it.
//  * For a random seed, each time is uniform in the interval, so the estimate of each pixel is unbiased.
//  * Samplers shuffle the order of the samples for each draw (quintet/sampling/sobol.glsl), so a time does not determine
//    where in the pixel, on the lens or on a light its sample is.
#ifndef QUINTET_RENDER_RENDERER_SHUTTER_H
#define QUINTET_RENDER_RENDERER_SHUTTER_H

#include <cstdint>

namespace quintet::render {

// The time during which a shutter is open, in frames of the animation (scene::Pose::frame).
struct ShutterInterval {
  double open = 0;
  double close = 0;  // above `open`

  double middle() const { return 0.5 * (open + close); }
  bool operator==(const ShutterInterval&) const = default;
};

// Time of the sample with this index, in frames: in [open, close).
double sampleTime(const ShutterInterval& shutter, std::uint32_t sample, std::uint32_t seed);

}  // namespace quintet::render
#endif

#include "io/convolve.h"

#include <algorithm>

#include "base/parallel.h"

namespace quintet::io {

Plane convolveRows(const Plane& in, const Kernel& kernel) {
  Plane out(in.width, in.height);
  const std::size_t radius = kernel.size() / 2;
  parallelFor(in.height, [&](std::size_t y) {
    std::vector<float> padded(in.width + 2 * radius);
    const float* from = in.row(y);
    std::fill_n(padded.begin(), radius, from[0]);
    std::copy_n(from, in.width, padded.data() + radius);
    std::fill_n(padded.end() - static_cast<std::ptrdiff_t>(radius), radius, from[in.width - 1]);
    float* to = out.row(y);
    for (std::size_t i = 0; i < kernel.size(); ++i)
      for (std::size_t x = 0; x < in.width; ++x) to[x] += kernel[i] * padded[x + i];
  });
  return out;
}

Plane convolveColumns(const Plane& in, const Kernel& kernel) {
  Plane out(in.width, in.height);
  const std::size_t radius = kernel.size() / 2;
  parallelFor(in.height, [&](std::size_t y) {
    float* to = out.row(y);
    for (std::size_t i = 0; i < kernel.size(); ++i) {
      const std::size_t below = y + i < radius ? 0 : y + i - radius;
      const float* from = in.row(std::min(below, in.height - 1));
      for (std::size_t x = 0; x < in.width; ++x) to[x] += kernel[i] * from[x];
    }
  });
  return out;
}

}  // namespace quintet::io

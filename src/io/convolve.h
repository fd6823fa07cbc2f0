// Private to src/io: one-dimensional convolutions of float planes; pixels beyond the border repeat it.
#ifndef QUINTET_IO_CONVOLVE_H
#define QUINTET_IO_CONVOLVE_H

#include <cstddef>
#include <vector>

namespace quintet::io {

struct Plane {
  Plane(std::size_t planeWidth, std::size_t planeHeight)
      : width(planeWidth), height(planeHeight), values(planeWidth * planeHeight) {}
  float* row(std::size_t y) { return values.data() + y * width; }
  const float* row(std::size_t y) const { return values.data() + y * width; }

  std::size_t width;
  std::size_t height;
  std::vector<float> values;
};

// 2 r + 1 weights; kernel[r] is the centre. Out(x) = Σ kernel[r + i] in(x + i).
using Kernel = std::vector<float>;

Plane convolveRows(const Plane& in, const Kernel& kernel);
Plane convolveColumns(const Plane& in, const Kernel& kernel);

}  // namespace quintet::io
#endif

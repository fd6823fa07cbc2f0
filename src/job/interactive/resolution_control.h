// SPDX-License-Identifier: Apache-2.0
// Chooses the resolution of images while something moves, so that they appear at a target rate.
#ifndef QUINTET_JOB_INTERACTIVE_RESOLUTION_CONTROL_H
#define QUINTET_JOB_INTERACTIVE_RESOLUTION_CONTROL_H

#include "base/math.h"

namespace quintet::job::interactive {

class ResolutionControl {
 public:
  // `updatesPerSecond`: > 0
  explicit ResolutionControl(double updatesPerSecond) : target_(1.0 / updatesPerSecond) {}

  // One sample of each pixel took this time at this factor.
  void measured(unsigned factor, double seconds);

  // By which width and height are divided: 1, 2, 3, 4, 6, 8, 12 or 16. 8 before the first measurement.
  unsigned factor() const { return factor_; }

 private:
  double target_;  // seconds per image
  unsigned factor_ = 8;
};

// The next factor of an image that becomes sharper in steps: about half of `factor`, which is above 1. Each step takes
// four to nine times as long.
unsigned finerFactor(unsigned factor);

// Rounded up, so that no side is 0.
uvec2 reducedSize(uvec2 size, unsigned factor);

}  // namespace quintet::job::interactive
#endif

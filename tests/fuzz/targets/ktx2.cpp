// SPDX-License-Identifier: Apache-2.0
// KTX2 images.
#include "image_target.h"

namespace quintet::fuzz {

void readInput(Input input) { readImageInput(input); }

}  // namespace quintet::fuzz

// SPDX-License-Identifier: Apache-2.0
// JPEG images.
#include "image_target.h"

namespace quintet::fuzz {

void readInput(Input input) { readImageInput(input); }

}  // namespace quintet::fuzz

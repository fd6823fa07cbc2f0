// SPDX-License-Identifier: Apache-2.0
// What the targets that read images share.
#ifndef QUINTET_TESTS_FUZZ_IMAGE_TARGET_H
#define QUINTET_TESTS_FUZZ_IMAGE_TARGET_H

#include "target.h"

namespace quintet::fuzz {

// Reads the header, the metadata and the pixels of an image, and reports contradictions between them.
void readImageInput(Input input);

}  // namespace quintet::fuzz
#endif

// SPDX-License-Identifier: Apache-2.0
// Zip files that a page imports. What was read is the same after it was written.
#include "lab/zip.h"
#include "target.h"

namespace quintet::fuzz {

void readInput(Input input) {
  acceptErrors([&] {
    const auto files = lab::unzipFiles(textOf(input));
    if (lab::unzipFiles(lab::zipFiles(files)) != files) reportFinding("the files differ after they were written");
  });
}

}  // namespace quintet::fuzz

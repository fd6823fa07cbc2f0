// SPDX-License-Identifier: Apache-2.0
// OpenEXR files: as images, by layer, with all channels, and only their headers.
#include "io/exr/exr.h"

#include "base/memory_budget.h"
#include "image_target.h"

namespace quintet::fuzz {

void readInput(Input input) {
  if (!io::isOpenExr(input)) return;
  readImageInput(input);
  acceptErrors([&] {
    for (const io::ExrPartInfo& part : io::inspectExr(input, "image"))
      for (const io::ExrPartInfo::Channel& channel : part.channels)
        acceptErrors([&] {
          MemoryBudget budget("image", kMaxMemory);
          io::decodeExrLayer(input, "image", channel.name, budget);
        });
  });
  acceptErrors([&] {
    MemoryBudget budget("image", kMaxMemory);
    const io::ExrImage image = io::decodeExr(input, "image", budget);
    for (const io::ExrChannel& channel : image.channels)
      if (channel.samples.size() != std::size_t{image.width} * image.height)
        reportFinding("a channel has a wrong number of samples");
  });
}

}  // namespace quintet::fuzz

// SPDX-License-Identifier: Apache-2.0
#include "image_target.h"

#include <optional>

#include "base/memory_budget.h"
#include "io/codec.h"

namespace quintet::fuzz {
namespace {

constexpr const char* kName = "image";

// PNG stores integers with straight alpha without loss.
void checkRoundTrip(const io::Image& image) {
  constexpr std::size_t kMaxBytes = 1 << 16;  // encoding takes much longer than decoding
  if (image.type == io::PixelType::f32 || image.premultiplied || image.data.size() > kMaxBytes) return;
  if (io::decodeImage(io::encodePng(image), kName).data != image.data)
    reportFinding("the image changes when it is written and read");
}

}  // namespace

void readImageInput(Input input) {
  acceptErrors([&] { io::readMetadata(input, kName); });
  std::optional<io::ImageInfo> info;
  acceptErrors([&] { info = io::probeImage(input, kName); });
  acceptErrors([&] {
    MemoryBudget budget(kName, kMaxMemory);
    const io::Image image = io::decodeImage(input, kName, budget);
    if (image.data.size() != image.rowBytes() * image.height) reportFinding("the image has a wrong number of bytes");
    if (!info) reportFinding("the image is valid, but not its header");
    if (info->width != image.width || info->height != image.height || info->channels != image.channels ||
        info->type != image.type)
      reportFinding("the header differs from the image");
    checkRoundTrip(image);
  });
}

}  // namespace quintet::fuzz

// SPDX-License-Identifier: Apache-2.0
#include "io/codec.h"

#include <algorithm>
#include <array>
#include <new>

#include "base/error.h"
#include "base/file.h"
#include "base/memory_budget.h"
#include "base/text.h"
#include "io/formats.h"

namespace quintet::io {
namespace {

constexpr std::array<const Format*, 6> kFormats{&kPng, &kJpeg, &kWebp, &kHdr, &kExr, &kKtx2};

const Format& findFormat(const Source& source) {
  for (const Format* format : kFormats)
    if (format->matches(source)) return *format;
  source.fail(source.size() == 0 ? "the image is empty"
                                 : "not a supported image (PNG, JPEG, WebP, Radiance HDR, OpenEXR, KTX2)");
}

// Runs read(format). An image within the limits can still exceed the available memory.
template <class Read>
auto withFormat(const Source& source, Read&& read) {
  try {
    return read(findFormat(source));
  } catch (const std::bad_alloc&) {
    source.fail("not enough memory for the image");
  }
}

std::string lowerExtension(const std::filesystem::path& file) { return lowerCase(file.extension().string()); }

}  // namespace

Image decodeImage(std::span<const std::byte> bytes, const std::string& nameForErrors) {
  MemoryBudget budget(nameForErrors, 0, Remedy::none);
  return decodeImage(bytes, nameForErrors, budget);
}

Image decodeImage(std::span<const std::byte> bytes, const std::string& nameForErrors, MemoryBudget& budget) {
  const Source source{bytes, nameForErrors};
  return withFormat(source, [&](const Format& format) {
    const ImageInfo info = format.probe(source);
    budget.take(info.byteCount());
    const TemporaryMemory temporary(budget, info.temporaryBytes);
    return format.decode(source);
  });
}

Image readImage(const std::filesystem::path& file) {
  MemoryBudget budget(file, 0, Remedy::none);
  return readImage(file, budget);
}

Image readImage(const std::filesystem::path& file, MemoryBudget& budget) {
  const std::vector<std::byte> bytes = readFile(file, budget);
  Image image = decodeImage(bytes, file.string(), budget);
  budget.giveBack(bytes.size());
  return image;
}

Image readRadiance(const std::filesystem::path& file, MemoryBudget& budget) {
  Image image = readImage(file, budget);
  if (image.type == PixelType::f32 && image.encoding == ColorEncoding::linear) return image;
  budget.take(image.sampleCount() * sizeof(float));
  Image radiance = toFloat(image);
  budget.giveBack(image.data.size());
  return radiance;
}

ImageInfo probeImage(std::span<const std::byte> bytes, const std::string& nameForErrors) {
  const Source source{bytes, nameForErrors};
  return withFormat(source, [&](const Format& format) {
    ImageInfo info = format.probe(source);
    info.format = format.name;
    return info;
  });
}

Metadata readMetadata(std::span<const std::byte> bytes, const std::string& nameForErrors) {
  const Source source{bytes, nameForErrors};
  return withFormat(source,
                    [&](const Format& format) { return format.metadata ? format.metadata(source) : Metadata{}; });
}

void writeImage(const std::filesystem::path& file, const Image& image, const Metadata& metadata) {
  const std::string extension = file == "-" ? ".png" : lowerExtension(file);
  if (extension == ".png") {
    const bool encodable = image.type != PixelType::f32 && !(image.premultiplied && image.hasAlpha());
    writeFile(file, encodePng(encodable ? image : toSrgb8(image), metadata));
  } else if (extension == ".exr") {
    writeFile(file, encodeExr(image, metadata));
  } else if (extension == ".hdr") {
    writeFile(file, encodeHdr(image));
  } else {
    throw UsageError(file.string() + ": unknown image format; available: .png, .exr, .hdr");
  }
}

}  // namespace quintet::io

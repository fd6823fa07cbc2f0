// SPDX-License-Identifier: Apache-2.0
// Describes the parts of an OpenEXR file from its headers.
#include <ImfTileDescription.h>

#include <string>
#include <vector>

#include "io/exr/attributes.h"
#include "io/exr/exr.h"
#include "io/exr/read.h"

namespace quintet::io {
namespace {

std::string compressionText(const Imf::Header& header) {
  switch (header.compression()) {
    case Imf::NO_COMPRESSION: return "none";
    case Imf::RLE_COMPRESSION: return "rle";
    case Imf::ZIPS_COMPRESSION: return "zips";
    case Imf::ZIP_COMPRESSION: return "zip";
    case Imf::PIZ_COMPRESSION: return "piz";
    case Imf::PXR24_COMPRESSION: return "pxr24";
    case Imf::B44_COMPRESSION: return "b44";
    case Imf::B44A_COMPRESSION: return "b44a";
    case Imf::DWAA_COMPRESSION: return "dwaa";
    case Imf::DWAB_COMPRESSION: return "dwab";
    default: return "unknown";
  }
}

ExrPartInfo::Window window(const Imath::Box2i& box) {
  return {box.min.x, box.min.y, extent(box.min.x, box.max.x), extent(box.min.y, box.max.y)};
}

ExrPartInfo describePart(const Imf::Header& header) {
  ExrPartInfo part;
  if (header.hasName()) part.name = header.name();
  part.compression = compressionText(header);
  if (header.hasTileDescription()) {
    part.tileWidth = header.tileDescription().xSize;
    part.tileHeight = header.tileDescription().ySize;
  }
  part.deep = !isFlat(header);
  part.data = window(header.dataWindow());
  part.display = window(header.displayWindow());
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it)
    part.channels.push_back({it.name(), storedType(it.channel().type)});
  part.attributes = describeAttributes(header);
  return part;
}

}  // namespace

bool isOpenExr(std::span<const std::byte> bytes) {
  const std::string name;
  return isExr({bytes, name});
}

std::vector<ExrPartInfo> inspectExr(std::span<const std::byte> bytes, const std::string& nameForErrors) {
  const Source source{bytes, nameForErrors};
  if (!isExr(source)) source.fail("not an OpenEXR file");
  return withExrFile(source, [](Imf::MultiPartInputFile& file) {
    std::vector<ExrPartInfo> parts;
    for (int part = 0; part < file.parts(); ++part) parts.push_back(describePart(file.header(part)));
    return parts;
  });
}

}  // namespace quintet::io

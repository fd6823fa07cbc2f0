// SPDX-License-Identifier: Apache-2.0
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfTiledOutputFile.h>

#include <cstring>

#include "io/samples.h"

namespace quintet::io::test {
namespace {

class Stream : public Imf::OStream {
 public:
  Stream() : Imf::OStream("memory") {}
  void write(const char from[], int count) override {
    const auto size = static_cast<std::size_t>(count);
    if (at + size > bytes.size()) bytes.resize(at + size);
    std::memcpy(bytes.data() + at, from, size);
    at += size;
  }
  std::uint64_t tellp() override { return at; }
  void seekp(std::uint64_t position) override { at = position; }

  Bytes bytes;
  std::size_t at = 0;
};

// A channel whose sample at (x, y) of the data window is 100 y + x + offset.
struct Plane {
  Plane(const std::string& channelName, const Imath::Box2i& box, float offset) : name(channelName), window(box) {
    for (int y = box.min.y; y <= box.max.y; ++y)
      for (int x = box.min.x; x <= box.max.x; ++x) samples.push_back(static_cast<float>(100 * y + x) + offset);
  }
  void addTo(Imf::FrameBuffer& buffers) const {
    buffers.insert(name, Imf::Slice::Make(Imf::FLOAT, samples.data(), window));
  }

  std::string name;
  Imath::Box2i window;
  std::vector<float> samples;
};

Imf::Header makeHeader(const Imath::Box2i& display, const Imath::Box2i& data,
                       const std::vector<std::string>& channels) {
  Imf::Header header(display, data);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const std::string& name : channels) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  return header;
}

std::vector<Plane> makePlanes(const Imf::Header& header) {
  std::vector<Plane> planes;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it)
    planes.emplace_back(it.name(), header.dataWindow(), 1000.0f * static_cast<float>(planes.size()));
  return planes;
}

Bytes writeTiles(Imf::Header header, Imf::LevelMode mode) {
  header.setTileDescription(Imf::TileDescription(4, 4, mode));
  const std::vector<Plane> planes = makePlanes(header);
  Stream stream;
  {
    Imf::TiledOutputFile file(stream, header, 0);
    Imf::FrameBuffer buffers;
    for (const Plane& plane : planes) plane.addTo(buffers);
    file.setFrameBuffer(buffers);
    for (int level = 0; level < file.numLevels(); ++level)
      file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
  }
  return stream.bytes;
}

Bytes writeLines(const Imf::Header& header) {
  const std::vector<Plane> planes = makePlanes(header);
  Stream stream;
  {
    Imf::OutputFile file(stream, header, 0);
    Imf::FrameBuffer buffers;
    for (const Plane& plane : planes) plane.addTo(buffers);
    file.setFrameBuffer(buffers);
    file.writePixels(header.dataWindow().size().y + 1);
  }
  return stream.bytes;
}

// Writes a part with depth channels, which are no image, and a part with colors.
Bytes writeParts(const Imath::Box2i& box) {
  std::vector<Imf::Header> headers{makeHeader(box, box, {"Z"}), makeHeader(box, box, {"R", "G", "B"})};
  headers[0].channels().insert("Z2", Imf::Channel(Imf::FLOAT));
  for (std::size_t i = 0; i < 2; ++i) {
    headers[i].setName(i == 0 ? "depth" : "color");
    headers[i].setType(Imf::SCANLINEIMAGE);
  }
  Stream stream;
  {
    Imf::MultiPartOutputFile file(stream, headers.data(), 2);
    for (int i = 0; i < 2; ++i) {
      const std::vector<Plane> planes = makePlanes(file.header(i));
      Imf::FrameBuffer buffers;
      for (const Plane& plane : planes) plane.addTo(buffers);
      Imf::OutputPart part(file, i);
      part.setFrameBuffer(buffers);
      part.writePixels(box.size().y + 1);
    }
  }
  return stream.bytes;
}

}  // namespace

Bytes makeExr(ExrKind kind) {
  const Imath::Box2i box({0, 0}, {9, 5});
  switch (kind) {
    case ExrKind::tiled: return writeTiles(makeHeader(box, box, {"R", "G", "B"}), Imf::ONE_LEVEL);
    case ExrKind::mipmapped: return writeTiles(makeHeader(box, box, {"Y"}), Imf::MIPMAP_LEVELS);
    case ExrKind::offsetWindows:
      return writeLines(makeHeader({{10, 20}, {14, 23}}, {{8, 21}, {12, 30}}, {"R", "G", "B", "A"}));
    case ExrKind::layers: return writeLines(makeHeader(box, box, {"Z", "view.A", "view.B", "view.G", "view.R"}));
    case ExrKind::multiPart: return writeParts(box);
    case ExrKind::piz: break;
  }
  Imf::Header header = makeHeader(box, box, {"Y"});
  header.compression() = Imf::PIZ_COMPRESSION;
  return writeLines(header);
}

}  // namespace quintet::io::test

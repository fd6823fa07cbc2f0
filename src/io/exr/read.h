// SPDX-License-Identifier: Apache-2.0
// Private to src/io: reads channels of one part of an OpenEXR file. OpenEXR allocates memory as its header states
// (attribute sizes, windows, tiles, chunk counts), so these numbers are first compared with the size of the file.
// Exceptions of OpenEXR become FileErrors.
#ifndef QUINTET_IO_EXR_READ_H
#define QUINTET_IO_EXR_READ_H

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfMultiPartInputFile.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/error.h"
#include "io/exr/exr.h"
#include "io/formats.h"

namespace quintet::io {

// OpenEXR's input stream over memory.
class ExrReadStream : public Imf::IStream {
 public:
  explicit ExrReadStream(const Source& source) : Imf::IStream(source.name.c_str()), source_(source) {}

  bool read(char to[], int count) override {
    if (count < 0 || at_ > source_.size() || static_cast<std::size_t>(count) > source_.size() - at_) {
      ended_ = true;
      throw std::runtime_error("data ends early");
    }
    std::memcpy(to, source_.data() + at_, static_cast<std::size_t>(count));
    at_ += static_cast<std::size_t>(count);
    return at_ < source_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t position) override { at_ = position; }
  // Whether a read went beyond the end of the data.
  bool ended() const { return ended_; }

 private:
  const Source& source_;
  std::uint64_t at_ = 0;
  bool ended_ = false;
};

// Returns whether the bytes start with the magic number of OpenEXR.
bool isExr(const Source& source);

// Throws FileError for a header that is truncated or that declares impossible sizes.
void checkExrHeader(const Source& source);

[[noreturn]] void failBroken(const Source& source, bool ended, const std::exception& error);

// Calls use(file) and converts exceptions of OpenEXR to FileErrors.
template <class Use>
auto withExrFile(const Source& source, Use&& use) {
  checkExrHeader(source);
  ExrReadStream stream(source);
  try {
    Imf::MultiPartInputFile file(stream, 0);
    return use(file);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    failBroken(source, stream.ended(), error);
  }
}

// Returns the width or height of a window.
std::uint32_t extent(int min, int max);
ExrType storedType(Imf::PixelType type);
bool isFlat(const Imf::Header& header);
std::vector<std::string> channelNames(const Imf::Header& header);
// Returns the name of a channel in decodeExr: a channel without a layer in a later, named part gets the part's name as
// its layer.
std::string fullChannelName(const Imf::Header& header, bool firstPart, const std::string& channel);

// Throws FileError if these channels of a part cannot be read or need more than `maxBytes` as floats.
void checkChannels(const Source& source, const Imf::Header& header, const std::vector<std::string>& names,
                   std::uint64_t maxBytes);

// Bytes that readChannels() allocates for this many channels of a part.
std::size_t channelBytes(const Imf::Header& header, std::size_t count);

// Reads the channels in this order, cropped and padded with 0 to the display window. Call checkChannels first.
std::vector<ExrChannel> readChannels(const Source& source, Imf::MultiPartInputFile& file, int part,
                                     const std::vector<std::string>& names);

}  // namespace quintet::io
#endif

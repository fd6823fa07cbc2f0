// Private to src/io: reading channels of one part of an OpenEXR file. OpenEXR's exceptions end here.
#ifndef QUINTET_IO_EXR_READER_H
#define QUINTET_IO_EXR_READER_H

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>

#include <new>

#include "base/error.h"
#include "io/exr.h"
#include "io/exr_header.h"
#include "io/exr_stream.h"

namespace quintet::io {

[[noreturn]] void failBroken(const Source& source, bool ended, const std::exception& error);

// Runs use(file) and turns what OpenEXR throws into a FileError.
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

// Width or height of a window.
std::uint32_t extent(int min, int max);
ExrType storedType(Imf::PixelType type);
bool isFlat(const Imf::Header& header);
std::vector<std::string> channelNames(const Imf::Header& header);

// Fails if these channels of a part cannot be read, or would take more than `maxBytes` as floats.
void checkChannels(const Source& source, const Imf::Header& header, const std::vector<std::string>& names,
                   std::uint64_t maxBytes);

// The channels in this order, cropped and padded with 0 to the display window; call checkChannels before.
std::vector<ExrChannel> readChannels(const Source& source, Imf::MultiPartInputFile& file, int part,
                                     const std::vector<std::string>& names);

}  // namespace quintet::io
#endif

// Private to src/io: what cannot be written as OpenEXR.
#ifndef QUINTET_IO_EXR_CHECK_H
#define QUINTET_IO_EXR_CHECK_H

#include "io/exr.h"

namespace quintet::io {

inline constexpr std::uint64_t kMaxPictureBytes =
    std::uint64_t{4} * kMaxImageBytes;  // all channels of a file, as floats
inline constexpr std::size_t kMaxExrChannels = 1024;

// Throw UsageError: one clear line.
void checkExrPicture(const ExrPicture& picture);
void checkExrOptions(const ExrPicture& picture, const ExrOptions& options);

// The picture's place, also where it is all of the display window.
ExrPlace wholePlace(const ExrPicture& picture);

}  // namespace quintet::io
#endif

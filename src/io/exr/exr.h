// SPDX-License-Identifier: Apache-2.0
// OpenEXR files with any layers and channels: AOVs, Cryptomatte, data. codec.h handles images of up to four channels.
#ifndef QUINTET_IO_EXR_EXR_H
#define QUINTET_IO_EXR_EXR_H

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/math.h"
#include "io/image.h"

namespace quintet {
class MemoryBudget;
}

namespace quintet::io {

// Stored type of a channel. Compositing programs convert u32 to floats.
enum class ExrType : std::uint8_t { half, f32, u32 };

struct ExrChannel {
  std::string name;  // "R" or "layer.R"; unique in the image
  ExrType type = ExrType::half;
  std::vector<float> samples;  // height · width, rows top to bottom
  // Data that no compression may change. DWA decides by the last part of the name: R, G, B, Y, RY and BY lose bits even
  // as floats, for example "normal.Y".
  bool exact = false;
  // Replaces `samples`, which are exact only up to 2^24, for u32. Decoding fills both.
  std::vector<std::uint32_t> integers = {};
};

// Position of a region in the whole image: the data window inside the display window.
struct ExrWindow {
  std::uint32_t x = 0, y = 0;           // of the region's top left pixel
  std::uint32_t width = 0, height = 0;  // of the whole image; 0 if the region is the whole image
};

struct ExrRational {
  std::int32_t numerator = 0;
  std::uint32_t denominator = 1;
  bool operator==(const ExrRational&) const = default;
};
// CIE xy of the primaries and the white point; by default those of Rec. 709 and sRGB.
struct ExrChromaticities {
  vec2 red{0.64f, 0.33f}, green{0.30f, 0.60f}, blue{0.15f, 0.06f}, white{0.3127f, 0.3290f};
  bool operator==(const ExrChromaticities&) const = default;
};
using ExrValue = std::variant<std::string, std::int32_t, float, double, vec2, vec3, mat4, std::vector<std::string>,
                              ExrRational, ExrChromaticities>;

// The rate of frames, above 0, as a fraction: 24/1, and 24000/1001 for 23.976.
ExrRational exrFrameRate(double framesPerSecond);

// A mat4 is stored for row vectors, as readers of OpenEXR expect (worldToCamera, worldToNDC).
struct ExrAttribute {
  std::string name;
  ExrValue value;
};

struct ExrImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<ExrChannel> channels;
  Metadata metadata = {};  // string attributes; names that OpenEXR itself uses ("compression") are UsageErrors
  ExrWindow window = {};
  std::vector<ExrAttribute> attributes = {};  // of other types; the same rules apply to their names
};

enum class ExrCompression : std::uint8_t { none, rle, zips, zip, piz, dwaa, dwab };
const std::vector<std::string>& exrCompressionNames();  // in the order of the enumeration

inline constexpr std::size_t kMaxExrChannels = 1024;
inline constexpr std::uint32_t kMaxExrTile = 4096;                                // pixels per side
inline constexpr std::uint64_t kMaxExrBytes = std::uint64_t{4} * kMaxImageBytes;  // all channels of a file as floats

struct ExrOptions {
  ExrCompression compression = ExrCompression::zip;
  // zip, zips: 1 (fast) to 9 (small), default 4. dwaa, dwab: 0 (best quality) to 10 000, default 45. Invalid for
  // others.
  std::optional<float> level = {};
  std::uint32_t tileSize = 0;  // pixels per side, at most kMaxExrTile; 0 means scan lines
};

// Encodes one file. With a lossy compression (DWA) and `exact` channels it has two parts, "rgba" (lossy) and "data"
// (ZIP); the part that has channels without a layer comes first. Otherwise it has one part. Finite values outside the
// range of half are clamped to ±65504, and to ±60000 by DWA, which lowers values further where its quantization would make
// them infinite; if that does not suffice (levels far above the default), the part gets ZIP. No finite value reads back as
// infinity. u32 rounds `samples` to the nearest value in range. The same image gives the same bytes. Throws UsageError for inconsistent sizes, duplicate names, invalid levels and sizes above the limits of
// decodeExr.
std::vector<std::byte> encodeExr(const ExrImage& image, const ExrOptions& options = {});

// Throws the UsageError of encodeExr for such an image, so that a long job can fail before it starts.
void checkExrSize(std::uint32_t width, std::uint32_t height, std::size_t channels, std::uint32_t tileSize = 0);

// Decodes every channel of the flat parts, in alphabetical order within a part, cropped and padded with 0 to the
// display window, which must be the same for all parts. A channel without a layer in a later, named part gets the
// part's name as its layer. Throws FileError, also for subsampled channels and for files with only deep data.
ExrImage decodeExr(std::span<const std::byte> bytes, const std::string& nameForErrors);
ExrImage decodeExr(std::span<const std::byte> bytes, const std::string& nameForErrors, MemoryBudget&);

// Returns whether the bytes start with the magic number of OpenEXR.
bool isOpenExr(std::span<const std::byte> bytes);

struct ExrPartInfo {
  struct Channel {
    std::string name;
    ExrType type = ExrType::half;
  };
  struct Window {
    std::int32_t x = 0, y = 0;
    std::uint32_t width = 0, height = 0;
  };
  std::string name;  // empty if the file has one part
  std::string compression;
  std::uint32_t tileWidth = 0, tileHeight = 0;  // 0 for scan lines
  bool deep = false;
  Window data, display;
  std::vector<Channel> channels;
  struct Attribute {
    std::string name, type, text;
  };
  std::vector<Attribute> attributes;  // beyond those that every file has
};

// Describes the parts from the headers only. Throws FileError.
std::vector<ExrPartInfo> inspectExr(std::span<const std::byte> bytes, const std::string& nameForErrors);

// Returns "normal" for "normal.X" and an empty text for "R".
std::string_view exrLayerOf(std::string_view channel);

// Decodes one layer as linear floats: "" and "beauty" are R, G, B, A (or Y); "normal" is normal.X, .Y, .Z; "depth.Z" is
// that channel. Two channels become three with a last one of 0, because an image of two channels is gray and alpha.
// Throws UsageError for an unknown layer, and the FileErrors of decodeExr.
Image decodeExrLayer(std::span<const std::byte> bytes, const std::string& nameForErrors, const std::string& layer);
Image decodeExrLayer(std::span<const std::byte> bytes, const std::string& nameForErrors, const std::string& layer,
                     MemoryBudget&);

}  // namespace quintet::io
#endif

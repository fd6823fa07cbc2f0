// OpenEXR with any set of layers and channels: AOVs, Cryptomatte, data. codec.h has the simple form.
#ifndef QUINTET_IO_EXR_H
#define QUINTET_IO_EXR_H

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/math.h"
#include "io/codec.h"

namespace quintet::io {

// How a channel is stored. u32 is for readers that know it: compositing programs turn it into floats.
enum class ExrType : std::uint8_t { half, f32, u32 };

struct ExrChannel {
  std::string name;  // "R", or "layer.R"; unique in the picture
  ExrType type = ExrType::half;
  std::vector<float> samples;  // height · width, rows top to bottom
  // Data and not colour: comes back as it was, whatever the compression. DWA decides by the last part of the name:
  // R, G, B, Y, RY, BY lose bits even as floats, so "normal.Y" would.
  bool exact = false;
  // u32 only, in place of `samples`, which as floats are exact up to 2^24. Decoding fills both.
  std::vector<std::uint32_t> integers = {};
};

// Where the picture stands in a larger one: the data window inside the display window.
struct ExrPlace {
  std::uint32_t x = 0, y = 0;           // of the top left pixel
  std::uint32_t width = 0, height = 0;  // of the larger one; 0: the picture is all of it
};

using ExrValue = std::variant<std::string, std::int32_t, float, double, vec2, vec3, mat4, std::vector<std::string>>;

// mat4: for row vectors in the file, as OpenEXR's readers take it (worldToCamera, worldToNDC).
struct ExrAttribute {
  std::string name;
  ExrValue value;
};

struct ExrPicture {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<ExrChannel> channels;
  Metadata metadata = {};  // string attributes; a name that OpenEXR itself uses ("compression") is a UsageError
  ExrPlace place = {};
  std::vector<ExrAttribute> attributes = {};  // of other types; the same rules for names
};

enum class ExrCompression : std::uint8_t { none, rle, zips, zip, piz, dwaa, dwab };
const std::vector<std::string>& exrCompressionNames();  // in the order of the enumeration

inline constexpr std::uint32_t kMaxExrTile = 4096;

struct ExrOptions {
  ExrCompression compression = ExrCompression::zip;
  // zip, zips: 1 (fast) … 9 (small), default 4. dwaa, dwab: 0 (best) … 10 000, default 45. Others have none.
  std::optional<float> level = {};
  std::uint32_t tileSize = 0;  // pixels a side, at most kMaxExrTile; 0: scan lines
};

// One file. With a lossy compression (DWA) it has two parts if there are `exact` channels: "rgba", lossy, and "data",
// under ZIP, the one with channels without a layer first; else one. Finite values beyond half's range clamp to ±65504;
// u32 rounds `samples` to the nearest value in range. The same picture gives the same bytes. Throws UsageError (sizes that disagree, names used twice, levels
// that do not exist, more than a reader takes). To a file: writeFile (base/file.h), which replaces it in one step.
std::vector<std::byte> encodeExr(const ExrPicture& picture, const ExrOptions& options = {});

// Throws the UsageError that encodeExr would: lets a long job fail before it starts.
void checkExrSize(std::uint32_t width, std::uint32_t height, std::size_t channels, std::uint32_t tileSize = 0);

// Every channel of the flat parts, cropped and padded with 0 to the display window, which must be the same for all;
// alphabetical within a part. A channel without a layer in a later, named part takes the part's name as its layer.
// Throws FileError, also for subsampled channels and deep data.
ExrPicture decodeExr(std::span<const std::byte> bytes, const std::string& nameForErrors);

bool isOpenExr(std::span<const std::byte> bytes);  // by its first bytes

struct ExrPartInfo {
  struct Channel {
    std::string name;
    ExrType type = ExrType::half;
  };
  struct Window {
    std::int32_t x = 0, y = 0;
    std::uint32_t width = 0, height = 0;
  };
  std::string name;  // empty where the file has one part
  std::string compression;
  std::uint32_t tileWidth = 0, tileHeight = 0;  // 0: scan lines
  bool deep = false;
  Window data, display;
  std::vector<Channel> channels;
  struct Attribute {
    std::string name, type, text;
  };
  std::vector<Attribute> attributes;  // beyond those that every file has
};

// From the headers alone. Throws FileError.
std::vector<ExrPartInfo> inspectExr(std::span<const std::byte> bytes, const std::string& nameForErrors);

// "normal" of "normal.X"; empty for "R".
std::string_view exrLayerOf(std::string_view channel);

// One layer as linear floats: "" or "beauty" is R, G, B, A (or Y); "normal" is normal.X, .Y, .Z; "depth.Z" that channel alone.
// Two channels become three with a last one of 0, as a picture of two is grey and alpha. Throws UsageError with the
// nearest name for a layer that is not there, FileError as decodeExr.
Image decodeExrLayer(std::span<const std::byte> bytes, const std::string& nameForErrors, const std::string& layer);

}  // namespace quintet::io
#endif

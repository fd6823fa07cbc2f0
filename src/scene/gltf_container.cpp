// GLB, the binary container: glTF 2.0 section 4.4.
#include <fmt/format.h>

#include <cstring>

#include "base/error.h"
#include "scene/gltf_document.h"

namespace quintet::scene {
namespace {

constexpr std::uint32_t kMagic = 0x46546C67;   // "glTF"
constexpr std::uint32_t kJson = 0x4E4F534A;    // "JSON"
constexpr std::uint32_t kBinary = 0x004E4942;  // "BIN"
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::size_t kHeaderSize = 12;
constexpr std::size_t kChunkHeaderSize = 8;

std::uint32_t readU32(std::span<const std::byte> bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::to_integer<std::uint32_t>(bytes[offset + i]) << (8 * i);
  return value;
}

}  // namespace

Container splitContainer(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  const auto fail = [&](std::size_t offset, std::string_view problem) {
    throw FileError(file, fmt::format("byte {}", offset), problem);
  };
  if (bytes.empty()) fail(0, "the file is empty");
  if (bytes.size() < 4 || readU32(bytes, 0) != kMagic) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t first =
        text.find_first_not_of(text.starts_with(kByteOrderMark) ? "\xEF\xBB\xBF \t\r\n" : " \t\r\n");
    if (first == std::string_view::npos || text[first] != '{') fail(0, "this is neither a GLB nor a glTF JSON file");
    return {.json = text};
  }

  if (bytes.size() < kHeaderSize) fail(bytes.size(), "the file ends inside the GLB header");
  if (const std::uint32_t version = readU32(bytes, 4); version != 2)
    fail(4, fmt::format("GLB version {} is not supported, only 2", version));
  const std::size_t length = readU32(bytes, 8);
  if (length > bytes.size())
    fail(8, fmt::format("the header says {} bytes, but the file has {}", length, bytes.size()));
  if (length < kHeaderSize + kChunkHeaderSize) fail(8, fmt::format("a length of {} bytes is too small", length));

  Container result{.isGlb = true};
  std::size_t offset = kHeaderSize;
  for (int chunk = 0; offset < length; ++chunk) {
    if (length - offset < kChunkHeaderSize) fail(offset, "the file ends inside a chunk header");
    const std::size_t size = readU32(bytes, offset);
    const std::uint32_t type = readU32(bytes, offset + 4);
    const std::size_t begin = offset + kChunkHeaderSize;
    if (size > length - begin)
      fail(offset, fmt::format("the chunk is {} bytes longer than the file", size - (length - begin)));
    const auto data = bytes.subspan(begin, size);
    if (chunk == 0 && type != kJson) fail(offset, "the first chunk is not JSON");
    if (chunk > 0 && type == kJson) fail(offset, "there is a second JSON chunk");
    if (type == kJson) result.json = {reinterpret_cast<const char*>(data.data()), data.size()};
    if (type == kBinary) {
      if (result.binary.data()) fail(offset, "there is a second BIN chunk");
      result.binary = data;
    }
    // Chunks are padded to four bytes; the padding belongs to the size, so an odd one ends the file.
    offset = begin + std::min((size + 3) / 4 * 4, length - begin);
  }
  if (result.json.empty()) fail(kHeaderSize, "the JSON chunk is empty");
  return result;
}

}  // namespace quintet::scene

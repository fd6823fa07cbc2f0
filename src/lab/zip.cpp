// SPDX-License-Identifier: Apache-2.0
#include "lab/zip.h"

#include <zlib.h>

#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "lab/little_endian.h"

namespace quintet::lab {
namespace {

constexpr std::uint32_t kLocalSignature = 0x04034b50, kCentralSignature = 0x02014b50, kEndSignature = 0x06054b50;
constexpr std::size_t kLocalSize = 30, kCentralSize = 46, kEndSize = 22;
constexpr std::uint16_t kStored = 0, kDeflated = 8;
constexpr std::uint16_t kEncrypted = 1, kUtf8 = 1 << 11;
constexpr std::uint16_t kVersion = 20, kDate = (1 << 5) | 1;  // 2.0; 1980-01-01
constexpr const char* kName = "zip file";

std::uint32_t crcOf(std::string_view data) {
  return static_cast<std::uint32_t>(
      ::crc32(0, reinterpret_cast<const Bytef*>(data.data()), static_cast<uInt>(data.size())));
}

std::string deflated(std::string_view data) {
  z_stream stream{};
  if (::deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw MemoryError("not enough memory to compress a file");
  std::string out(::deflateBound(&stream, static_cast<uLong>(data.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(data.data()));
  stream.avail_in = static_cast<uInt>(data.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  ::deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  ::deflateEnd(&stream);
  return out;
}

std::string inflated(std::string_view data, std::size_t size) {
  std::string out(size, '\0');
  z_stream stream{};
  if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw MemoryError("not enough memory to read a zip file");
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(data.data()));
  stream.avail_in = static_cast<uInt>(data.size());
  Bytef nothing = 0;  // zlib requires a buffer for an empty file, too
  stream.next_out = size > 0 ? reinterpret_cast<Bytef*>(out.data()) : &nothing;
  stream.avail_out = static_cast<uInt>(size > 0 ? size : 1);
  const int result = ::inflate(&stream, Z_FINISH);
  const bool complete = result == Z_STREAM_END && stream.total_out == size;
  ::inflateEnd(&stream);
  if (!complete) throw FileError(kName, "the compressed data is broken");
  return out;
}

// Fields of local and central headers from "version needed" to "extra length".
void appendCommon(std::string& bytes, std::uint16_t method, std::uint32_t crc, std::size_t packed, std::size_t size,
                  std::size_t name) {
  appendInteger(bytes, kVersion, 2);
  appendInteger(bytes, kUtf8, 2);
  appendInteger(bytes, method, 2);
  appendInteger(bytes, 0, 2);  // time
  appendInteger(bytes, kDate, 2);
  appendInteger(bytes, crc, 4);
  appendInteger(bytes, static_cast<std::uint32_t>(packed), 4);
  appendInteger(bytes, static_cast<std::uint32_t>(size), 4);
  appendInteger(bytes, static_cast<std::uint32_t>(name), 2);
  appendInteger(bytes, 0, 2);  // extra
}

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  std::map<std::string, std::string> read() {
    const std::size_t end = findEnd();
    const std::size_t count = number(end + 10, 2);
    if (number(end + 4, 2) != 0 || number(end + 8, 2) != count)
      fail(end, "archives of several parts are not supported");
    if (count > kMaxZipEntries) fail(end, fmt::format("has more than {} files", kMaxZipEntries));
    std::size_t at = number(end + 16, 4);
    std::map<std::string, std::string> files;
    for (std::size_t i = 0; i < count; ++i) at = readEntry(at, files);
    return files;
  }

 private:
  [[noreturn]] static void fail(std::size_t at, const std::string& problem) {
    throw FileError(kName, fmt::format("byte {}", at), problem);
  }
  std::string_view part(std::size_t at, std::size_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at) fail(bytes_.size(), "ends early");
    return bytes_.substr(at, size);
  }
  std::uint32_t number(std::size_t at, std::size_t size) const {
    return static_cast<std::uint32_t>(integerAt(part(at, size), 0, size));
  }

  // The record at the end is followed by a comment of at most 65535 bytes.
  std::size_t findEnd() const {
    for (std::size_t back = kEndSize; back <= bytes_.size() && back <= kEndSize + 0xFFFF; ++back) {
      const std::size_t at = bytes_.size() - back;
      if (number(at, 4) == kEndSignature && number(at + 20, 2) == back - kEndSize) return at;
    }
    throw FileError(kName, "is not a zip file");
  }

  // Returns the position of the next entry.
  std::size_t readEntry(std::size_t at, std::map<std::string, std::string>& files) {
    part(at, kCentralSize);
    if (number(at, 4) != kCentralSignature) fail(at, "the directory is broken");
    const std::uint32_t flags = number(at + 8, 2), method = number(at + 10, 2), crc = number(at + 16, 4);
    const std::size_t packed = number(at + 20, 4), size = number(at + 24, 4), nameSize = number(at + 28, 2);
    const std::size_t next = at + kCentralSize + nameSize + number(at + 30, 2) + number(at + 32, 2);
    const std::string name(part(at + kCentralSize, nameSize));
    if (name.ends_with('/')) return next;
    const std::string shown = printable(name);
    if (flags & kEncrypted) fail(at, fmt::format("'{}' is encrypted", shown));
    if (method != kStored && method != kDeflated) fail(at, fmt::format("'{}' has an unknown compression", shown));
    unpacked_ += size;
    if (unpacked_ > kMaxUnzippedBytes) fail(at, fmt::format("has more than {}", bytesText(kMaxUnzippedBytes)));
    const std::size_t local = number(at + 42, 4);
    if (number(local, 4) != kLocalSignature) fail(local, fmt::format("the header of '{}' is broken", shown));
    const std::size_t begin = local + kLocalSize + number(local + 26, 2) + number(local + 28, 2);
    const std::string_view data = part(begin, packed);
    if (method == kStored && packed != size) fail(at, fmt::format("the size of '{}' is wrong", shown));
    std::string content = method == kStored ? std::string(data) : inflated(data, size);
    if (crcOf(content) != crc) fail(begin, fmt::format("'{}' has a wrong checksum", shown));
    files[name] = std::move(content);
    return next;
  }

  std::string_view bytes_;
  std::size_t unpacked_ = 0;
};

}  // namespace

std::string zipFiles(const std::map<std::string, std::string>& files) {
  std::string archive, directory;
  for (const auto& [name, content] : files) {
    const std::uint32_t crc = crcOf(content);
    const std::string compressed = deflated(content);
    const bool smaller = compressed.size() < content.size();
    const std::string& data = smaller ? compressed : content;
    const std::uint16_t method = smaller ? kDeflated : kStored;
    const std::size_t offset = archive.size();
    appendInteger(archive, kLocalSignature, 4);
    appendCommon(archive, method, crc, data.size(), content.size(), name.size());
    archive += name + data;
    appendInteger(directory, kCentralSignature, 4);
    appendInteger(directory, kVersion, 2);
    appendCommon(directory, method, crc, data.size(), content.size(), name.size());
    appendInteger(directory, 0, 2);  // comment
    appendInteger(directory, 0, 2);  // disk
    appendInteger(directory, 0, 2);  // internal attributes
    appendInteger(directory, 0, 4);  // external attributes
    appendInteger(directory, static_cast<std::uint32_t>(offset), 4);
    directory += name;
  }
  const std::size_t begin = archive.size();
  archive += directory;
  appendInteger(archive, kEndSignature, 4);
  appendInteger(archive, 0, 4);  // disks
  appendInteger(archive, static_cast<std::uint32_t>(files.size()), 2);
  appendInteger(archive, static_cast<std::uint32_t>(files.size()), 2);
  appendInteger(archive, static_cast<std::uint32_t>(directory.size()), 4);
  appendInteger(archive, static_cast<std::uint32_t>(begin), 4);
  appendInteger(archive, 0, 2);  // comment
  return archive;
}

std::map<std::string, std::string> unzipFiles(std::string_view archive) { return Reader(archive).read(); }

}  // namespace quintet::lab

// URIs in glTF files: data URIs (RFC 2397) and relative paths (RFC 3986). Nothing is fetched.
#include <fmt/format.h>

#include <array>
#include <cctype>

#include "base/error.h"
#include "base/file.h"
#include "scene/gltf_document.h"

namespace quintet::scene {
namespace {

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

constexpr std::array<signed char, 256> kBase64 = [] {
  std::array<signed char, 256> table{};
  table.fill(-1);
  const std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < digits.size(); ++i)
    table[static_cast<unsigned char>(digits[i])] = static_cast<signed char>(i);
  table['-'] = 62, table['_'] = 63;  // the URL-safe alphabet
  return table;
}();

// Returns false at the first character that is no base64 digit, padding or white space.
bool decodeBase64(std::string_view text, FileBytes& out) {
  out.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int bitCount = 0;
  std::size_t i = 0;
  for (; i < text.size() && text[i] != '='; ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (std::isspace(c)) continue;
    if (kBase64[c] < 0) return false;
    bits = bits << 6 | static_cast<std::uint32_t>(kBase64[c]);
    if ((bitCount += 6) >= 8) out.push_back(static_cast<std::byte>(bits >> (bitCount -= 8) & 0xFF));
  }
  return text.find_first_not_of("= \r\n\t", i) == std::string_view::npos;
}

FileBytes decodeDataUri(const Document& document, std::string_view uri, std::string_view place) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos) document.fail(place, "the data URI has no comma");
  const std::string_view data = uri.substr(comma + 1);
  FileBytes bytes;
  if (uri.substr(0, comma).ends_with(";base64")) {
    // Percent escapes inside base64 are legal, if rare.
    const bool valid =
        data.find('%') == std::string_view::npos ? decodeBase64(data, bytes) : decodeBase64(percentDecode(data), bytes);
    if (!valid) document.fail(place, "the data URI is not valid base64");
  } else {
    const std::string text = percentDecode(data);
    const auto raw = std::as_bytes(std::span(text));
    bytes.assign(raw.begin(), raw.end());
  }
  return bytes;
}

// "http:", "file:", "C:" … : RFC 3986, section 3.1.
bool hasScheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  for (const char c : uri.substr(0, colon))
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '+' && c != '-' && c != '.') return false;
  return true;
}

}  // namespace

// A '%' that starts no escape stands for itself: exporters write file names as they are.
std::string percentDecode(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && hexDigit(text[i + 1]) >= 0 && hexDigit(text[i + 2]) >= 0) {
      result += static_cast<char>(hexDigit(text[i + 1]) * 16 + hexDigit(text[i + 2]));
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result;
}

bool isDataUri(std::string_view uri) { return uri.starts_with("data:"); }

std::filesystem::path pathOfUri(const Document& document, std::string_view uri) {
  return document.file.parent_path() / percentDecode(uri);
}

FileBytes loadUri(const Document& document, std::string_view uri, std::string_view place) {
  if (isDataUri(uri)) return decodeDataUri(document, uri, place);
  if (hasScheme(uri)) document.fail(place, "only data URIs and relative file names are read");
  const std::string name = percentDecode(uri);
  if (name.empty()) document.fail(place, "the file name is empty");
  if (name.find('\0') != std::string::npos) document.fail(place, "the file name contains a zero byte");
  if (name[0] == '/') document.fail(place, "the file name is absolute; only relative ones are read");

  const std::filesystem::path path = document.file.parent_path() / name;
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (!std::filesystem::exists(status)) document.fail(place, fmt::format("{} does not exist", name));
  // Anything else (a device, a pipe) could be endless.
  if (!std::filesystem::is_regular_file(status)) document.fail(place, fmt::format("{} is not a file", name));
  try {
    return readLargeFile(path);
  } catch (const FileError& error) {
    document.fail(place, fmt::format("{} {}", name, error.problem()));
  }
}

}  // namespace quintet::scene

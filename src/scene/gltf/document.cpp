// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/error.h"
#include "base/file.h"
#include "base/file_roots.h"
#include "base/json.h"
#include "base/plural.h"
#include "base/text.h"
#include "scene/gltf/extensions.h"
#include "scene/gltf/metadata.h"

namespace quintet::scene {
namespace {

using nlohmann::json;

// ---- GLB, the binary container (glTF 2.0 section 4.4) ----

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

// A file without GLB's magic number is JSON as a whole.
struct Container {
  std::string_view json{};
  std::span<const std::byte> binary{};  // data() is null if the file has no BIN chunk
};

Container splitContainer(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  const auto fail = [&](std::size_t offset, std::string_view problem) {
    throw FileError(file, fmt::format("byte {}", offset), problem);
  };
  if (bytes.empty()) fail(0, "the file is empty");
  if (bytes.size() < 4 || readU32(bytes, 0) != kMagic) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t first =
        text.find_first_not_of(text.starts_with(kByteOrderMark) ? "\xEF\xBB\xBF \t\r\n" : " \t\r\n");
    if (first == std::string_view::npos || text[first] != '{') fail(0, "neither a GLB nor a glTF JSON file");
    return {.json = text};
  }

  if (bytes.size() < kHeaderSize) fail(bytes.size(), "the file ends inside the GLB header");
  if (const std::uint32_t version = readU32(bytes, 4); version != 2)
    fail(4, fmt::format("GLB version {} is not supported; only version 2 is", version));
  const std::size_t length = readU32(bytes, 8);
  if (length > bytes.size())
    fail(8, fmt::format("the header states {}, but the file has {}", counted(length, "byte"), bytes.size()));
  if (length < kHeaderSize + kChunkHeaderSize)
    fail(8, fmt::format("the stated length of {} is too small", counted(length, "byte")));

  Container result;
  std::size_t offset = kHeaderSize;
  for (int chunk = 0; offset < length; ++chunk) {
    if (length - offset < kChunkHeaderSize) fail(offset, "the file ends inside a chunk header");
    const std::size_t size = readU32(bytes, offset);
    const std::uint32_t type = readU32(bytes, offset + 4);
    const std::size_t begin = offset + kChunkHeaderSize;
    if (size > length - begin)
      fail(offset,
           fmt::format("the chunk extends {} past the end of the file", counted(size - (length - begin), "byte")));
    const auto data = bytes.subspan(begin, size);
    if (chunk == 0 && type != kJson) fail(offset, "the first chunk is not JSON");
    if (chunk > 0 && type == kJson) fail(offset, "second JSON chunk");
    if (type == kJson) result.json = {reinterpret_cast<const char*>(data.data()), data.size()};
    if (type == kBinary) {
      if (result.binary.data()) fail(offset, "second BIN chunk");
      result.binary = data;
    }
    // The stated size includes the padding to four bytes. At the end of the file, an unpadded size is accepted.
    offset = begin + std::min((size + 3) / 4 * 4, length - begin);
  }
  if (result.json.empty()) fail(kHeaderSize, "the JSON chunk is empty");
  return result;
}

// ---- URIs ----

constexpr std::array<signed char, 256> kBase64 = [] {
  std::array<signed char, 256> table{};
  table.fill(-1);
  const std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < digits.size(); ++i)
    table[static_cast<unsigned char>(digits[i])] = static_cast<signed char>(i);
  table['-'] = 62, table['_'] = 63;  // the URL-safe alphabet
  return table;
}();

// Returns false at the first character that is not a base64 digit, padding or white space.
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

// `count`: see Document::loadBeginning.
FileBytes decodeDataUri(const Document& document, std::string_view uri, std::string_view location,
                        std::size_t count = std::string_view::npos) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos) document.fail(location, "the data URI has no comma");
  std::string_view data = uri.substr(comma + 1);
  // A byte takes at most four characters: base64 with escapes. A part of an escape is cut off.
  if (data.size() / 4 > count) {
    data = data.substr(0, 4 * count);
    if (const std::size_t escape = data.substr(data.size() - 2).find('%'); escape != data.npos)
      data.remove_suffix(2 - escape);
  }
  FileBytes bytes;
  if (uri.substr(0, comma).ends_with(";base64")) {
    // Percent escapes inside base64 are valid, although rare.
    const bool valid =
        data.find('%') == std::string_view::npos ? decodeBase64(data, bytes) : decodeBase64(percentDecode(data), bytes);
    if (!valid) document.fail(location, "the data URI is not valid base64");
  } else {
    const std::string text = percentDecode(data);
    const auto raw = std::as_bytes(std::span(text));
    bytes.assign(raw.begin(), raw.end());
  }
  bytes.resize(std::min(bytes.size(), count));
  return bytes;
}

// "http:", "file:", "C:" … (RFC 3986, section 3.1).
bool hasScheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  for (const char c : uri.substr(0, colon))
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '+' && c != '-' && c != '.') return false;
  return true;
}

// Compares names only; a symbolic link can still lead elsewhere.
bool leavesFolder(const std::filesystem::path& file, const std::string& name) {
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path().lexically_normal();
  const std::filesystem::path inside = (folder / name).lexically_normal().lexically_relative(folder);
  return inside.empty() || *inside.begin() == "..";
}

// ---- JSON ----

// The part of nlohmann's message "[json.exception…] parse error at line 1, column 2: syntax error …" after the
// location.
std::string withoutLocation(std::string what) {
  const std::size_t bracket = what.find("] ");
  if (bracket != std::string::npos) what.erase(0, bracket + 2);
  const std::size_t colon = what.find(": ");
  if (what.starts_with("parse error at ") && colon != std::string::npos) what.erase(0, colon + 2);
  return what;
}

// Bytes that parsing requires for each byte of JSON: lists of small numbers become 16 bytes per number, twice.
constexpr std::size_t kJsonMemory = 16;

// Replaces numbers beyond the range of double, which the parser rejects, by the largest double. Text in strings stays.
std::string withoutOverflows(std::string_view text) {
  constexpr std::string_view kLargest = "1.7976931348623157e308";
  std::string result;
  bool inString = false;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i + 1;
    if (inString && text[i] == '\\' && end < text.size()) ++end;
    if (text[i] == '"') inString = !inString;
    if (!inString && text[i] >= '0' && text[i] <= '9') {
      end = std::min(text.find_first_not_of("0123456789.eE+-", i), text.size());
      const std::string number(text.substr(i, end - i));
      char* stop = nullptr;
      const bool overflows = std::isinf(std::strtod(number.c_str(), &stop)) && *stop == '\0';  // "1e999-1" is no number
      result += overflows ? kLargest : std::string_view(number);
    } else {
      result += text.substr(i, end - i);
    }
    i = end;
  }
  return result;
}

json parseDocument(const std::filesystem::path& file, std::string_view text) {
  constexpr JsonLimits kLimits{.bytes = std::string_view::npos};  // the budget limits the size
  std::string replaced;
  try {
    try {
      return parseJson(file, text, kLimits);
    } catch (const json::out_of_range&) {
      text = replaced = withoutOverflows(text);
      return parseJson(file, text, kLimits);
    }
  } catch (const json::parse_error& error) {
    throw FileError(file, lineAndColumn(text, error.byte), "invalid JSON: " + printable(withoutLocation(error.what())));
  } catch (const json::exception& error) {  // a number beyond the range of double, without a location
    const std::string problem = withoutLocation(error.what());
    const std::size_t quote = problem.find('\'');
    const std::string token =
        quote == std::string::npos ? "" : problem.substr(quote + 1, problem.rfind('\'') - quote - 1);
    const std::size_t byte = token.empty() ? std::string_view::npos : text.find(token);
    throw FileError(file, byte == std::string_view::npos ? "" : lineAndColumn(text, byte + 1), printable(problem));
  }
}

void checkVersion(const Document& document, const json& asset) {
  for (const char* key : {"version", "minVersion"}) {
    const std::string version = asset.value(key, "2.0");
    if (!version.starts_with("2."))
      document.fail(fmt::format("/asset/{}", key),
                    fmt::format("glTF {} is not supported; only 2.x is", version.substr(0, 20)));
  }
}

// Objects that another property requires. A spot light without "spot" has only defaults, but tinygltf requires the
// object.
void checkDependencies(const Document& document, json& checked) {
  const auto cameras = checked.find("cameras");
  for (std::size_t i = 0; cameras != checked.end() && i < cameras->size(); ++i) {
    const auto& type = (*cameras)[i]["type"].get_ref<const std::string&>();
    if (!(*cameras)[i].contains(type)) document.fail(fmt::format("/cameras/{}", i), type + " is missing");
  }
  const json::json_pointer lights("/extensions/KHR_lights_punctual/lights");
  if (!checked.contains(lights)) return;
  for (json& light : checked[lights])
    if (!light.contains("spot")) light["spot"] = json::object();
}

// Workaround for three checks of tinygltf 2.7.0. It rejects index accessors without a buffer view, which are valid
// (Draco, sparse): here they refer to an extra view. It rejects strides that are no multiple of four, which are
// harmless: they are removed and put back. It drops animation channels without a node, which the report lists: their
// node becomes kNone. Tests: GltfSparse.ReadsIndicesWithoutBufferView, GltfAccessor.ReadsOddStrides,
// GltfAnimations.ReportChannelsThatCannotPlay.
tinygltf::Model parseModel(const Document& document, json& checked) {
  json& views = checked["bufferViews"];
  const std::size_t viewCount = views.size();  // 0 for null
  std::vector<std::size_t> strides;
  for (json& view : views) {
    strides.push_back(view.value("byteStride", std::size_t{0}));
    view.erase("byteStride");
  }
  views.push_back({{"buffer", 0}, {"byteLength", 1}});
  if (const auto accessors = checked.find("accessors"); accessors != checked.end())
    for (json& accessor : *accessors)
      if (!accessor.contains("bufferView")) accessor["bufferView"] = viewCount;
  if (const auto animations = checked.find("animations"); animations != checked.end())
    for (json& animation : *animations)
      for (json& channel : animation["channels"])
        if (!channel["target"].contains("node")) channel["target"]["node"] = kNone;

  tinygltf::Model model;
  tinygltf::TinyGLTF parser;
  std::string error, warning;
  const std::string text = checked.dump();
  if (text.size() > std::numeric_limits<unsigned>::max()) document.fail("", "the JSON is larger than 4 GiB");
  if (!parser.LoadASCIIFromString(&model, &error, &warning, text.data(), static_cast<unsigned>(text.size()), ""))
    document.fail("", error.substr(0, error.find('\n')));

  model.bufferViews.pop_back();
  for (std::size_t i = 0; i < viewCount; ++i) model.bufferViews[i].byteStride = strides[i];
  for (tinygltf::Accessor& accessor : model.accessors)
    if (accessor.bufferView == static_cast<int>(viewCount)) accessor.bufferView = kNone;
  return model;
}

// ---- Images and buffers ----

std::vector<ImageSource> readImageSources(const Document& document, const json& images) {
  std::vector<ImageSource> sources;
  for (std::size_t i = 0; i < images.size(); ++i) {
    ImageSource source{images[i].value("name", ""), images[i].value("uri", ""), images[i].value("bufferView", kNone)};
    if (source.uri.empty() == (source.bufferView == kNone))
      document.fail(fmt::format("/images/{}", i), "needs either a uri or a bufferView");
    sources.push_back(std::move(source));
  }
  return sources;
}

// A buffer without uri and BIN chunk has no data, such as the fallback buffers of KHR_meshopt_compression.
void loadBuffers(Document& document, const json& buffers, const Container& container) {
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const json& buffer = buffers[i];
    const std::string location = fmt::format("/buffers/{}", i);
    Buffer result{.byteLength = buffer["byteLength"].get<std::uint64_t>()};
    std::span<const std::byte> data;
    if (buffer.contains("uri")) {
      const auto& uri = buffer["uri"].get_ref<const std::string&>();
      data = document.storage.emplace_back(document.loadUri(uri, location + "/uri"));
      if (!isDataUri(uri)) document.files.push_back(document.pathOfUri(uri));
    } else if (i == 0 && container.binary.data()) {
      data = container.binary;
    } else {
      document.buffers.push_back(result);
      continue;
    }
    if (data.size() < result.byteLength)
      document.fail(location + "/byteLength",
                    fmt::format("{}, but the buffer has only {}", counted(result.byteLength, "byte"), data.size()));
    result.data = data.first(result.byteLength);
    document.buffers.push_back(result);
  }
}

}  // namespace

void Document::fail(std::string_view location, std::string_view problem, Remedy remedy) const {
  throw FileError(file, printable(location), printable(problem), remedy);
}

std::span<const std::byte> Document::view(int bufferView) const {
  const auto index = static_cast<std::size_t>(bufferView);
  if (!bufferViews[index].data())
    fail(fmt::format("/buffers/{}", model.bufferViews[index].buffer), "has no data: neither a uri nor a BIN chunk");
  return bufferViews[index];
}

FileBytes Document::loadUri(std::string_view uri, std::string_view location) const {
  if (isDataUri(uri)) {
    budget->take(uri.size());
    return decodeDataUri(*this, uri, location);
  }
  const std::filesystem::path path = fileOfUri(uri, location);
  try {
    return readLargeFile(path, *budget);
  } catch (const FileError& error) {
    fail(location, fmt::format("{} {}", percentDecode(uri), error.problem()));
  }
}

FileBytes Document::loadBeginning(std::string_view uri, std::string_view location, std::size_t count) const {
  if (isDataUri(uri)) return decodeDataUri(*this, uri, location, count);
  FileBytes bytes(count);
  std::ifstream in(fileOfUri(uri, location), std::ios::binary);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

std::filesystem::path Document::fileOfUri(std::string_view uri, std::string_view location) const {
  if (hasScheme(uri)) fail(location, "only data URIs and relative file names are supported");
  const std::string name = percentDecode(uri);
  if (name.empty()) fail(location, "the file name is empty");
  if (name.find('\0') != std::string::npos) fail(location, "the file name contains a zero byte");
  if (name[0] == '/') fail(location, "the file name is absolute; only relative file names are supported");

  if (!allowExternal && leavesFolder(file, name))
    fail(location, fmt::format("{} is outside of the folder of the file", name), Remedy::allowExternal);
  const std::filesystem::path path = pathOfUri(uri);
  if (!FileRoots::fromEnvironment().allows(path)) fail(location, fmt::format("{} {}", name, kOutsideOfRoots));
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (!std::filesystem::exists(status)) fail(location, fmt::format("{} does not exist", name));
  // A device or a pipe could be endless.
  if (!std::filesystem::is_regular_file(status)) fail(location, fmt::format("{} is not a regular file", name));
  return path;
}

std::filesystem::path Document::pathOfUri(std::string_view uri) const {
  // RFC 3986, section 5.2.4: dot segments are removed before a name is looked up.
  const auto resolve = [&](std::string_view name) {
    return file.parent_path() / std::filesystem::path(name).lexically_normal();
  };
  const std::filesystem::path decoded = resolve(percentDecode(uri)), itself = resolve(uri);
  std::error_code ignored;
  return !std::filesystem::exists(decoded, ignored) && std::filesystem::exists(itself, ignored) ? itself : decoded;
}

bool isDataUri(std::string_view uri) { return uri.starts_with("data:"); }

// A '%' that does not start an escape is kept, because some exporters write file names without escapes.
std::string percentDecode(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char* digits = text.data() + i + 1;
    unsigned byte = 0;
    if (text[i] == '%' && i + 2 < text.size() && std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
      result += static_cast<char>(byte);
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result;
}

Document readDocument(const std::filesystem::path& file, bool allowExternal, std::shared_ptr<MemoryBudget> budget) {
  Document document;
  document.budget = std::move(budget);
  document.allowExternal = allowExternal;
  document.file = file;
  document.files.push_back(file);
  const FileBytes& bytes = document.storage.emplace_back(readLargeFile(file, *document.budget));
  const Container container = splitContainer(file, bytes);
  document.budget->take(kJsonMemory * container.json.size());
  json root = parseDocument(file, container.json);
  CheckedSchema schema = checkSchema(file, root);
  json& checked = schema.json;
  document.unread = std::move(schema.unread);
  document.extensionUses = std::move(schema.extensions);
  document.metadata = readMetadata(checked);
  checkVersion(document, checked["asset"]);
  checkDependencies(document, checked);
  checkRequiredExtensions(file, checked.value("extensionsRequired", std::vector<std::string>{}));

  const json buffers = std::exchange(checked["buffers"], json::array());
  const json images = std::exchange(checked["images"], json::array());
  document.images = readImageSources(document, images);
  for (const ImageSource& image : document.images)
    if (!image.uri.empty() && !isDataUri(image.uri)) document.files.push_back(document.pathOfUri(image.uri));
  document.model = parseModel(document, checked);
  loadBuffers(document, buffers, container);
  return document;
}

}  // namespace quintet::scene

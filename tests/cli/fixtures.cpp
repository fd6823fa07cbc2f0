// SPDX-License-Identifier: Apache-2.0
#include "fixtures.h"

#include <turbojpeg.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "io/codec.h"
#include "render/film/film_file.h"

namespace quintet::test {
namespace {

// Two triangles: 4 positions, 4 texture coordinates, 6 indices (uint16).
std::string quadBuffer() {
  constexpr float kPositions[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
  constexpr float kUvs[] = {0, 1, 1, 1, 1, 0, 0, 0};
  constexpr std::uint16_t kIndices[] = {0, 1, 2, 0, 2, 3};
  std::string bytes(sizeof kPositions + sizeof kUvs + sizeof kIndices, '\0');
  std::memcpy(bytes.data(), kPositions, sizeof kPositions);
  std::memcpy(bytes.data() + sizeof kPositions, kUvs, sizeof kUvs);
  std::memcpy(bytes.data() + sizeof kPositions + sizeof kUvs, kIndices, sizeof kIndices);
  return bytes;
}

void append32(std::string& text, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) text += static_cast<char>(value >> shift & 0xff);
}

std::uint32_t crc32(std::span<const std::byte> bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const std::byte byte : bytes) {
    crc ^= static_cast<std::uint32_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

void storeBigEndian(std::span<std::byte> target, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) target[i] = static_cast<std::byte>(value >> (24 - 8 * i) & 0xff);
}

}  // namespace

std::string base64(std::string_view bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63];
  }
  return text;
}

nlohmann::json quadScene() {
  using Json = nlohmann::json;
  const std::string buffer = quadBuffer();
  Json json = Json::parse(R"({
    "asset": {"version": "2.0", "generator": "quintet tests"},
    "scene": 0,
    "scenes": [{"nodes": [0, 1, 2]}],
    "nodes": [{"mesh": 0, "name": "quad"},
              {"camera": 0, "translation": [0, 0, 4]},
              {"camera": 1, "translation": [4, 0, 0], "rotation": [0, 0.70710678, 0, 0.70710678]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
    "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.3, 0.1, 1], "metallicFactor": 0}}],
    "cameras": [{"type": "perspective", "name": "front", "perspective": {"yfov": 0.8, "znear": 0.1, "aspectRatio": 1.6}},
                {"type": "perspective", "name": "side", "perspective": {"yfov": 0.8, "znear": 0.1}}],
    "accessors": [
      {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
      {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
      {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48},
                    {"buffer": 0, "byteOffset": 48, "byteLength": 32},
                    {"buffer": 0, "byteOffset": 80, "byteLength": 12}]
  })");
  json["buffers"] = {
      {{"byteLength", buffer.size()}, {"uri", "data:application/octet-stream;base64," + base64(buffer)}}};
  return json;
}

std::string glb(const nlohmann::json& json, std::string_view binary) {
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string data(binary);
  data.resize((data.size() + 3) / 4 * 4, '\0');
  std::string file = "glTF";
  append32(file, 2);
  append32(file, 12 + 8 + text.size() + 8 + data.size());
  append32(file, text.size());
  file += "JSON" + text;
  append32(file, data.size());
  file += std::string("BIN\0", 4) + data;
  return file;
}

std::string texturedGlb(std::span<const std::byte> image, const std::string& mimeType) {
  nlohmann::json json = quadScene();
  std::string binary = quadBuffer();
  json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", image.size()}});
  binary.append(reinterpret_cast<const char*>(image.data()), image.size());
  json["buffers"] = {{{"byteLength", binary.size()}}};
  json["images"] = {{{"bufferView", 3}, {"mimeType", mimeType}}};
  json["textures"] = {{{"source", 0}}};
  json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  return glb(json, binary);
}

void write(const std::filesystem::path& file, std::string_view text) {
  std::ofstream(file, std::ios::binary).write(text.data(), static_cast<std::streamsize>(text.size()));
}
void write(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  write(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

io::Image testImage(std::uint32_t width, std::uint32_t height) {
  io::Image image = io::makeImage(width, height, 3, io::PixelType::u8, io::ColorEncoding::sRgb);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const auto pixel = image.pixel<std::uint8_t>(x, y);
      pixel[0] = static_cast<std::uint8_t>(255 * x / width);
      pixel[1] = static_cast<std::uint8_t>(255 * y / height);
      pixel[2] = static_cast<std::uint8_t>((x * 7 + y * 13) % 256);
    }
  }
  return image;
}

std::vector<std::byte> encodeJpeg(const io::Image& image) {
  const tjhandle encoder = tjInitCompress();
  unsigned char* data = nullptr;
  unsigned long size = 0;
  const int failed =
      tjCompress2(encoder, reinterpret_cast<const unsigned char*>(image.data.data()), static_cast<int>(image.width), 0,
                  static_cast<int>(image.height), TJPF_RGB, &data, &size, TJSAMP_444, 90, 0);
  tjDestroy(encoder);
  if (failed) throw std::runtime_error("cannot encode a JPEG file");
  const auto* bytes = reinterpret_cast<const std::byte*>(data);
  std::vector<std::byte> result(bytes, bytes + size);
  tjFree(data);
  return result;
}

std::vector<std::byte> pngWithStatedSize(std::uint32_t width, std::uint32_t height) {
  std::vector<std::byte> bytes = io::encodePng(testImage(4, 4));
  const std::span<std::byte> header(bytes.data() + 12, 17);  // "IHDR" and its 13 bytes
  storeBigEndian(header.subspan(4, 4), width);
  storeBigEndian(header.subspan(8, 4), height);
  storeBigEndian(std::span(bytes).subspan(29, 4), crc32(header));
  return bytes;
}

void expectError(const RunResult& result, int status, const std::vector<std::string>& parts) {
  EXPECT_EQ(result.status, status) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_TRUE(result.err.starts_with("quintet: ")) << result.err;
  EXPECT_TRUE(result.err.ends_with('\n')) << result.err;
  for (const std::string& part : parts)
    EXPECT_NE(result.err.find(part), std::string::npos) << "'" << part << "' not found in: " << result.err;
}

nlohmann::json expectJsonError(const RunResult& result, int status, const std::vector<std::string>& parts) {
  expectError({result.status, "", result.err}, status, parts);
  const nlohmann::json json = nlohmann::json::parse(result.out, nullptr, false);
  if (!json.is_object() || !json.contains("error")) {
    ADD_FAILURE() << "no error on standard output: " << result.out;
    return {};
  }
  const nlohmann::json& error = json.at("error");
  EXPECT_EQ(error.at("exitStatus"), status);
  EXPECT_EQ("quintet: " + error.at("message").get<std::string>() + "\n", result.err);
  EXPECT_EQ(error.size(), 4u);
  return error;
}

io::Image CliTest::readImage(const std::string& name) const { return io::readImage(folder_ / name); }

std::string CliTest::timeForOneBatch(const std::string& checkpoint) const {
  if (!std::filesystem::exists(folder_ / checkpoint)) return "0";
  render::FilmFile file = render::readFilm(folder_ / checkpoint);
  for (auto& [name, value] : file.notes)
    if (name == "batch seconds") value = "0";
  render::writeFilm(folder_ / checkpoint, file);
  return std::to_string(std::stod(*render::findFact(file.notes, "seconds")) + 1e-3);
}

std::vector<std::string> CliTest::fileNames() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace quintet::test

// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "base/error.h"
#include "io/codec.h"
#include "scene/gltf/gltf.h"
#include "scene/model/validate.h"

namespace quintet::test {
namespace {

std::vector<std::byte> bytesOf(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text.data(), text.size()));
  return {bytes.begin(), bytes.end()};
}

void appendU32(std::vector<std::byte>& out, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::byte>(value >> shift & 0xFF));
}

void appendChunk(std::vector<std::byte>& out, std::uint32_t type, std::vector<std::byte> data, std::byte padding) {
  data.resize((data.size() + 3) / 4 * 4, padding);
  appendU32(out, data.size());
  appendU32(out, type);
  out.insert(out.end(), data.begin(), data.end());
}

template <class Load>
std::string errorFrom(Load load) {
  try {
    load();
  } catch (const FileError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    EXPECT_EQ(error.file().stem(), "scene") << error.what();
    return error.location().empty() ? error.problem() : error.location() + ": " + error.problem();
  }
  return "";
}

}  // namespace

std::string base64(const std::vector<std::byte>& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::vector<std::byte> makeGlb(std::string json, const std::vector<std::byte>* binary) {
  std::vector<std::byte> body;
  appendChunk(body, 0x4E4F534A, bytesOf(json), std::byte{' '});
  if (binary) appendChunk(body, 0x004E4942, *binary, std::byte{0});
  std::vector<std::byte> file;
  appendU32(file, 0x46546C67);
  appendU32(file, 2);
  appendU32(file, 12 + body.size());
  file.insert(file.end(), body.begin(), body.end());
  return file;
}

std::string GltfBuilder::json() const {
  Json copy = root;
  if (!binary.empty() && !copy.contains("buffers")) copy["buffers"] = {{{"byteLength", binary.size()}}};
  return copy.dump();
}

std::vector<std::byte> GltfBuilder::glb() const { return makeGlb(json(), binary.empty() ? nullptr : &binary); }

std::string GltfBuilder::gltf() const {
  Json copy = Json::parse(json());
  if (!binary.empty()) copy["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(binary);
  return copy.dump(2);
}

scene::Scene GltfBuilder::load() const { return loadBytes(glb()); }

scene::Scene loadBytes(const std::vector<std::byte>& bytes, const std::string& extension) {
  const TempFolder folder;
  const std::filesystem::path file = folder / ("scene." + extension);
  // writeFile would wait for the disk, and the tests write thousands of files.
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  scene::Scene scene = scene::loadGltf(file);
  scene::validate(scene);
  return scene;
}

scene::Scene loadText(std::string_view text, const std::string& extension) {
  return loadBytes(bytesOf(text), extension);
}

std::string errorOf(const GltfBuilder& builder) {
  return errorFrom([&] { builder.load(); });
}
std::string errorOfBytes(const std::vector<std::byte>& bytes, const std::string& extension) {
  return errorFrom([&] { loadBytes(bytes, extension); });
}
std::string errorOfText(std::string_view text) {
  return errorFrom([&] { loadText(text); });
}

std::vector<std::byte> tinyPng() {
  io::Image image = io::makeImage(2, 2, 3, io::PixelType::u8, io::ColorEncoding::sRgb);
  const std::uint8_t pixels[] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
  std::memcpy(image.data.data(), pixels, sizeof pixels);
  return io::encodePng(image);
}

}  // namespace quintet::test

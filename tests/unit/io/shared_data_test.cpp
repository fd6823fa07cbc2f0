// SPDX-License-Identifier: Apache-2.0
// Decodes every image in $QUINTET_SHARED/data: image files and images inside .glb files. tests/reference/run sets the variable;
// without it, the test is skipped. codec_test.cpp and samples.h test the same decoders with images of our own.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"
#include "base/file.h"
#include "io/codec.h"

namespace quintet::io {
namespace {

namespace fs = std::filesystem;

// Returns the images in the binary chunk of a .glb file (glTF 2.0, 4.4); empty for an unexpected layout.
std::vector<std::span<const std::byte>> imagesInside(std::span<const std::byte> glb) {
  const auto read32 = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(glb[at + i]) << (8 * i);
    return value;
  };
  std::vector<std::span<const std::byte>> images;
  if (glb.size() < 28 || read32(0) != 0x46546c67) return images;
  const std::size_t jsonSize = read32(12);
  if (28 + jsonSize > glb.size()) return images;
  const auto text = glb.subspan(20, jsonSize);
  const auto json = nlohmann::json::parse(reinterpret_cast<const char*>(text.data()),
                                          reinterpret_cast<const char*>(text.data() + text.size()), nullptr, false);
  if (!json.is_object() || !json.contains("images")) return images;
  const auto binary = glb.subspan(28 + jsonSize);
  for (const auto& image : json["images"]) {
    if (!image.contains("bufferView")) continue;
    const auto& view = json["bufferViews"][image["bufferView"].get<std::size_t>()];
    images.push_back(binary.subspan(view.value("byteOffset", std::size_t{0}), view["byteLength"].get<std::size_t>()));
  }
  return images;
}

TEST(SharedDataTest, DecodesEveryImage) {
  const char* shared = std::getenv("QUINTET_SHARED");
  if (!shared) GTEST_SKIP() << "QUINTET_SHARED is not set";
  const fs::path data = fs::path(shared) / "data";
  const std::set<std::string> extensions{".png", ".jpg", ".jpeg", ".webp", ".hdr", ".exr"};
  std::size_t count = 0;
  std::size_t bytesRead = 0;
  const auto decode = [&](std::span<const std::byte> bytes, const std::string& name) {
    try {
      const Image image = decodeImage(bytes, name);
      EXPECT_EQ(image.data.size(), image.rowBytes() * image.height) << name;
      ++count;
      bytesRead += bytes.size();
    } catch (const FileError& error) {
      ADD_FAILURE() << error.what();
    }
  };
  for (const char* folder : {"models", "hdr", "reference"}) {
    for (const auto& entry : fs::recursive_directory_iterator(data / folder)) {
      const std::string extension = entry.path().extension().string();
      if (extensions.contains(extension)) decode(readFile(entry.path()), entry.path().string());
      if (extension != ".glb") continue;
      const auto glb = readFile(entry.path());
      const auto images = imagesInside(glb);
      for (std::size_t i = 0; i < images.size(); ++i)
        decode(images[i], fmt::format("{}: image {}", entry.path().string(), i));
    }
  }
  fmt::print("{} images of {} MiB decoded\n", count, bytesRead >> 20);
  EXPECT_GT(count, 0u);
}

}  // namespace
}  // namespace quintet::io

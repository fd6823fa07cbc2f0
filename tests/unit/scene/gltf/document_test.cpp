// SPDX-License-Identifier: Apache-2.0
// GLB headers and chunks, JSON syntax, extensions, buffers and URIs.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include "base/error.h"
#include "base/file.h"
#include "base/file_roots.h"
#include "scene/error_matcher.h"
#include "scene/gltf/gltf.h"
#include "scene/gltf_builder.h"

namespace quintet::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::vector<std::byte> triangleGlb() {
  GltfBuilder builder;
  builder.addTriangle();
  return builder.glb();
}

// Overwrites four bytes, little endian.
std::vector<std::byte> patched(std::vector<std::byte> bytes, std::size_t offset, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[offset + i] = static_cast<std::byte>(value >> (8 * i) & 0xFF);
  return bytes;
}

std::vector<std::byte> truncated(std::vector<std::byte> bytes, std::size_t size) {
  bytes.resize(size);
  return bytes;
}

TEST(GltfContainer, ReadsGlbAndGltfByContent) {
  GltfBuilder builder;
  builder.addTriangle();
  for (const char* extension : {"glb", "gltf", "bin"}) {
    EXPECT_EQ(loadBytes(builder.glb(), extension).meshes.size(), 1u);
    EXPECT_EQ(loadText(builder.gltf(), extension).meshes.size(), 1u);
  }
}

TEST(GltfContainer, RejectsOtherFiles) {
  EXPECT_THAT(errorOfText(""), IsErrorAt("byte 0", "empty"));
  EXPECT_THAT(errorOfText("hello"), IsErrorAt("byte 0", "neither a GLB"));
  EXPECT_THAT(errorOfText("[1]"), IsErrorAt("byte 0", "neither a GLB"));
  EXPECT_THAT(errorOfBytes(tinyPng()), IsErrorAt("byte 0", "neither a GLB"));
}

TEST(GltfContainer, ChecksTheHeader) {
  const auto glb = triangleGlb();
  const auto size = static_cast<std::uint32_t>(glb.size());
  EXPECT_THAT(errorOfBytes(truncated(glb, 9)), IsErrorAt("byte 9", "GLB header"));
  EXPECT_THAT(errorOfBytes(patched(glb, 4, 1)), IsErrorAt("byte 4", "GLB version 1"));
  EXPECT_THAT(errorOfBytes(patched(glb, 8, 0xFFFFFFFF)), IsErrorAt("byte 8", "4294967295 bytes"));
  EXPECT_THAT(errorOfBytes(patched(glb, 8, 12)), IsErrorAt("byte 8", "12 bytes"));
  EXPECT_THAT(errorOfBytes(truncated(glb, size - 1)), IsErrorAt("byte 8", std::to_string(size) + " bytes"));
}

TEST(GltfContainer, ChecksTheChunks) {
  const auto glb = triangleGlb();
  const std::uint32_t jsonSize = std::to_integer<std::uint32_t>(glb[12]) | std::to_integer<std::uint32_t>(glb[13]) << 8;
  const std::size_t bin = 20 + jsonSize;
  EXPECT_THAT(errorOfBytes(patched(glb, 12, 0xFFFFFFFC)), IsErrorAt("byte 12", "42949"));
  EXPECT_THAT(errorOfBytes(patched(glb, 16, 0x004E4942)), IsErrorAt("byte 12", "first chunk"));
  const std::string location = "byte " + std::to_string(bin);
  EXPECT_THAT(errorOfBytes(patched(glb, bin + 4, 0x4E4F534A)), IsErrorAt(location, "second JSON chunk"));
  EXPECT_THAT(errorOfBytes(patched(glb, bin, 40)), IsErrorAt(location, "4 bytes"));
  // An unknown chunk is skipped; then the buffer has no data.
  EXPECT_THAT(errorOfBytes(patched(glb, bin + 4, 0x12345678)), IsErrorAt("/buffers/0", "no data"));
}

TEST(GltfContainer, IgnoresBytesAfterTheStatedLength) {
  GltfBuilder builder;
  builder.addTriangle();
  auto glb = makeGlb(builder.json(), &builder.binary);
  glb.insert(glb.end(), 5, std::byte{7});
  EXPECT_EQ(loadBytes(glb).instances.size(), 1u);
}

TEST(GltfContainer, ReportsJsonErrorsByLine) {
  EXPECT_THAT(errorOfText("{\n  \"asset\": {\"version\": }\n}"), IsErrorAt("line 2, column 24", "JSON"));
  EXPECT_THAT(errorOfText("{\"a\": 1"), IsErrorAt("line 1, column 7", "JSON"));
  EXPECT_THAT(errorOfText("{\"asset\": {\"version\": \"2.0\"},\n \"scene\": 1e999}"), IsErrorAt("/scene", "integer"));
  EXPECT_THAT(errorOfText("{\"a\": 1e999,\n \"b\": }"), IsErrorAt("line 2, column 7", "JSON"));
  EXPECT_THAT(errorOfText("{\"asset\": {\"version\": \"2.0\"}, \"extras\": [1e999-1]}"),
              IsErrorAt("line 1, column 42", "1e999"));
  EXPECT_THAT(errorOfText("{\"a\": \"\xFF\"}"), HasSubstr("JSON"));
}

TEST(GltfContainer, LimitsNesting) {
  const auto nested = [](std::size_t depth) {
    return "{\"asset\": {\"version\": \"2.0\"}, \"extras\": [\"[[\\\"[\",\n" + std::string(depth, '[') +
           std::string(depth, ']') + "]}";
  };
  EXPECT_EQ(errorOfText(nested(254)), "");
  EXPECT_THAT(errorOfText(nested(255)), IsErrorAt("line 2, column 255", "256 nested"));
  EXPECT_THAT(errorOfText(nested(200000)), IsErrorAt("line 2, column 255", "256 nested"));
}

TEST(GltfContainer, ChecksTheVersion) {
  EXPECT_THAT(errorOfText("{}"), IsErrorAt("", "asset"));
  EXPECT_THAT(errorOfText(R"({"asset": {}})"), IsErrorAt("/asset", "version"));
  EXPECT_THAT(errorOfText(R"({"asset": {"version": "1.0"}})"), IsErrorAt("/asset/version", "glTF 1.0"));
  EXPECT_THAT(errorOfText(R"({"asset": {"version": "2.1", "minVersion": "3.0"}})"),
              IsErrorAt("/asset/minVersion", "glTF 3.0"));
  EXPECT_THAT(errorOfText(R"({"asset": {"version": 2}})"), IsErrorAt("/asset/version", "string"));
}

TEST(GltfContainer, RejectsUnknownRequiredExtensions) {
  GltfBuilder builder;
  builder.root["extensionsUsed"] = {"KHR_materials_ior", "EXT_unknown", "KHR_materials_variants", "KHR_xmp"};
  builder.root["extensionsRequired"] = {"KHR_materials_ior", "KHR_materials_variants", "KHR_xmp"};
  const scene::Report report = builder.load().report;
  EXPECT_THAT(report.extensionsUsed, testing::ElementsAre("KHR_materials_ior", "KHR_materials_variants"));
  EXPECT_THAT(report.extensionsIgnored, testing::ElementsAre("EXT_unknown", "KHR_xmp"));
  builder.root["extensionsRequired"] = {"KHR_materials_ior", "EXT_unknown"};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/extensionsRequired/1", "EXT_unknown"));
}

TEST(GltfBuffers, RejectsBuffersShorterThanStated) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.root["buffers"] = {{{"byteLength", 40}}};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/buffers/0/byteLength", "40 bytes"));
  builder.root["buffers"] = {{{"byteLength", 35}}};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/bufferViews/0", "1 byte"));
  builder.root["buffers"] = {{{"byteLength", -1}}};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/buffers/0/byteLength", "-1"));
  builder.root["buffers"] = {{{"byteLength", 36.5}}};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/buffers/0/byteLength", "integer"));
  builder.root["buffers"] = {{{"byteLength", 36.0}}};
  EXPECT_EQ(errorOf(builder), "");
}

TEST(GltfBuffers, RejectsViewsOutsideTheBuffer) {
  GltfBuilder builder;
  builder.addTriangle();
  Json& view = builder.root["bufferViews"][0];
  view["byteOffset"] = 4;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/bufferViews/0", "4 bytes"));
  view["byteOffset"] = 9007199254740991;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/bufferViews/0", "9007199254740991 bytes"));
  view["byteOffset"] = 18446744073709551615u;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/bufferViews/0/byteOffset", ""));
  view["byteOffset"] = 0;
  view["buffer"] = 1;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/bufferViews/0/buffer", "buffer 1"));
  view["buffer"] = -1;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/bufferViews/0/buffer", "buffer -1"));
  view["buffer"] = "0";
  EXPECT_THAT(errorOf(builder), IsErrorAt("/bufferViews/0/buffer", "integer"));
  view.erase("buffer");
  EXPECT_THAT(errorOf(builder), IsErrorAt("/bufferViews/0", "buffer"));
}

TEST(GltfUri, DecodesDataUris) {
  GltfBuilder builder;
  builder.addTriangle();
  Json json = Json::parse(builder.gltf());
  const auto errorWith = [&](const std::string& uri) {
    json["buffers"][0]["uri"] = uri;
    return errorOfText(json.dump());
  };
  const std::string digits = base64(builder.binary);
  EXPECT_EQ(errorWith("data:application/gltf-buffer;base64," + digits), "");
  EXPECT_EQ(errorWith("data:;base64," + digits), "");
  EXPECT_EQ(errorWith("data:text/plain;charset=utf-8;base64," + digits), "");
  std::string escaped = "data:,";
  for (const std::byte b : builder.binary) escaped += fmt::format("%{:02x}", std::to_integer<int>(b));
  EXPECT_EQ(errorWith(escaped), "");
  EXPECT_THAT(errorWith("data:;base64," + digits.substr(0, 20)), IsErrorAt("/buffers/0/byteLength", "36 bytes"));
  EXPECT_THAT(errorWith("data:;base64,$$$$"), IsErrorAt("/buffers/0/uri", "base64"));
  EXPECT_THAT(errorWith("data:;base64," + digits + "=AAAA"), IsErrorAt("/buffers/0/uri", "base64"));
  EXPECT_THAT(errorWith("data:"), IsErrorAt("/buffers/0/uri", "comma"));
}

TEST(GltfUri, ReadsExternalFiles) {
  GltfBuilder builder;
  builder.addTriangle();
  const TempFolder folder;
  std::filesystem::create_directory(folder / "models");
  const std::filesystem::path file = folder / "models/scene.gltf";
  writeFile(folder / "models/my data.bin", builder.binary);
  writeFile(folder / "up.bin", builder.binary);
  writeFile(folder / "models/short.bin", std::span(builder.binary).first(10));
  Json json = Json::parse(builder.gltf());
  const auto errorWith = [&](const std::string& uri) -> std::string {
    json["buffers"][0]["uri"] = uri;
    writeFile(file, json.dump());
    try {
      scene::loadGltf(file);
    } catch (const FileError& error) {
      EXPECT_EQ(error.file(), file);
      return error.location() + ": " + error.problem();
    }
    return "";
  };
  EXPECT_EQ(errorWith("my%20data.bin"), "");
  EXPECT_EQ(errorWith("my data.bin"), "");
  EXPECT_EQ(errorWith("../models/my data.bin"), "");
  EXPECT_EQ(errorWith("./a/../my data.bin"), "");
  EXPECT_THAT(errorWith("../up.bin"), IsErrorAt("/buffers/0/uri", "outside of the folder"));
  EXPECT_THAT(errorWith("%2e%2e/up.bin"), IsErrorAt("/buffers/0/uri", "outside of the folder"));
  EXPECT_THAT(errorWith("../models2/up.bin"), IsErrorAt("/buffers/0/uri", "outside of the folder"));
  EXPECT_THAT(errorWith("short.bin"), IsErrorAt("/buffers/0/byteLength", "36 bytes"));
  EXPECT_THAT(errorWith("none.bin"), IsErrorAt("/buffers/0/uri", "none.bin"));
  EXPECT_THAT(errorWith("."), IsErrorAt("/buffers/0/uri", "file"));
  EXPECT_THAT(errorWith((folder / "up.bin").string()), IsErrorAt("/buffers/0/uri", "absolute"));
  EXPECT_THAT(errorWith("http://example.com/a.bin"), IsErrorAt("/buffers/0/uri", "data URI"));
  EXPECT_THAT(errorWith("file:///a.bin"), IsErrorAt("/buffers/0/uri", "data URI"));
  EXPECT_THAT(errorWith("up%00.bin"), IsErrorAt("/buffers/0/uri", "zero byte"));
  EXPECT_THAT(errorWith(""), IsErrorAt("/buffers/0/uri", "empty"));
}

TEST(GltfUri, FollowsNoLinkOutOfTheRoots) {
  GltfBuilder builder;
  builder.addTriangle();
  const TempFolder folder;
  std::filesystem::create_directory(folder / "project");
  writeFile(folder / "up.bin", builder.binary);
  writeFile(folder / "project/inside.bin", builder.binary);
  std::filesystem::create_symlink(folder / "up.bin", folder / "project/up.bin");
  std::filesystem::create_symlink("inside.bin", folder / "project/link.bin");
  Json json = Json::parse(builder.gltf());
  const auto errorWith = [&](const std::string& uri) -> std::string {
    json["buffers"][0]["uri"] = uri;
    writeFile(folder / "project/scene.gltf", json.dump());
    try {
      scene::loadGltf(folder / "project/scene.gltf");
    } catch (const FileError& error) {
      return error.location() + ": " + error.problem();
    }
    return "";
  };
  EXPECT_EQ(errorWith("up.bin"), "");
  addFileRoot(folder / "project");
  EXPECT_THAT(errorWith("up.bin"), IsErrorAt("/buffers/0/uri", "outside of the project"));
  EXPECT_EQ(errorWith("link.bin"), "");
  ::unsetenv("QUINTET_INCLUDE_ROOTS");
}

TEST(GltfUri, ReadsFilesOutsideOfTheFolderOnRequest) {
  GltfBuilder builder;
  builder.addTriangle();
  const TempFolder folder;
  std::filesystem::create_directory(folder / "models");
  writeFile(folder / "up.bin", builder.binary);
  Json json = Json::parse(builder.gltf());
  json["buffers"][0]["uri"] = "../up.bin";
  writeFile(folder / "models/scene.gltf", json.dump());
  try {
    scene::loadGltf(folder / "models/scene.gltf");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_EQ(error.remedy(), Remedy::allowExternal);
  }
  EXPECT_EQ(scene::loadGltf(folder / "models/scene.gltf", {.allowExternal = true}).meshes.size(), 1u);
}

TEST(GltfUri, ReadsUnicodeNamesAndNamesWithPercentSigns) {
  GltfBuilder builder;
  builder.addTriangle();
  const TempFolder folder;
  std::filesystem::create_directory(folder / "Größe 模型");
  writeFile(folder / "Größe 模型/é+&.bin", builder.binary);
  writeFile(folder / "50%25.bin", builder.binary);
  writeFile(folder / "100%.bin", builder.binary);
  Json json = Json::parse(builder.gltf());
  for (const char* uri : {"Größe 模型/é+&.bin", "Gr%C3%B6%C3%9Fe%20%E6%A8%A1%E5%9E%8B/%c3%a9+&.bin",
                          "./Größe%20模型/%C3%A9%2B%26.bin", "50%25.bin", "50%2525.bin", "100%.bin", "100%25.bin"}) {
    json["buffers"][0]["uri"] = uri;
    writeFile(folder / "scene.gltf", json.dump());
    EXPECT_EQ(scene::loadGltf(folder / "scene.gltf").instances.size(), 1u) << uri;
  }
}

TEST(GltfUri, ReportsAMissingSceneFile) {
  try {
    scene::loadGltf("/no/such/scene.glb");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_EQ(error.file(), "/no/such/scene.glb");
    EXPECT_THAT(error.what(), HasSubstr("No such file"));
  }
}

TEST(GltfReport, QuotesTheFileOnOneLine) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.root["buffers"] = {{{"byteLength", 36}, {"uri", "a\nb.bin"}}};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/buffers/0/uri", "a?b.bin"));
  builder.root["buffers"].erase(0);
  builder.root["extensionsUsed"] = {"X\n\x01"};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/bufferViews/0/buffer", "buffer 0"));
  builder.root.erase("buffers");
  EXPECT_THAT(builder.load().report.extensionsIgnored, testing::ElementsAre("X??"));
}

}  // namespace
}  // namespace quintet::test

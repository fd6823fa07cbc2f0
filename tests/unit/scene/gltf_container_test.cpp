// GLB headers and chunks, JSON syntax, buffers and URIs.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/file.h"
#include "scene/gltf.h"
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

TEST(GltfContainer, RefusesWhatIsNeither) {
  EXPECT_EQ(errorOfText(""), "byte 0: the file is empty");
  EXPECT_EQ(errorOfText("hello"), "byte 0: this is neither a GLB nor a glTF JSON file");
  EXPECT_EQ(errorOfText("[1]"), "byte 0: this is neither a GLB nor a glTF JSON file");
  EXPECT_EQ(errorOfBytes(tinyPng()), "byte 0: this is neither a GLB nor a glTF JSON file");
}

TEST(GltfContainer, ChecksTheHeader) {
  const auto glb = triangleGlb();
  const auto size = static_cast<std::uint32_t>(glb.size());
  EXPECT_EQ(errorOfBytes(truncated(glb, 9)), "byte 9: the file ends inside the GLB header");
  EXPECT_EQ(errorOfBytes(patched(glb, 4, 1)), "byte 4: GLB version 1 is not supported, only 2");
  EXPECT_EQ(errorOfBytes(patched(glb, 8, 0xFFFFFFFF)),
            "byte 8: the header says 4294967295 bytes, but the file has " + std::to_string(size));
  EXPECT_EQ(errorOfBytes(patched(glb, 8, 12)), "byte 8: a length of 12 bytes is too small");
  EXPECT_EQ(errorOfBytes(truncated(glb, size - 1)),
            "byte 8: the header says " + std::to_string(size) + " bytes, but the file has " + std::to_string(size - 1));
}

TEST(GltfContainer, ChecksTheChunks) {
  const auto glb = triangleGlb();
  const std::uint32_t jsonSize = std::to_integer<std::uint32_t>(glb[12]) | std::to_integer<std::uint32_t>(glb[13]) << 8;
  const std::size_t bin = 20 + jsonSize;
  EXPECT_THAT(errorOfBytes(patched(glb, 12, 0xFFFFFFFC)), StartsWith("byte 12: the chunk is 42949"));
  EXPECT_EQ(errorOfBytes(patched(glb, 16, 0x004E4942)), "byte 12: the first chunk is not JSON");
  EXPECT_EQ(errorOfBytes(patched(glb, bin + 4, 0x4E4F534A)),
            "byte " + std::to_string(bin) + ": there is a second JSON chunk");
  EXPECT_EQ(errorOfBytes(patched(glb, bin, 40)),
            "byte " + std::to_string(bin) + ": the chunk is 4 bytes longer than the file");
  // An unknown chunk is skipped; then the buffer has no data.
  EXPECT_EQ(errorOfBytes(patched(glb, bin + 4, 0x12345678)), "/buffers/0: has no data: neither a uri nor a BIN chunk");
}

TEST(GltfContainer, ChunkLengthsMayHideTheirPadding) {
  GltfBuilder builder;
  builder.addTriangle();
  auto glb = makeGlb(builder.json(), &builder.binary);
  glb.insert(glb.end(), 5, std::byte{7});  // bytes behind the stated length are not the file's
  EXPECT_EQ(loadBytes(glb).instances.size(), 1u);
}

TEST(GltfContainer, JsonErrorsHaveALine) {
  EXPECT_THAT(errorOfText("{\n  \"asset\": {\"version\": }\n}"), StartsWith("line 2, column 24: the JSON is broken: "));
  EXPECT_THAT(errorOfText("{\"a\": 1"), StartsWith("line 1, column 7: the JSON is broken: "));
  EXPECT_EQ(errorOfText("{\"asset\": {\"version\": \"2.0\"},\n \"scene\": 1e999}"),
            "line 2, column 11: number overflow parsing '1e999'");
  EXPECT_THAT(errorOfText("{\"a\": \"\xFF\"}"), HasSubstr("the JSON is broken"));
}

TEST(GltfContainer, DeepNestingIsHarmless) {
  const std::string open(200000, '['), close(200000, ']');
  const std::string text = "{\"asset\": {\"version\": \"2.0\"}, \"extras\": " + open + close + "}";
  EXPECT_EQ(errorOfText(text), "");
  EXPECT_EQ(errorOfText("{\"asset\": " + open + close + "}"), "/asset: must be an object");
}

TEST(GltfContainer, ChecksTheVersion) {
  EXPECT_EQ(errorOfText("{}"), "asset is missing");
  EXPECT_EQ(errorOfText(R"({"asset": {}})"), "/asset: version is missing");
  EXPECT_EQ(errorOfText(R"({"asset": {"version": "1.0"}})"), "/asset/version: glTF 1.0 is not supported, only 2.x");
  EXPECT_EQ(errorOfText(R"({"asset": {"version": "2.1", "minVersion": "3.0"}})"),
            "/asset/minVersion: glTF 3.0 is not supported, only 2.x");
  EXPECT_EQ(errorOfText(R"({"asset": {"version": 2}})"), "/asset/version: must be a string");
}

TEST(GltfContainer, RequiredExtensionsMustBeKnown) {
  GltfBuilder builder;
  builder.root["extensionsUsed"] = {"KHR_materials_ior", "KHR_materials_sheen", "KHR_materials_variants"};
  builder.root["extensionsRequired"] = {"KHR_materials_ior", "KHR_materials_variants"};
  const scene::Report report = builder.load().report;
  EXPECT_THAT(report.extensionsUsed, testing::ElementsAre("KHR_materials_ior"));
  EXPECT_THAT(report.extensionsIgnored, testing::ElementsAre("KHR_materials_sheen", "KHR_materials_variants"));
  builder.root["extensionsRequired"] = {"KHR_materials_ior", "KHR_texture_basisu"};
  EXPECT_EQ(errorOf(builder), "/extensionsRequired/1: KHR_texture_basisu is not supported");
}

TEST(GltfBuffers, MustHoldWhatTheyClaim) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.root["buffers"] = {{{"byteLength", 40}}};
  EXPECT_EQ(errorOf(builder), "/buffers/0/byteLength: 40 bytes, but the buffer has only 36");
  builder.root["buffers"] = {{{"byteLength", 35}}};
  EXPECT_EQ(errorOf(builder), "/bufferViews/0: 1 bytes past the end of buffer 0");
  builder.root["buffers"] = {{{"byteLength", -1}}};
  EXPECT_EQ(errorOf(builder), "/buffers/0/byteLength: -1 is not in the range from 1 to 9007199254740991");
  builder.root["buffers"] = {{{"byteLength", 36.5}}};
  EXPECT_EQ(errorOf(builder), "/buffers/0/byteLength: must be an integer");
  builder.root["buffers"] = {{{"byteLength", 36.0}}};
  EXPECT_EQ(errorOf(builder), "");
}

TEST(GltfBuffers, ViewsStayInside) {
  GltfBuilder builder;
  builder.addTriangle();
  Json& view = builder.root["bufferViews"][0];
  view["byteOffset"] = 4;
  EXPECT_EQ(errorOf(builder), "/bufferViews/0: 4 bytes past the end of buffer 0");
  view["byteOffset"] = 9007199254740991;
  EXPECT_EQ(errorOf(builder), "/bufferViews/0: 9007199254740991 bytes past the end of buffer 0");
  view["byteOffset"] = 18446744073709551615u;
  EXPECT_THAT(errorOf(builder), StartsWith("/bufferViews/0/byteOffset: "));
  view["byteOffset"] = 0;
  view["buffer"] = 1;
  EXPECT_EQ(errorOf(builder), "/bufferViews/0/buffer: buffer 1 does not exist: the file has 1");
  view["buffer"] = -1;
  EXPECT_EQ(errorOf(builder), "/bufferViews/0/buffer: buffer -1 does not exist: the file has 1");
  view["buffer"] = "0";
  EXPECT_EQ(errorOf(builder), "/bufferViews/0/buffer: must be an integer");
  view.erase("buffer");
  EXPECT_EQ(errorOf(builder), "/bufferViews/0: buffer is missing");
}

TEST(GltfUri, DataUris) {
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
  EXPECT_EQ(errorWith("data:;base64," + digits.substr(0, 20)),
            "/buffers/0/byteLength: 36 bytes, but the buffer has only 15");
  EXPECT_EQ(errorWith("data:;base64,$$$$"), "/buffers/0/uri: the data URI is not valid base64");
  EXPECT_EQ(errorWith("data:;base64," + digits + "=AAAA"), "/buffers/0/uri: the data URI is not valid base64");
  EXPECT_EQ(errorWith("data:"), "/buffers/0/uri: the data URI has no comma");
}

TEST(GltfUri, ExternalFiles) {
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
      return error.place() + ": " + error.problem();
    }
    return "";
  };
  EXPECT_EQ(errorWith("my%20data.bin"), "");
  EXPECT_EQ(errorWith("my data.bin"), "");
  EXPECT_EQ(errorWith("../up.bin"), "");
  EXPECT_EQ(errorWith("short.bin"), "/buffers/0/byteLength: 36 bytes, but the buffer has only 10");
  EXPECT_EQ(errorWith("none.bin"), "/buffers/0/uri: none.bin does not exist");
  EXPECT_EQ(errorWith("../models"), "/buffers/0/uri: ../models is not a file");
  EXPECT_EQ(errorWith((folder / "up.bin").string()),
            "/buffers/0/uri: the file name is absolute; only relative ones are read");
  EXPECT_EQ(errorWith("http://example.com/a.bin"), "/buffers/0/uri: only data URIs and relative file names are read");
  EXPECT_EQ(errorWith("file:///a.bin"), "/buffers/0/uri: only data URIs and relative file names are read");
  EXPECT_EQ(errorWith("up%00.bin"), "/buffers/0/uri: the file name contains a zero byte");
  EXPECT_EQ(errorWith(""), "/buffers/0/uri: the file name is empty");
}

TEST(GltfUri, MissingSceneFile) {
  try {
    scene::loadGltf("/no/such/scene.glb");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_EQ(error.file(), "/no/such/scene.glb");
    EXPECT_THAT(error.what(), HasSubstr("No such file"));
  }
}

}  // namespace
}  // namespace quintet::test

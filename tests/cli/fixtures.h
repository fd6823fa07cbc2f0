// Files that the tests of the command line feed it, and what every test expects of an error.
#ifndef QUINTET_TESTS_CLI_FIXTURES_H
#define QUINTET_TESTS_CLI_FIXTURES_H

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/image.h"
#include "process.h"
#include "temp_folder.h"

namespace quintet::test {

// A coloured quad at z = 0 before a camera "front", and a second camera "side" without aspect. 3 KB of JSON
// with its one buffer inside.
nlohmann::json quadScene();

// A GLB of this JSON and binary chunk.
std::string glb(const nlohmann::json& json, std::string_view binary);

// The quad with a texture whose file is these bytes, as GLB.
std::string texturedGlb(std::span<const std::byte> image, const std::string& mimeType);

void write(const std::filesystem::path& file, std::string_view text);
void write(const std::filesystem::path& file, std::span<const std::byte> bytes);

// A gradient, u8 RGB.
io::Image testImage(std::uint32_t width, std::uint32_t height);

std::vector<std::byte> encodeJpeg(const io::Image& image);  // of u8 RGB

// PNG bytes whose header claims another size, with a right checksum.
std::vector<std::byte> pngOfClaimedSize(std::uint32_t width, std::uint32_t height);

// Exit status, nothing on standard output, and exactly one line "quintet: …" on standard error that
// contains each of `parts`.
void expectError(const RunResult& result, int status, const std::vector<std::string>& parts);

// A folder with scene.gltf in it. Small and quick arguments for `render` come from `quick`.
class CliTest : public ::testing::Test {
 protected:
  CliTest() { write(folder_ / "scene.gltf", quadScene().dump()); }

  RunResult quintet(std::vector<std::string> arguments, RunOptions options = {}) {
    options.folder = folder_.path();
    return run(arguments, options);
  }
  // render scene.gltf with the program `normals`, 32x24, 1 sample, quietly; later options win.
  static std::vector<std::string> quick(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", "scene.gltf", "--program", "normals", "--quiet"};
    const auto has = [&more](const char* name) { return std::find(more.begin(), more.end(), name) != more.end(); };
    if (!has("--size")) arguments.insert(arguments.end(), {"--size", "32x24"});
    if (!has("--spp") && !has("--time")) arguments.insert(arguments.end(), {"--spp", "1"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  io::Image picture(const std::string& name) const;
  std::vector<std::string> fileNames() const;  // sorted, hidden ones too
  // A value of --time for which the rendering of this checkpoint gets one more batch; 0 where there is none. The file then
  // says that the last batch took no time, so that another one fits.
  std::string timeForABatch(const std::string& checkpoint) const;

  TempFolder folder_;
};

}  // namespace quintet::test
#endif

// SPDX-License-Identifier: Apache-2.0
// Input files for the tests of the command line, and the form that every error message has.
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

// A colored quad at z = 0, a camera "front" that looks at it, and a camera "side" without an aspect ratio. 3 KB of JSON
// with an embedded buffer.
nlohmann::json quadScene();
std::string base64(std::string_view bytes);

// A GLB with this JSON and this binary chunk.
std::string glb(const nlohmann::json& json, std::string_view binary);

// The quad with an embedded texture file, as GLB.
std::string texturedGlb(std::span<const std::byte> image, const std::string& mimeType);

void write(const std::filesystem::path& file, std::string_view text);
void write(const std::filesystem::path& file, std::span<const std::byte> bytes);

// A gradient of 8-bit RGB pixels.
io::Image testImage(std::uint32_t width, std::uint32_t height);

std::vector<std::byte> encodeJpeg(const io::Image& image);  // 8-bit RGB

// A PNG file whose header states this size instead of the real one, with a valid checksum.
std::vector<std::byte> pngWithStatedSize(std::uint32_t width, std::uint32_t height);

// Expects this exit status, no standard output, and exactly one line "quintet: …" on standard error that contains each
// of `parts`.
void expectError(const RunResult& result, int status, const std::vector<std::string>& parts);

// The same for a command with --json, whose standard output is the object {"error": …}. Returns its value.
nlohmann::json expectJsonError(const RunResult& result, int status, const std::vector<std::string>& parts);

// A folder that contains scene.gltf.
class CliTest : public ::testing::Test {
 protected:
  CliTest() { write(folder_ / "scene.gltf", quadScene().dump()); }

  RunResult quintet(std::vector<std::string> arguments, RunOptions options = {}) {
    options.folder = folder_.path();
    return run(arguments, options);
  }
  // The arguments of a short render of scene.gltf: program `normals`, 32x24 pixels, 1 sample, quiet. `more` replaces size
  // and limits.
  static std::vector<std::string> quick(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", "scene.gltf", "--program", "normals", "--quiet"};
    const auto has = [&more](const char* name) { return std::find(more.begin(), more.end(), name) != more.end(); };
    if (!has("--size")) arguments.insert(arguments.end(), {"--size", "32x24"});
    if (!has("--spp") && !has("--time")) arguments.insert(arguments.end(), {"--spp", "1"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  io::Image readImage(const std::string& name) const;
  std::vector<std::string> fileNames() const;  // sorted, with hidden files
  // A value of --time with which this checkpoint is continued by exactly one batch; "0" if it does not exist. Changes the
  // checkpoint: its last batch took no time, so that another batch fits.
  std::string timeForOneBatch(const std::string& checkpoint) const;

  TempFolder folder_;
};

}  // namespace quintet::test
#endif

// SPDX-License-Identifier: Apache-2.0
// Parts of a render: merged in any order they give the bytes of one render; films that do not belong together are rejected.
#include <algorithm>
#include <regex>

#include "base/file.h"
#include "fixtures.h"
#include "io/codec.h"
#include "io/exr/exr.h"
#include "render/film/film_file.h"

namespace quintet::test {
namespace {

// A program with two outputs: a color that depends on the sample, and the position of the pixel.
void writeTwoOutputs(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  write(folder / "program.toml", R"([program]
description = "two outputs"
ray_generation = "main.rgen"
[[ray]]
name = "unused"
miss = "main.rmiss"
[[output]]
name = "color"
[[output]]
name = "position"
channels = ["X", "Y"]
)");
  write(folder / "main.rmiss", "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() {}\n");
  write(folder / "main.rgen", R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
void main() {
  const uvec2 pixel = launchPixel();
  for (uint i = 0u; i < launch.sampleCount; ++i) {
    const uint s = launch.firstSample + i;
    storeOutput(kOutput_color, pixel, loadOutput(kOutput_color, pixel) + vec4(float(s % 7u), 0.1, float(s) / 3.0, 1.0));
    storeOutput(kOutput_position, pixel, loadOutput(kOutput_position, pixel) + vec4(vec2(pixel), 0.0, 1.0));
  }
}
)");
}

class Merge : public CliTest {
 protected:
  // A render of 30 samples: 8 batches, and the last one has 2 samples.
  static std::vector<std::string> command(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"--size", "40x30", "--spp", "30"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return quick(arguments);
  }
  void part(const std::string& batches, const std::string& name, std::vector<std::string> more = {}) {
    more.insert(more.end(), {"--batches", batches, "-o", name});
    const RunResult result = quintet(command(more));
    ASSERT_EQ(result.status, 0) << result.err;
  }
  RunResult merge(std::vector<std::string> parts, const std::string& output,
                  const std::vector<std::string>& more = {"-q"}) {
    parts.insert(parts.begin(), "merge");
    parts.insert(parts.end(), {"-o", output});
    parts.insert(parts.end(), more.begin(), more.end());
    return quintet(parts);
  }
  void expectMerged(const std::vector<std::string>& parts, const std::string& output,
                    const std::vector<std::string>& more = {"-q"}) {
    const RunResult result = merge(parts, output, more);
    EXPECT_EQ(result.status, 0) << result.err;
  }
};

TEST_F(Merge, PartsInAnyOrderGiveTheBytesOfOneRender) {
  for (const char* name : {"whole.png", "whole.exr", "whole.hdr", "whole.qfilm"})
    ASSERT_EQ(quintet(command({"-o", name})).status, 0);
  part("0-2", "a.qfilm");
  part("3", "b.qfilm");
  part("4-5", "c.qfilm");
  part("6-7", "d.qfilm");
  std::vector<std::string> parts{"a.qfilm", "b.qfilm", "c.qfilm", "d.qfilm"};
  do {
    expectMerged(parts, "m.png");
    ASSERT_EQ(readImage("m.png").data, readImage("whole.png").data) << parts[0] << parts[1] << parts[2];
  } while (std::next_permutation(parts.begin(), parts.end()));
  expectMerged(parts, "m.exr");
  expectMerged(parts, "m.hdr");
  EXPECT_EQ(readImage("m.exr").data, readImage("whole.exr").data);
  EXPECT_EQ(readImage("m.hdr").data, readImage("whole.hdr").data);
  expectMerged({"whole.qfilm"}, "m.png");
  EXPECT_EQ(readImage("m.png").data, readImage("whole.png").data);
  const auto error = [&](const char* name) {
    for (const auto& [key, text] : io::readMetadata(readFile(folder_ / name), name))
      if (key == "Error") return text;
    return std::string();
  };
  EXPECT_NE(error("whole.png"), "");
  EXPECT_EQ(error("m.png"), error("whole.png"));
  // A merged film is a part, too.
  expectMerged({"d.qfilm", "b.qfilm"}, "bd.qfilm");
  expectMerged({"bd.qfilm", "c.qfilm", "a.qfilm"}, "m.png");
  EXPECT_EQ(readImage("m.png").data, readImage("whole.png").data);
}

TEST_F(Merge, DisplaySettingsComeFromTheRenderOrTheOptions) {
  ASSERT_EQ(quintet(command({"-o", "whole.png", "--exposure", "1.5", "--tonemap", "aces", "--transparent"})).status, 0);
  part("0-7", "a.qfilm", {"--exposure", "1.5", "--tonemap", "aces", "--transparent"});
  part("0-7", "b.qfilm", {"--transparent"});
  expectMerged({"a.qfilm"}, "a.png");
  expectMerged({"b.qfilm"}, "b.png", {"-q", "--exposure", "1.5", "--tonemap", "aces"});
  EXPECT_EQ(readImage("a.png").data, readImage("whole.png").data);
  EXPECT_EQ(readImage("b.png").data, readImage("whole.png").data);
  EXPECT_EQ(readImage("b.png").channels, 4u);
}

TEST_F(Merge, RegionsAndSeveralOutputs) {
  writeTwoOutputs(folder_ / "two");
  const std::vector<std::string> options{"--program", "two", "--region", "5,6,20,10", "--all-outputs"};
  const auto renderBoth = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"render", "scene.gltf", "-q", "--size", "40x30", "--spp", "30"});
    more.insert(more.end(), options.begin(), options.end());
    const RunResult result = quintet(more);
    ASSERT_EQ(result.status, 0) << result.err;
  };
  renderBoth({"-o", "whole.exr"});
  renderBoth({"-o", "b.qfilm", "--batches", "5-7"});
  renderBoth({"-o", "a.qfilm", "--batches", "0-4"});
  expectMerged({"b.qfilm", "a.qfilm"}, "m.exr");
  std::vector<std::string> outputs;
  for (const std::string& name : fileNames()) {
    if (!name.starts_with("whole.")) continue;
    EXPECT_EQ(readImage("m." + name.substr(6)).data, readImage(name).data);
    outputs.push_back(name);
  }
  EXPECT_EQ(outputs, (std::vector<std::string>{"whole.color.exr", "whole.position.exr"}));
  EXPECT_NE(readImage("m.color.exr").data, readImage("m.position.exr").data);
}

TEST_F(Merge, JsonAndMetadataDescribeTheRender) {
  part("0-3", "a.qfilm");
  part("4-7", "b.qfilm");
  const RunResult result = merge({"a.qfilm", "b.qfilm"}, "m.png", {"--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["samples"], 30);
  EXPECT_EQ(json["program"], "normals");
  EXPECT_EQ(json["size"], (nlohmann::json{40, 30}));
  EXPECT_EQ(json["output"], "m.png");
  EXPECT_EQ(json["rays"], 40 * 30 * 30);
  EXPECT_GT(json["seconds"]["render"], 0.0);
  EXPECT_NE(result.err.find("m.png: 40x30, 30 samples per pixel"), std::string::npos) << result.err;
  const RunResult info = quintet({"info", "m.png"});
  for (const char* text : {"30", "quintet merge a.qfilm b.qfilm -o m.png --json", "scene.gltf"})
    EXPECT_NE(info.out.find(text), std::string::npos) << info.out;
}

TEST_F(Merge, ReportsMissingSamples) {
  part("0-2", "a.qfilm");
  part("4-5", "c.qfilm");
  expectError(merge({"a.qfilm", "c.qfilm"}, "m.png"), 1, {"samples 12–15 and 24–29", "--partial"});
  expectError(merge({"c.qfilm"}, "m.png"), 1, {"samples 0–15 and 24–29"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "m.png"));
  const RunResult film = merge({"a.qfilm", "c.qfilm"}, "m.qfilm", {});
  EXPECT_EQ(film.status, 0);
  EXPECT_NE(film.err.find("samples 12–15 and 24–29"), std::string::npos) << film.err;
  const RunResult partial = merge({"a.qfilm"}, "m.png", {"--partial"});
  EXPECT_EQ(partial.status, 0);
  EXPECT_NE(partial.err.find("samples 12–29"), std::string::npos) << partial.err;
  EXPECT_EQ(readImage("m.png").width, 40u);
}

TEST_F(Merge, RejectsPartsOfDifferentRenders) {
  part("0-3", "a.qfilm");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"--seed", "4"}, "seed 4, expected 0"},
      {{"--size", "40x31"}, "size 40x31, expected 40x30"},
      {{"--region", "0,0,3,4"}, "region 0,0,3,4, expected 0,0,40,30"},
      {{"--spp", "34"}, "planned samples 34, expected 30"},
      {{"--camera", "side"}, "camera position 4,0,0, expected 0,0,4"},
      {{"--program", "ao"}, "program ao, expected normals"}};
  for (const auto& [more, text] : cases) {
    std::vector<std::string> arguments{"render", "scene.gltf", "-q", "--batches", "4-7", "-o", "b.qfilm", "--force"};
    if (more[0] != "--spp") arguments.insert(arguments.end(), {"--spp", "30"});
    if (more[0] != "--size") arguments.insert(arguments.end(), {"--size", "40x30"});
    if (more[0] != "--program") arguments.insert(arguments.end(), {"--program", "normals"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult rendered = quintet(arguments);
    ASSERT_EQ(rendered.status, 0) << rendered.err;
    expectError(merge({"a.qfilm", "b.qfilm"}, "m.png"), 1, {"b.qfilm: ", "a.qfilm", text});
  }
  render::FilmFile file = render::readFilm(folder_ / "a.qfilm");
  file.identity[0].second = "0.0.9";  // version of Quintet
  render::writeFilm(folder_ / "b.qfilm", file);
  expectError(merge({"a.qfilm", "b.qfilm"}, "m.png"), 1, {"b.qfilm: ", "a.qfilm", " 0.0.9, expected 0."});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "m.png"));
}

// Facts that decide the light: scene, environment, parameters, layers.
TEST_F(Merge, RejectsPartsWithDifferentContent) {
  nlohmann::json scene = quadScene();
  scene["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.1, 0.3, 0.1, 1};
  write(folder_ / "other.gltf", scene.dump());
  std::filesystem::copy_file(folder_ / "scene.gltf", folder_ / "copy.gltf");
  const auto renderPart = [&](const char* file, const std::vector<std::string>& more, const char* batches,
                              const char* name) {
    std::vector<std::string> arguments{"render", file,        "-q",    "--size", "8x6", "--spp",
                                       "8",      "--batches", batches, "-o",     name,  "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult result = quintet(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
  };
  // Two different hashes, of which 12 digits are shown.
  const auto expectRejected = [&](const char* file, const std::vector<std::string>& more, const std::string& pattern) {
    renderPart(file, more, "1", "b.qfilm");
    const RunResult result = merge({"a.qfilm", "b.qfilm"}, "m.png");
    expectError(result, 1, {"b.qfilm: ", "a.qfilm"});
    EXPECT_TRUE(std::regex_search(result.err, std::regex("\\(" + pattern + "\\)"))) << pattern << " not found in:\n"
                                                                                    << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "m.png"));
  };
  const std::string hashes = "([0-9a-f]{12}), expected (?!\\1)[0-9a-f]{12}";
  renderPart("scene.gltf", {}, "0", "a.qfilm");
  expectRejected("other.gltf", {}, "scene " + hashes);
  expectRejected("scene.gltf", {"--env", "1,2,3"}, "environment " + hashes);
  expectRejected("scene.gltf", {"--env-intensity", "2"}, "environment " + hashes);
  expectRejected("scene.gltf", {"--set", "bounces=3"}, "parameter bounces 3, expected [0-9]+");
  expectRejected("scene.gltf", {"--set", "clamp=2.5"}, "parameter clamp 2\\.5, expected [0-9.]+");
  expectRejected("scene.gltf", {"--aov", "albedo"}, "outputs color, albedo, expected color");
  expectRejected("scene.gltf", {"--transparent"}, "transparent yes, expected no");
  renderPart("copy.gltf", {}, "1", "b.qfilm");  // files are compared by content, not by name
  expectMerged({"a.qfilm", "b.qfilm"}, "m.png");
}

TEST_F(Merge, RejectsSharedSamples) {
  part("0-3", "a.qfilm");
  part("2-7", "b.qfilm");
  expectError(merge({"a.qfilm", "b.qfilm"}, "m.png"), 1, {"b.qfilm: ", "samples 8–15", "a.qfilm"});
  expectError(merge({"a.qfilm", "a.qfilm"}, "m.png"), 1, {"a.qfilm: ", "samples 0–15"});
}

TEST_F(Merge, RejectsBrokenFiles) {
  part("0-3", "a.qfilm");
  part("4-7", "b.qfilm");
  const std::vector<std::byte> bytes = readFile(folder_ / "b.qfilm");
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{5}, std::size_t{20}, std::size_t{100}, bytes.size() / 2, bytes.size() - 1}) {
    write(folder_ / "b.qfilm", std::span(bytes).first(size));
    expectError(merge({"a.qfilm", "b.qfilm"}, "m.png"), 1,
                {"b.qfilm: ", size == 0 ? "empty" : std::to_string(size) + " bytes"});
  }
  std::vector<std::byte> damaged = bytes;
  damaged[bytes.size() / 2] ^= std::byte{4};
  write(folder_ / "b.qfilm", damaged);
  expectError(merge({"a.qfilm", "b.qfilm"}, "m.png"), 1, {"b.qfilm: ", "damaged"});
  expectError(merge({"a.qfilm", "scene.gltf"}, "m.png"), 1, {"scene.gltf: ", ".qfilm"});
  expectError(merge({"a.qfilm", "none.qfilm"}, "m.png"), 1, {"none.qfilm: ", "No such file"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "m.png"));
}

TEST_F(Merge, OverwritesNoSamplesWithoutForce) {
  part("0-3", "a.qfilm");
  part("4-7", "b.qfilm");
  part("0-3", "other.qfilm", {"--seed", "1"});
  const auto bytesOf = [&](const char* name) { return readFile(folder_ / name); };
  const std::vector<std::byte> other = bytesOf("other.qfilm");
  expectError(merge({"a.qfilm", "b.qfilm"}, "other.qfilm"), 1, {"other.qfilm: ", "seed 1, expected 0", "--force"});
  expectError(merge({"a.qfilm"}, "b.qfilm"), 1, {"b.qfilm: ", "samples 16–29", "--force"});
  expectError(merge({"a.qfilm"}, "scene.gltf.qfilm", {"-q", "-o", "scene.gltf"}), 2, {"scene.gltf: ", ".qfilm"});
  expectMerged({"a.qfilm", "b.qfilm"}, "a.qfilm");  // it has all samples of the file
  EXPECT_EQ(bytesOf("other.qfilm"), other);
  expectMerged({"a.qfilm"}, "other.qfilm", {"-q", "--force"});
  // The same rule holds for `render`.
  const RunResult again = quintet(command({"--batches", "0-3", "-o", "b.qfilm"}));
  expectError(again, 1, {"b.qfilm: ", "samples 16–29", "--force"});
  part("4-7", "b.qfilm");
  part("0-3", "b.qfilm", {"--force"});
  write(folder_ / "text.qfilm", "not a film");
  expectError(quintet(command({"--batches", "0-3", "-o", "text.qfilm"})), 1, {"text.qfilm: ", "--force"});
  EXPECT_EQ(readTextFile(folder_ / "text.qfilm"), "not a film");
}

// A render that stops early has fewer samples than planned. The rule holds for the samples that it writes.
TEST_F(Merge, OverwritesNoSamplesWithFewer) {
  ASSERT_EQ(quintet(command({"-o", "a.qfilm"})).status, 0);
  const std::vector<std::byte> complete = readFile(folder_ / "a.qfilm");
  const std::vector<std::string> shorter = command({"-o", "a.qfilm", "--time", "0"});  // one batch
  expectError(quintet(shorter), 1, {"a.qfilm: ", "samples 0–29", "--force"});
  std::vector<std::string> kept = shorter;
  kept.insert(kept.end(), {"--checkpoint-file", "c.qfilm"});
  expectError(quintet(kept), 1, {"a.qfilm: ", "samples 0–29"});
  EXPECT_EQ(readFile(folder_ / "a.qfilm"), complete);
  EXPECT_EQ(render::readFilm(folder_ / "c.qfilm").film.counts.samples(), 4u);
  std::vector<std::string> forced = shorter;
  forced.push_back("--force");
  EXPECT_EQ(quintet(forced).status, 0);
  EXPECT_EQ(render::readFilm(folder_ / "a.qfilm").film.counts.samples(), 4u);
  ASSERT_EQ(quintet(command({"-o", "a.qfilm"})).status, 0);  // it has all samples of the file
}

TEST_F(Merge, InfoDescribesFilms) {
  part("1-2", "a.qfilm");
  const RunResult text = quintet({"info", "a.qfilm"});
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_TRUE(text.out.starts_with("a.qfilm: film, 40x30, samples 4–11 of 30, ")) << text.out;
  EXPECT_NE(text.out.find("program files"), std::string::npos) << text.out;
  const nlohmann::json json = nlohmann::json::parse(quintet({"info", "a.qfilm", "--json"}).out);
  EXPECT_EQ(json["kind"], "film");
  EXPECT_EQ(json["samples"], nlohmann::json::parse("[[4, 12]]"));
  EXPECT_EQ(json["identity"]["seed"], "0");
  EXPECT_EQ(json["notes"]["scene"], "scene.gltf");
  std::filesystem::resize_file(folder_ / "a.qfilm", 999);
  expectError(quintet({"info", "a.qfilm"}), 1, {"a.qfilm: ", "999 bytes"});
}

TEST_F(Merge, NotesDifferentDevices) {
  part("0-3", "a.qfilm");
  part("4-7", "b.qfilm");
  render::FilmFile file = render::readFilm(folder_ / "b.qfilm");
  for (auto& [name, value] : file.notes)
    if (name == "device") value = "Abacus 3000";
  render::writeFilm(folder_ / "b.qfilm", file);
  const RunResult result = merge({"a.qfilm", "b.qfilm"}, "m.png", {});
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("b.qfilm: device Abacus 3000"), std::string::npos) << result.err;
  EXPECT_NE(quintet({"info", "m.png"}).out.find("; Abacus 3000"), std::string::npos);
}

// One device name is a part of the other.
TEST_F(Merge, ComparesWholeDeviceNames) {
  part("0-3", "a.qfilm");
  part("4", "b.qfilm");
  part("5-7", "c.qfilm");
  const auto rename = [&](const char* name, const std::string& device) {
    render::FilmFile file = render::readFilm(folder_ / name);
    for (auto& [key, value] : file.notes)
      if (key == "device") value = device;
    render::writeFilm(folder_ / name, file);
  };
  rename("a.qfilm", "Abacus 3000");
  rename("b.qfilm", "Abacus 300; Sliderule");
  rename("c.qfilm", "Sliderule");
  const RunResult result = merge({"a.qfilm", "b.qfilm", "c.qfilm"}, "m.qfilm", {});
  EXPECT_NE(result.err.find("b.qfilm: device Abacus 300; Sliderule, other parts: Abacus 3000\n"), std::string::npos)
      << result.err;
  EXPECT_EQ(result.err.find("c.qfilm"), std::string::npos) << result.err;
  const render::FilmFile merged = render::readFilm(folder_ / "m.qfilm");
  EXPECT_EQ(*render::findFact(merged.notes, "device"), "Abacus 3000; Abacus 300; Sliderule");
}

// Display settings come from the part with the first samples, layers from all parts.
TEST_F(Merge, OrderOfPartsDoesNotChangeTheImage) {
  part("0-3", "a.qfilm", {"--exposure", "1.5", "--tonemap", "aces", "--aov", "sample_count"});
  part("4", "b.qfilm");
  part("5-7", "c.qfilm", {"--exposure", "-1", "--all-outputs"});
  part("5-7", "d.qfilm", {"--aov", "variance"});
  ASSERT_EQ(quintet(command({"-o", "whole.png", "--exposure", "1.5", "--tonemap", "aces"})).status, 0);
  ASSERT_EQ(quintet(command({"-o", "whole.exr", "--aov", "variance,sample_count"})).status, 0);
  std::vector<std::string> parts{"a.qfilm", "b.qfilm", "c.qfilm"}, layered{"a.qfilm", "b.qfilm", "d.qfilm"};
  do {
    const RunResult result = merge(parts, "m.png", {});
    ASSERT_EQ(result.status, 0) << result.err;
    for (const char* note : {"qfilm: tone map .*using aces", "qfilm: exposure .*using 1\\.5"})
      EXPECT_TRUE(std::regex_search(result.err, std::regex(note))) << note << " not found in:\n" << result.err;
    EXPECT_EQ(readImage("m.png").data, readImage("whole.png").data);
  } while (std::next_permutation(parts.begin(), parts.end()));
  const auto layersOf = [&](const char* name) {
    std::vector<std::pair<std::string, std::vector<float>>> channels;
    for (const io::ExrChannel& channel : io::decodeExr(readFile(folder_ / name), name).channels)
      channels.emplace_back(channel.name, channel.samples);
    return channels;
  };
  const auto expected = layersOf("whole.exr");
  ASSERT_EQ(expected.size(), 3u + 3u + 1u);
  do {
    expectMerged(layered, "m.exr");
    EXPECT_EQ(layersOf("m.exr"), expected);
    expectMerged(layered, "m.qfilm", {"-q", "--force"});
    const std::string layers = *render::findFact(render::readFilm(folder_ / "m.qfilm").notes, "layers");
    EXPECT_LT(layers.find("variance"), layers.find("sample_count")) << layers;
  } while (std::next_permutation(layered.begin(), layered.end()));
}

TEST_F(Merge, FilmsKeepExposureForTheirImage) {
  std::vector<std::string> arguments = command({"--batches", "0-7", "-o", "a.qfilm", "--exposure", "1"});
  std::erase(arguments, "--quiet");
  const RunResult result = quintet(arguments);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err.find("exposure"), std::string::npos) << result.err;
  arguments = command({"-o", "a.exr", "--exposure", "1"});
  std::erase(arguments, "--quiet");
  EXPECT_TRUE(std::regex_search(quintet(arguments).err, std::regex("a\\.exr: .*linear.*exposure")));
}

// Hostile films: every wrong fact is an error of the file, and nothing is read out of bounds.
TEST_F(Merge, RejectsInvalidFacts) {
  part("0-7", "a.qfilm", {"--aov", "all"});
  const render::FilmFile good = render::readFilm(folder_ / "a.qfilm");
  const auto expectRejected = [&](const std::string& name, const std::string& value, const std::string& text) {
    render::FilmFile file = good;
    std::erase_if(file.notes, [&](const auto& note) { return note.first == name; });
    file.notes.emplace_back(name, value);
    render::writeFilm(folder_ / "b.qfilm", file);
    expectError(merge({"b.qfilm"}, "m.exr"), 1, {"b.qfilm: header", text});
    EXPECT_FALSE(std::filesystem::exists(folder_ / "m.exr"));
  };
  const auto layer = [](const std::string& name, int source, const std::string& channels = R"(["X"])",
                        const std::string& output = "0") {
    return R"({"name":")" + name + R"(","channels":)" + channels + R"(,"exact":true,"source":)" +
           std::to_string(source) + R"(,"output":)" + output + "}";
  };
  expectRejected("layers", "[" + layer("a", 1) + "]", "layers");  // coverage, but the output is a mean
  expectRejected("layers", "[" + layer("a", 4) + "]", "layers");
  expectRejected("layers", "[" + layer("a", 0, R"(["X"])", "1") + "]", "layers");
  expectRejected("layers", "[" + layer("a..b", 0) + "]", "layers");
  expectRejected("layers", "[" + layer("a", 0, R"(["\n"])") + "]", "layers");
  expectRejected("layers", "[" + layer("a", 0) + "," + layer("a", 3) + "]", "a.X");
  expectRejected("layers", "[" + layer("a", 0, R"(["X"])", "-1") + "]", "layers");
  expectRejected("layers", "[", "layers");
  expectRejected("layers", "[{}]", "layers");
  expectRejected("instance names", "[1]", "instance names");
  expectRejected("exposure", "loud", "exposure");
  expectRejected("exposure", "1e9", "exposure");
  expectRejected("seconds", "-1", "seconds");
  render::FilmFile file = good;
  file.film.region.x = 1;
  render::writeFilm(folder_ / "b.qfilm", file);
  expectError(merge({"b.qfilm"}, "m.exr"), 1, {"b.qfilm: header", "region"});
  file = good;
  file.notes.erase(std::ranges::find(file.notes, "layers", &render::FilmFacts::value_type::first));
  file.notes.emplace_back("layers", "[" + layer("a", 3) + "]");
  render::writeFilm(folder_ / "b.qfilm", file);
  expectMerged({"b.qfilm"}, "m.exr");  // the same, but valid
}

TEST_F(Merge, RejectsFilmsWithoutSizeOrRegion) {
  part("0-7", "a.qfilm");
  for (const char* name : {"size", "region"}) {
    render::FilmFile file = render::readFilm(folder_ / "a.qfilm");
    std::erase_if(file.identity, [&](const auto& fact) { return fact.first == name; });
    render::writeFilm(folder_ / "b.qfilm", file);
    expectError(merge({"b.qfilm"}, "m.exr"), 1, {"b.qfilm: header"});
  }
}

TEST_F(Merge, InvalidOptions) {
  part("0-7", "all.qfilm", {"--all-outputs"});
  expectError(merge({"all.qfilm"}, "-"), 2, {"all outputs", "standard output"});
  expectError(merge({"all.qfilm"}, "m.qfilm", {"--aov", "variance"}), 2, {"layers", "OpenEXR"});
  expectError(merge({"all.qfilm"}, "m.exr", {"--aov", "list"}), 2, {"--aov list", "render"});
  expectError(quintet({"merge"}), 2, {"parts", "--help"});
  expectError(quintet({"merge", "a.qfilm"}), 2, {"output", "-o"});
  expectError(merge({"a.qfilm"}, "m.txt"), 2, {"m.txt", ".qfilm"});
  expectError(merge({"a.qfilm"}, "m.png", {"--tonemap", "acess"}), 2, {"--tonemap", "'acess'", "'aces'"});
  expectError(merge({"a.qfilm"}, "m.png", {"--exposure", "x"}), 2, {"--exposure", "'x'"});
  expectError(merge({"all.qfilm"}, "m.png", {"--exr-type", "half"}), 2, {"m.png", ".exr"});
  expectJsonError(merge({"a.qfilm"}, "-", {"--json"}), 2, {"--json"});
  expectError(merge({"a.qfilm"}, "no/such/folder/m.png"), 1, {"no/such/folder"});
  expectError(quintet({"run", "normals", "-o", "a.qfilm"}), 2, {"a.qfilm", "render"});
}

}  // namespace
}  // namespace quintet::test

// Parts of a rendering: joined in any way they give the bytes of one rendering; what does not belong together is refused.
#include <algorithm>
#include <regex>

#include "base/file.h"
#include "fixtures.h"
#include "io/codec.h"
#include "io/exr.h"
#include "render/film_file.h"

namespace quintet::test {
namespace {

// Colours that differ by sample, and the pixel's place.
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
name = "place"
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
    storeOutput(kOutput_place, pixel, loadOutput(kOutput_place, pixel) + vec4(vec2(pixel), 0.0, 1.0));
  }
}
)");
}

class Merge : public CliTest {
 protected:
  // 30 samples: 8 batches, the last one of 2.
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

TEST_F(Merge, AnyOrderAndNumberGiveTheBytesOfOneRendering) {
  for (const char* name : {"whole.png", "whole.exr", "whole.hdr", "whole.qfilm"})
    ASSERT_EQ(quintet(command({"-o", name})).status, 0);
  part("0-2", "a.qfilm");
  part("3", "b.qfilm");
  part("4-5", "c.qfilm");
  part("6-7", "d.qfilm");
  std::vector<std::string> parts{"a.qfilm", "b.qfilm", "c.qfilm", "d.qfilm"};
  do {
    expectMerged(parts, "m.png");
    ASSERT_EQ(picture("m.png").data, picture("whole.png").data) << parts[0] << parts[1] << parts[2];
  } while (std::next_permutation(parts.begin(), parts.end()));
  expectMerged(parts, "m.exr");
  expectMerged(parts, "m.hdr");
  EXPECT_EQ(picture("m.exr").data, picture("whole.exr").data);
  EXPECT_EQ(picture("m.hdr").data, picture("whole.hdr").data);
  expectMerged({"whole.qfilm"}, "m.png");
  EXPECT_EQ(picture("m.png").data, picture("whole.png").data);
  const auto error = [&](const char* name) {
    for (const auto& [key, text] : io::readMetadata(readFile(folder_ / name), name))
      if (key == "Error") return text;
    return std::string();
  };
  EXPECT_NE(error("whole.png"), "");
  EXPECT_EQ(error("m.png"), error("whole.png"));
  // In two steps.
  expectMerged({"d.qfilm", "b.qfilm"}, "bd.qfilm");
  expectMerged({"bd.qfilm", "c.qfilm", "a.qfilm"}, "m.png");
  EXPECT_EQ(picture("m.png").data, picture("whole.png").data);
}

TEST_F(Merge, HowThePictureIsShownComesFromTheRenderingOrTheOptions) {
  const std::vector<std::string> shown{"--exposure", "1.5", "--tonemap", "aces"};
  ASSERT_EQ(quintet(command({"-o", "whole.png", "--exposure", "1.5", "--tonemap", "aces", "--transparent"})).status, 0);
  part("0-7", "a.qfilm", {"--exposure", "1.5", "--tonemap", "aces", "--transparent"});
  part("0-7", "b.qfilm", {"--transparent"});
  expectMerged({"a.qfilm"}, "a.png");
  expectMerged({"b.qfilm"}, "b.png", {"-q", "--exposure", "1.5", "--tonemap", "aces"});
  EXPECT_EQ(picture("a.png").data, picture("whole.png").data);
  EXPECT_EQ(picture("b.png").data, picture("whole.png").data);
  EXPECT_EQ(picture("b.png").channels, 4u);
}

TEST_F(Merge, RegionsAndSeveralOutputs) {
  writeTwoOutputs(folder_ / "two");
  const std::vector<std::string> shown{"--program", "two", "--region", "5,6,20,10", "--all-outputs"};
  const auto rendered = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"render", "scene.gltf", "-q", "--size", "40x30", "--spp", "30"});
    more.insert(more.end(), shown.begin(), shown.end());
    const RunResult result = quintet(more);
    ASSERT_EQ(result.status, 0) << result.err;
  };
  rendered({"-o", "whole.exr"});
  rendered({"-o", "b.qfilm", "--batches", "5-7"});
  rendered({"-o", "a.qfilm", "--batches", "0-4"});
  expectMerged({"b.qfilm", "a.qfilm"}, "m.exr");
  std::vector<std::string> outputs;
  for (const std::string& name : fileNames()) {
    if (!name.starts_with("whole.")) continue;
    EXPECT_EQ(picture("m." + name.substr(6)).data, picture(name).data);
    outputs.push_back(name);
  }
  EXPECT_EQ(outputs, (std::vector<std::string>{"whole.color.exr", "whole.place.exr"}));
  EXPECT_NE(picture("m.color.exr").data, picture("m.place.exr").data);
}

TEST_F(Merge, SaysHowThePictureWasMade) {
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

TEST_F(Merge, MissingSamplesAreNamed) {
  part("0-2", "a.qfilm");
  part("4-5", "c.qfilm");
  expectError(merge({"a.qfilm", "c.qfilm"}, "m.png"), 1, {"samples 12 to 15 and 24 to 29 are missing", "--partial"});
  expectError(merge({"c.qfilm"}, "m.png"), 1, {"samples 0 to 15 and 24 to 29 are missing"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "m.png"));
  const RunResult film = merge({"a.qfilm", "c.qfilm"}, "m.qfilm", {});
  EXPECT_EQ(film.status, 0);
  EXPECT_NE(film.err.find("samples 12 to 15 and 24 to 29 are missing"), std::string::npos) << film.err;
  const RunResult partial = merge({"a.qfilm"}, "m.png", {"--partial"});
  EXPECT_EQ(partial.status, 0);
  EXPECT_NE(partial.err.find("samples 12 to 29 are missing"), std::string::npos) << partial.err;
  EXPECT_EQ(picture("m.png").width, 40u);
}

TEST_F(Merge, RefusesPartsThatDoNotBelongTogether) {
  part("0-3", "a.qfilm");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"--seed", "4"}, "seed: 0 in a.qfilm, 4 in b.qfilm"},
      {{"--size", "40x31"}, "size: 40x30 in a.qfilm, 40x31 in b.qfilm"},
      {{"--region", "0,0,3,4"}, "region: 0,0,40,30 in a.qfilm, 0,0,3,4 in b.qfilm"},
      {{"--spp", "34"}, "samples planned: 30 in a.qfilm, 34 in b.qfilm"},
      {{"--camera", "side"}, "camera position: 0,0,4 in a.qfilm, 4,0,0 in b.qfilm"},
      {{"--program", "ao"}, "program: normals in a.qfilm, ao in b.qfilm"}};
  for (const auto& [more, text] : cases) {
    std::vector<std::string> arguments{"render", "scene.gltf", "-q", "--batches", "4-7", "-o", "b.qfilm", "--force"};
    if (more[0] != "--spp") arguments.insert(arguments.end(), {"--spp", "30"});
    if (more[0] != "--size") arguments.insert(arguments.end(), {"--size", "40x30"});
    if (more[0] != "--program") arguments.insert(arguments.end(), {"--program", "normals"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult rendered = quintet(arguments);
    ASSERT_EQ(rendered.status, 0) << rendered.err;
    const RunResult result = merge({"a.qfilm", "b.qfilm"}, "m.png");
    EXPECT_EQ(result.status, 1);
    EXPECT_NE(result.err.find("quintet: b.qfilm: " + text + "\n"), std::string::npos) << result.err;
    EXPECT_TRUE(result.err.ends_with("quintet: b.qfilm: is of another rendering than a.qfilm\n")) << result.err;
  }
  render::FilmFile file = render::readFilm(folder_ / "a.qfilm");
  file.identity[0].second = "0.0.9";
  render::writeFilm(folder_ / "b.qfilm", file);
  const RunResult result = merge({"a.qfilm", "b.qfilm"}, "m.png");
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("in a.qfilm, 0.0.9 in b.qfilm"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "m.png"));
}

// What decides about the light rather than about the frame: scene, environment, parameters, layers.
TEST_F(Merge, RefusesPartsOfAnotherSceneLightParameterOrLayers) {
  nlohmann::json scene = quadScene();
  scene["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.1, 0.3, 0.1, 1};
  write(folder_ / "other.gltf", scene.dump());
  std::filesystem::copy_file(folder_ / "scene.gltf", folder_ / "copy.gltf");
  const auto partOf = [&](const char* file, const std::vector<std::string>& more, const char* batches,
                          const char* name) {
    std::vector<std::string> arguments{"render", file,        "-q",    "--size", "8x6", "--spp",
                                       "8",      "--batches", batches, "-o",     name,  "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult result = quintet(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
  };
  // 12 digits of hashes are shown; they differ, whatever they are.
  const auto refused = [&](const char* file, const std::vector<std::string>& more, const std::string& pattern) {
    partOf(file, more, "1", "b.qfilm");
    const RunResult result = merge({"a.qfilm", "b.qfilm"}, "m.png");
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.out, "");
    const std::string last = "quintet: b.qfilm: is of another rendering than a.qfilm\n";
    const std::regex lines("quintet: b\\.qfilm: " + pattern + "\n" + last);
    EXPECT_TRUE(std::regex_match(result.err, lines)) << pattern << " is not:\n" << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "m.png"));
  };
  const std::string hashes = "([0-9a-f]{12}) in a\\.qfilm, (?!\\1)[0-9a-f]{12} in b\\.qfilm";
  partOf("scene.gltf", {}, "0", "a.qfilm");
  refused("other.gltf", {}, "scene: " + hashes);
  refused("scene.gltf", {"--env", "1,2,3"}, "environment: " + hashes);
  refused("scene.gltf", {"--env-intensity", "2"}, "environment: " + hashes);
  refused("scene.gltf", {"--set", "bounces=3"}, "parameter bounces: [0-9]+ in a\\.qfilm, 3 in b\\.qfilm");
  refused("scene.gltf", {"--set", "clamp=2.5"}, "parameter clamp: [0-9.]+ in a\\.qfilm, 2\\.5 in b\\.qfilm");
  refused("scene.gltf", {"--aov", "albedo"}, "outputs: color in a\\.qfilm, color, albedo in b\\.qfilm");
  refused("scene.gltf", {"--transparent"}, "transparent: no in a\\.qfilm, yes in b\\.qfilm");
  partOf("copy.gltf", {}, "1", "b.qfilm");  // the content decides, not the name
  expectMerged({"a.qfilm", "b.qfilm"}, "m.png");
}

TEST_F(Merge, RefusesWhatIsThereTwice) {
  part("0-3", "a.qfilm");
  part("2-7", "b.qfilm");
  expectError(merge({"a.qfilm", "b.qfilm"}, "m.png"), 1, {"b.qfilm: samples 8 to 15 are in a.qfilm, too"});
  expectError(merge({"a.qfilm", "a.qfilm"}, "m.png"), 1, {"a.qfilm: samples 0 to 15 are in a.qfilm, too"});
}

TEST_F(Merge, RefusesBrokenFiles) {
  part("0-3", "a.qfilm");
  part("4-7", "b.qfilm");
  const std::vector<std::byte> bytes = readFile(folder_ / "b.qfilm");
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{5}, std::size_t{20}, std::size_t{100}, bytes.size() / 2, bytes.size() - 1}) {
    write(folder_ / "b.qfilm", std::span(bytes).first(size));
    expectError(merge({"a.qfilm", "b.qfilm"}, "m.png"), 1,
                {"b.qfilm: is ", size == 0 ? "empty" : "truncated after " + std::to_string(size)});
  }
  std::vector<std::byte> damaged = bytes;
  damaged[bytes.size() / 2] ^= std::byte{4};
  write(folder_ / "b.qfilm", damaged);
  expectError(merge({"a.qfilm", "b.qfilm"}, "m.png"), 1, {"b.qfilm: is damaged"});
  expectError(merge({"a.qfilm", "scene.gltf"}, "m.png"), 1, {"scene.gltf: is not a film file"});
  expectError(merge({"a.qfilm", "none.qfilm"}, "m.png"), 1, {"none.qfilm: cannot be read"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "m.png"));
}

TEST_F(Merge, FilmsAreNotLostUnasked) {
  part("0-3", "a.qfilm");
  part("4-7", "b.qfilm");
  part("0-3", "other.qfilm", {"--seed", "1"});
  const auto bytesOf = [&](const char* name) { return readFile(folder_ / name); };
  const std::vector<std::byte> other = bytesOf("other.qfilm");
  const RunResult result = merge({"a.qfilm", "b.qfilm"}, "other.qfilm");
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("quintet: other.qfilm: seed: 1 in the file, 0 here\n"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("--force"), std::string::npos) << result.err;
  expectError(merge({"a.qfilm"}, "b.qfilm"), 1, {"b.qfilm: holds samples 16 to 29", "--force"});
  expectError(merge({"a.qfilm"}, "scene.gltf.qfilm", {"-q", "-o", "scene.gltf"}), 2, {"-o"});
  expectMerged({"a.qfilm", "b.qfilm"}, "a.qfilm");  // nothing is lost
  EXPECT_EQ(bytesOf("other.qfilm"), other);
  expectMerged({"a.qfilm"}, "other.qfilm", {"-q", "--force"});
  // A rendering keeps to the same rule.
  const RunResult again = quintet(command({"--batches", "0-3", "-o", "b.qfilm"}));
  expectError(again, 1, {"b.qfilm: holds samples 16 to 29 of this rendering", "--force"});
  part("4-7", "b.qfilm");
  part("0-3", "b.qfilm", {"--force"});
  write(folder_ / "text.qfilm", "precious");
  expectError(quintet(command({"--batches", "0-3", "-o", "text.qfilm"})), 1,
              {"text.qfilm: is not a film file", "--force"});
}

// It may have been broken off: what is written counts, not what was planned.
TEST_F(Merge, FilmsAreNotLostToFewerSamples) {
  ASSERT_EQ(quintet(command({"-o", "a.qfilm"})).status, 0);
  const std::vector<std::byte> complete = readFile(folder_ / "a.qfilm");
  const std::vector<std::string> broken = command({"-o", "a.qfilm", "--time", "0"});  // one batch
  expectError(quintet(broken), 1, {"a.qfilm: holds samples 0 to 29 of this rendering", "--force"});
  std::vector<std::string> kept = broken;
  kept.insert(kept.end(), {"--checkpoint-file", "c.qfilm"});
  expectError(quintet(kept), 1, {"a.qfilm: holds samples 0 to 29"});
  EXPECT_EQ(readFile(folder_ / "a.qfilm"), complete);
  EXPECT_EQ(render::readFilm(folder_ / "c.qfilm").film.counts.samples(), 4u);
  std::vector<std::string> forced = broken;
  forced.push_back("--force");
  EXPECT_EQ(quintet(forced).status, 0);
  EXPECT_EQ(render::readFilm(folder_ / "a.qfilm").film.counts.samples(), 4u);
  ASSERT_EQ(quintet(command({"-o", "a.qfilm"})).status, 0);  // nothing is lost
}

TEST_F(Merge, InfoTellsWhatAFilmIsOf) {
  part("1-2", "a.qfilm");
  const RunResult text = quintet({"info", "a.qfilm"});
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_TRUE(text.out.starts_with("a.qfilm: film, 40x30, samples 4 to 11 of 30, ")) << text.out;
  EXPECT_NE(text.out.find("program files"), std::string::npos) << text.out;
  const nlohmann::json json = nlohmann::json::parse(quintet({"info", "a.qfilm", "--json"}).out);
  EXPECT_EQ(json["kind"], "film");
  EXPECT_EQ(json["samples"], nlohmann::json::parse("[[4, 12]]"));
  EXPECT_EQ(json["identity"]["seed"], "0");
  EXPECT_EQ(json["notes"]["scene"], "scene.gltf");
  std::filesystem::resize_file(folder_ / "a.qfilm", 999);
  expectError(quintet({"info", "a.qfilm"}), 1, {"a.qfilm: is truncated after 999 bytes"});
}

TEST_F(Merge, TellsOfOtherDevices) {
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

// A name within another one is another one.
TEST_F(Merge, DevicesAreNamedWhole) {
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

// How the picture is shown is told by the part with the first samples, its layers by all parts.
TEST_F(Merge, TheOrderOfThePartsChangesNoPicture) {
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
    EXPECT_NE(result.err.find(" aces is taken, as for the first samples\n"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(" 1.5 is taken, as for the first samples\n"), std::string::npos) << result.err;
    EXPECT_EQ(picture("m.png").data, picture("whole.png").data);
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

TEST_F(Merge, ExposureOfAFilmIsForItsPicture) {
  std::vector<std::string> arguments = command({"--batches", "0-7", "-o", "a.qfilm", "--exposure", "1"});
  std::erase(arguments, "--quiet");
  const RunResult result = quintet(arguments);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err.find("apply"), std::string::npos) << result.err;
  arguments = command({"-o", "a.exr", "--exposure", "1"});
  std::erase(arguments, "--quiet");
  EXPECT_NE(quintet(arguments).err.find("a.exr: linear radiance, --exposure and --tonemap do not apply"),
            std::string::npos);
}

// Written like that by somebody else: whatever the notes say, they are the file's fault, and nothing is read out of bounds.
TEST_F(Merge, NotesOfAFilmAreNotTrusted) {
  part("0-7", "a.qfilm", {"--aov", "all"});
  const render::FilmFile good = render::readFilm(folder_ / "a.qfilm");
  const auto refused = [&](const std::string& name, const std::string& value, const std::string& problem) {
    render::FilmFile file = good;
    std::erase_if(file.notes, [&](const auto& note) { return note.first == name; });
    file.notes.emplace_back(name, value);
    render::writeFilm(folder_ / "b.qfilm", file);
    expectError(merge({"b.qfilm"}, "m.exr"), 1, {"b.qfilm: header: " + problem});
    EXPECT_FALSE(std::filesystem::exists(folder_ / "m.exr"));
  };
  const auto layer = [](const std::string& name, int source, const std::string& channels = R"(["X"])",
                        const std::string& output = "0") {
    return R"({"name":")" + name + R"(","channels":)" + channels + R"(,"exact":true,"source":)" +
           std::to_string(source) + R"(,"output":)" + output + "}";
  };
  const std::string unfit = "the layers of the film are not those of its outputs";
  refused("layers", "[" + layer("a", 1) + "]", unfit);  // coverage, of a mean
  refused("layers", "[" + layer("a", 4) + "]", unfit);
  refused("layers", "[" + layer("a", 0, R"(["X"])", "1") + "]", unfit);
  refused("layers", "[" + layer("a..b", 0) + "]", unfit);
  refused("layers", "[" + layer("a", 0, R"(["\n"])") + "]", unfit);
  refused("layers", "[" + layer("a", 0) + "," + layer("a", 3) + "]",
          "--aov: 'a' and 'a' would both be the channel a.X");
  refused("layers", "[" + layer("a", 0, R"(["X"])", "-1") + "]", unfit);
  refused("layers", "[", "the layers of the film cannot be read");
  refused("layers", "[{}]", "the layers of the film cannot be read");
  refused("names of instances", "[1]", "the names of the film cannot be read");
  refused("exposure", "loud", "exposure: 'loud' is not a number");
  refused("seconds", "-1", "seconds: '-1' is not in [0, ");
  render::FilmFile file = good;
  file.film.region.x = 1;
  render::writeFilm(folder_ / "b.qfilm", file);
  expectError(merge({"b.qfilm"}, "m.exr"), 1, {"b.qfilm: header: the region is not in the picture"});
  file = good;
  file.notes.erase(std::ranges::find(file.notes, "layers", &render::FilmFacts::value_type::first));
  file.notes.emplace_back("layers", "[" + layer("a", 3) + "]");
  render::writeFilm(folder_ / "b.qfilm", file);
  expectMerged({"b.qfilm"}, "m.exr");  // the same way, but right
}

TEST_F(Merge, OptionsThatMakeNoSense) {
  part("0-7", "all.qfilm", {"--all-outputs"});
  expectError(merge({"all.qfilm"}, "-"), 2, {"--all-outputs", "-o -"});
  expectError(merge({"all.qfilm"}, "m.qfilm", {"--aov", "variance"}), 2, {"--aov is for OpenEXR files"});
  expectError(quintet({"merge"}), 2, {"no parts"});
  expectError(quintet({"merge", "a.qfilm"}), 2, {"no output", "-o"});
  expectError(merge({"a.qfilm"}, "m.txt"), 2, {"m.txt", ".qfilm"});
  expectError(merge({"a.qfilm"}, "m.png", {"--tonemap", "acess"}), 2, {"--tonemap", "did you mean 'aces'?"});
  expectError(merge({"a.qfilm"}, "m.png", {"--exposure", "x"}), 2, {"--exposure"});
  expectError(merge({"a.qfilm"}, "m.png", {"--exr-type", "half"}), 2, {"--exr-type", ".exr"});
  expectError(merge({"a.qfilm"}, "-", {"--json"}), 2, {"--json"});
  expectError(merge({"a.qfilm"}, "no/such/folder/m.png"), 1, {"no/such/folder"});
  expectError(quintet({"run", "normals", "-o", "a.qfilm"}), 2, {"a.qfilm", "render"});
}

}  // namespace
}  // namespace quintet::test

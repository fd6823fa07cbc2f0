// SPDX-License-Identifier: Apache-2.0
// Writes the corpora and the dictionaries of the libFuzzer targets.
//
//   quintet_fuzz_corpus --root FOLDER --out FOLDER
//
// --root is the source tree; --out gets a folder of files for each target, and NAME.dict for some. The files are the same
// in each run. The exit status is 1 if a file cannot be read or written.
#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <fstream>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "check/case_file.h"
#include "seeds.h"

namespace quintet::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxText = 6000;  // bytes of a text that becomes a seed
constexpr std::size_t kMaxTexts = 120;  // per target

// Adds the small files below a folder whose name ends with `suffix`.
void addTexts(std::vector<Seed>& seeds, const fs::path& folder, std::string_view suffix) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().filename().string().ends_with(suffix) && entry.file_size() <= kMaxText)
      files.push_back(entry.path());
  std::ranges::sort(files);
  for (const fs::path& file : files) {
    if (seeds.size() >= kMaxTexts) break;
    seeds.push_back({fmt::format("{:03}_{}", seeds.size(), file.filename().string()), readFile(file)});
  }
}

// Adds a small file of each case in `folder` that has it.
void addCases(std::vector<Seed>& seeds, const fs::path& folder, const std::string& name) {
  for (const fs::path& file : test::casesIn(folder)) {
    if (seeds.size() >= kMaxTexts) break;
    const test::CaseFiles files = test::readCase(file).files;
    const auto found = files.find(name);
    if (found == files.end() || found->second.size() > kMaxText) continue;
    const auto bytes = std::as_bytes(std::span(found->second));
    seeds.push_back({fmt::format("{:03}_{}", seeds.size(), name), {bytes.begin(), bytes.end()}});
  }
}

void addTextSeeds(Corpora& corpora, const fs::path& root) {
  for (const char* folder : {"examples", "programs"}) addTexts(corpora["scene"], root / folder, ".scene.toml");
  addTexts(corpora["lecture"], root / "programs", ".rt.glsl");
  addTexts(corpora["program"], root / "programs", "program.toml");
  addCases(corpora["lecture"], root / "tests/check/idioms", "program.rt.glsl");
  addCases(corpora["program"], root / "tests/check/idioms", "program.toml");
  // What no example has: files, textures, an environment and keyframes.
  constexpr std::string_view kMore = R"([[file]]
name = "part"
path = "part.gltf"
[[material]]
name = "wood"
base_color = "#804020"
base_color_texture = { image = "image.png", wrap = "clamp", filter = "nearest" }
keyframes = [{ time = 0, emissive = [1, 1, 1] }, { time = 1, emissive_strength = 5, transmission = 1, base_color = [1, 0, 0] }]
[[instance]]
of = "part/triangle"
material = "wood"
keyframes = [{ frame = 0, translate = [0, 0, 0] }, { frame = 10, translate = [1, 2, 3], rotate = [0, 90, 0] }]
[[light]]
type = "spot"
position = [0, 2, 0]
target = [0, 0, 0]
interpolation = { color = "step", intensity = "cubic" }
keyframes = [{ time = 0 }, { time = 1, position = [1, 2, 0], color = [1, 0, 0], inner_angle = 20, outer_angle = 30 },
  { time = 2, intensity = 3, in_tangent = { intensity = 2 } }]
[[camera]]
look_from = [0, 1, 4]
look_at = [0, 0, 0]
interpolation = "cubic"
keyframes = [{ frame = 0, fov = 30, focus = 2 }, { frame = 24, look_from = [4, 1, 0], up = [0, 1, 1], aperture = 0.1 }]
[environment]
image = "image.png"
intensity = 2
keyframes = [{ time = 0 }, { time = 2, intensity = 0, rotation = 90 }]
)";
  const auto bytes = std::as_bytes(std::span(kMore));
  corpora["scene"].push_back({"more.scene.toml", {bytes.begin(), bytes.end()}});
}

// The identifiers in string literals of the sources below the folders: the keys and names that a reader knows.
std::set<std::string> literals(const fs::path& root, std::span<const std::string_view> folders) {
  std::set<std::string> words;
  for (const std::string_view folder : folders)
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      if (!entry.is_regular_file()) continue;
      const std::string text = readTextFile(entry.path());
      for (std::size_t at = text.find('"'); at != std::string::npos; at = text.find('"', at + 1)) {
        const std::size_t end =
            text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_", at + 1);
        if (end == std::string::npos) break;
        if (text[end] == '"' && end > at + 2 && end - at < 50) words.insert(text.substr(at + 1, end - at - 1));
      }
    }
  return words;
}

// In the format of libFuzzer. `quote`: the words are in quotation marks, as in JSON.
void writeDictionary(const fs::path& file, const std::set<std::string>& words, bool quote) {
  std::ofstream out(file);
  for (const std::string& word : words) out << (quote ? "\"\\\"" + word + "\\\"\"" : '"' + word + '"') << '\n';
  if (!out.flush()) throw FileError(file, "cannot be written");
}

void writeCorpora(const fs::path& root, const fs::path& out) {
  Corpora corpora;
  addImageSeeds(corpora);
  addGltfSeeds(corpora);
  addFilmSeeds(corpora);
  addSpirvSeeds(corpora, root);
  addTextSeeds(corpora, root);
  addLabSeeds(corpora);
  for (const auto& [target, seeds] : corpora) {
    std::size_t bytes = 0;
    fs::remove_all(out / target);
    for (const Seed& seed : seeds) {
      fs::create_directories(out / target);
      writeFile(out / target / seed.name, seed.bytes);
      bytes += seed.bytes.size();
    }
    fmt::print("{}: {} files, {} bytes\n", target, seeds.size(), bytes);
  }
  using Folders = std::array<std::string_view, 1>;
  writeDictionary(out / "gltf.dict", literals(root, Folders{"src/scene/gltf"}), true);
  writeDictionary(out / "glb.dict", literals(root, Folders{"src/scene/gltf"}), true);
  writeDictionary(out / "scene.dict", literals(root, Folders{"src/scene/toml"}), false);
  writeDictionary(out / "program.dict", literals(root, Folders{"src/program/description"}), false);
  writeDictionary(out / "lecture.dict", literals(root, Folders{"src/program/lecture"}), false);
  writeDictionary(out / "lab_message.dict",
                  literals(root, std::array<std::string_view, 2>{"src/job/interactive", "src/lab"}), true);
  writeDictionary(out / "film.dict", literals(root, std::array<std::string_view, 1>{"src/render/film"}), true);
}

}  // namespace
}  // namespace quintet::fuzz

int main(int argc, char** argv) {
  const std::span<char*> arguments(argv, static_cast<std::size_t>(argc));
  if (arguments.size() != 5 || std::string_view(arguments[1]) != "--root" ||
      std::string_view(arguments[3]) != "--out") {
    fmt::print(stderr, "usage: quintet_fuzz_corpus --root FOLDER --out FOLDER\n");
    return 2;
  }
  try {
    quintet::fuzz::writeCorpora(arguments[2], arguments[4]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "quintet_fuzz_corpus: {}\n", error.what());
    return 1;
  }
}

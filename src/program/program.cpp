// Finds a program: a folder, or one of those compiled into the binary.
#include "program/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/embedded.h"
#include "base/error.h"
#include "base/file.h"
#include "base/toml_depth.h"
#include "program/lecture.h"
#include "program/program_parser.h"

namespace quintet {
std::span<const EmbeddedFile> embeddedPrograms();
}

namespace quintet::program {
namespace {

namespace fs = std::filesystem;

Program loadFolder(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && entry.file_size() <= (1u << 24))
      files[entry.path().filename().string()] = readTextFile(entry.path());
  const auto toml = files.find("program.toml");
  if (toml == files.end()) throw FileError(folder, "has no program.toml");
  const std::string text = toml->second;
  std::error_code ignored;
  const fs::path absolute = fs::canonical(folder, ignored);
  return parseProgram(text, absolute.filename().string(), folder.string(), std::move(files));
}

}  // namespace

bool isLibraryStage(const std::string& file) { return file.size() > 2 && file.front() == '<' && file.back() == '>'; }

const std::vector<std::string>& geometryClasses() {
  static const std::vector<std::string> kClasses{"triangles",  "solids", "csg",   "custom",
                                                 "procedural", "opaque", "alpha", "thin"};
  return kClasses;
}

std::string_view outputKindName(OutputKind kind) {
  constexpr std::array<std::string_view, 6> kNames{"color", "linear", "normal", "depth", "id", "display"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::string_view outputPixelName(OutputPixel pixel) {
  constexpr std::array<std::string_view, 3> kNames{"mean", "center", "coverage"};
  return kNames[static_cast<std::size_t>(pixel)];
}

std::vector<std::string> outputChannels(const Output& output) {
  if (!output.channels.empty()) return output.channels;
  switch (output.kind) {
    case OutputKind::color:
    case OutputKind::display: return {"R", "G", "B"};
    case OutputKind::linear:
    case OutputKind::normal: return {"X", "Y", "Z"};
    case OutputKind::depth: return {"Z"};
    case OutputKind::id: return {"X"};
  }
  return {};
}

bool holdsColor(const Output& output) {
  const std::vector<std::string> channels = outputChannels(output);
  const std::vector<std::string> colors{"R", "G", "B"};
  return channels.size() >= 3 && std::equal(colors.begin(), colors.end(), channels.begin());
}

std::vector<MissShader> missShaders(const Program& program) {
  std::vector<MissShader> all;
  for (const RayType& ray : program.rays) all.push_back({ray.name, ray.miss, ray.record, ray.line});
  all.insert(all.end(), program.misses.begin(), program.misses.end());
  return all;
}

std::vector<std::string> outputNames(const Program& program) {
  std::vector<std::string> names;
  for (const Output& output : program.outputs) names.push_back(output.name);
  return names;
}

Program parseProgram(const std::string& toml, const std::string& name, const std::string& origin,
                     std::map<std::string, std::string> files) {
  Program program;
  program.name = name;
  program.origin = origin;
  program.files = std::move(files);
  const std::string file = program.path(program.descriptionFile);
  if (const int line = deepTomlKey(toml); line > 0)
    throw FileError(file, fmt::format("line {}", line),
                    fmt::format("a dotted key of more than {} levels", kMaxTomlKeyDots));
  toml::table root;
  try {
    root = toml::parse(toml, file);
  } catch (const toml::parse_error& error) {
    throw FileError(file, fmt::format("line {}", error.source().begin.line), std::string(error.description()));
  }
  parseTables(program, root, file);
  chooseDefaultScene(program);
  return program;
}

void chooseDefaultScene(Program& program) {
  if (!program.scene.empty()) return;
  const auto isScene = [](const auto& file) { return file.first.ends_with(".scene.toml"); };
  if (std::ranges::count_if(program.files, isScene) == 1)
    program.scene = std::ranges::find_if(program.files, isScene)->first;
}

std::vector<std::string> builtInPrograms() {
  std::vector<std::string> names;
  constexpr std::string_view kEnd = "/program.toml";
  for (const EmbeddedFile& file : embeddedPrograms())
    if (file.path.ends_with(kEnd)) names.emplace_back(file.path.substr(0, file.path.size() - kEnd.size()));
  std::ranges::copy(builtInLectures(), std::back_inserter(names));
  std::ranges::sort(names);
  return names;
}

namespace {

// "lessons/05_shadow" is also called "05_shadow" and "shadow".
std::map<std::string, std::string> shortNames() {
  std::map<std::string, std::string> names;
  for (const std::string& full : builtInPrograms()) {
    std::string last = full.substr(full.rfind('/') + 1);
    for (int i = 0; i < 2; ++i) {
      const bool isNew = names.emplace(last, full).second;
      if (!isNew && names[last] != full) names[last].clear();  // two of them: none
      last.erase(0, last.find_first_not_of("0123456789_"));
    }
  }
  std::erase_if(names, [](const auto& entry) { return entry.second.empty() || entry.first.empty(); });
  return names;
}

[[noreturn]] void failUnknown(const std::string& name) {
  const std::map<std::string, std::string> known = shortNames();
  std::vector<std::string> candidates = builtInPrograms();
  for (const auto& [shortName, full] : known) candidates.push_back(shortName);
  const std::string nearest = nearestName(name, candidates);
  const auto found = known.find(nearest);
  const std::string full = found == known.end() ? nearest : found->second;
  throw UsageError(
      fmt::format("no program '{}': neither a folder with program.toml, nor a file {}.rt.glsl, nor a built-in one{}",
                  name, name, full.empty() ? "" : fmt::format("; did you mean '{}'?", full)));
}

}  // namespace

Program loadProgram(const std::string& nameOrFolder) {
  if (std::optional<Program> lecture = findLecture(nameOrFolder)) return std::move(*lecture);
  std::error_code ignored;
  fs::path path = nameOrFolder;
  if (path.filename() == "program.toml" && fs::is_regular_file(path, ignored))
    path = path.has_parent_path() ? path.parent_path() : ".";
  if (fs::is_directory(path, ignored) && fs::exists(path / "program.toml", ignored)) return loadFolder(path);

  std::map<std::string, std::string> files;
  const std::string prefix = nameOrFolder + "/";
  for (const EmbeddedFile& file : embeddedPrograms())
    if (file.path.starts_with(prefix)) files.emplace(file.path.substr(prefix.size()), file.data);
  if (files.count("program.toml")) {
    const std::string text = files.at("program.toml");
    return parseProgram(text, nameOrFolder, "<programs/" + nameOrFolder + ">", std::move(files));
  }
  if (fs::is_directory(path, ignored)) throw FileError(path, "has no program.toml");
  const std::map<std::string, std::string> known = shortNames();
  const auto found = known.find(nameOrFolder);
  if (found != known.end() && found->second != nameOrFolder) return loadProgram(found->second);
  failUnknown(nameOrFolder);
}

}  // namespace quintet::program

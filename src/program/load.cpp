// SPDX-License-Identifier: Apache-2.0
#include "program/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <span>

#include "base/embedded.h"
#include "base/error.h"
#include "base/file.h"
#include "base/file_roots.h"
#include "base/suggestion.h"
#include "program/description/parser.h"
#include "program/lecture/lecture.h"
#include "program/lecture/uniforms.h"
#include "shader/include_resolver.h"

namespace quintet {
std::span<const EmbeddedFile> embeddedPrograms();
}

namespace quintet::program {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{1} << 24;
constexpr std::uintmax_t kMaxImageBytes = std::uintmax_t{1} << 26;
constexpr std::size_t kMaxIncludes = 64;
constexpr std::string_view kDescription = "program.toml";

// Editors and version control keep files of their own beside a program.
bool isHidden(const fs::directory_entry& entry) { return entry.path().filename().native().starts_with('.'); }

// ---- folders with program.toml ----

Program loadFolder(const fs::path& folder) {
  std::map<std::string, std::string> files;
  const auto roots = FileRoots::fromEnvironment();
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (!isHidden(entry) && entry.is_regular_file() && entry.file_size() <= kMaxFileBytes && roots.allows(entry.path()))
      files[entry.path().filename().string()] = readTextFile(entry.path());
  const auto toml = files.find(std::string(kDescription));
  if (toml == files.end()) throw FileError(folder, "contains no program.toml");
  const std::string text = toml->second;
  std::error_code ignored;
  const fs::path absolute = fs::canonical(folder, ignored);
  return parseProgram(text, absolute.filename().string(), folder.string(), std::move(files));
}

std::optional<Program> findFolder(const std::string& nameOrPath) {
  std::error_code ignored;
  fs::path path = nameOrPath;
  if (path.filename() == kDescription && fs::is_regular_file(path, ignored))
    path = path.has_parent_path() ? path.parent_path() : ".";
  if (!fs::is_directory(path, ignored) || !fs::exists(path / kDescription, ignored)) return {};
  return loadFolder(path);
}

// ---- files of the lecture form ----

// Reads the images that comments of uniforms name as defaults.
void readImages(const fs::path& folder, const std::string& text, std::map<std::string, std::string>& files) {
  LectureErrors ignored(text, {});
  const auto roots = FileRoots::fromEnvironment();
  for (const LectureUniform& uniform : findUniforms(LectureText(text), ignored)) {
    const std::string& image = uniform.parameter.defaultImage;
    std::error_code failed;
    if (image.empty() || image.find('\0') != image.npos || files.count(image)) continue;
    if (!roots.allows(folder / image)) continue;
    if (fs::is_regular_file(folder / image, failed) && fs::file_size(folder / image, failed) <= kMaxImageBytes &&
        !failed)
      files[image] = readTextFile(folder / image);
  }
}

// Returns the files that `text` includes by quoted names relative to the folder, and those that they include.
std::map<std::string, std::string> readIncludes(const fs::path& folder, const std::string& text) {
  std::map<std::string, std::string> files;
  const auto roots = FileRoots::fromEnvironment();
  std::deque<std::string> open{text};
  while (!open.empty()) {
    const std::string current = std::move(open.front());
    open.pop_front();
    for (const shader::IncludeDirective& include : shader::findIncludes(current)) {
      if (!include.quoted || files.size() == kMaxIncludes || include.name.find('\0') != include.name.npos) continue;
      const fs::path path = folder / include.name;
      const std::string name = fs::path(include.name).lexically_normal().generic_string();
      std::error_code failed;
      if (files.count(name) || !roots.allows(path) || !fs::is_regular_file(path, failed) ||
          fs::file_size(path, failed) > kMaxLectureBytes || failed)
        continue;
      open.push_back(files[name] = readTextFile(path));
    }
  }
  return files;
}

// Returns whether a scene file has the name of a different lecture file in its folder and `text` does not mention it.
bool belongsToAnotherProgram(const fs::path& scene, const fs::path& file, const std::string& text) {
  const std::string name = scene.filename().string();
  const std::string stem = name.substr(0, name.size() - std::string_view(".scene.toml").size());
  const std::string owner = stem + std::string(kLectureExtension);
  std::error_code ignored;
  return owner != file.filename() && fs::exists(scene.parent_path() / owner, ignored) && text.find(name) == text.npos;
}

Program loadLecture(const fs::path& file) {
  std::error_code failed;
  if (fs::file_size(file, failed) > kMaxFileBytes && !failed) throw FileError(file, "is larger than 16 MiB");
  const std::string text = readTextFile(file);
  const fs::path folder = file.parent_path();
  std::map<std::string, std::string> files = readIncludes(folder, text);
  const auto roots = FileRoots::fromEnvironment();
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.empty() ? fs::path(".") : folder, failed)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".scene.toml") && roots.allows(entry.path()) && entry.is_regular_file(failed) &&
        entry.file_size(failed) <= kMaxLectureBytes && !belongsToAnotherProgram(entry.path(), file, text))
      files[name] = readTextFile(entry.path());
  }
  readImages(folder, text, files);
  return parseLecture(text, file.filename().string(), folder.string(), std::move(files));
}

// Returns the folder's lecture program if it is the only one and the folder has no program.toml.
std::optional<Program> loadOnlyLecture(const fs::path& folder) {
  std::optional<fs::path> only;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
    if (entry.path().filename() == kDescription) return {};
    if (!entry.path().filename().string().ends_with(kLectureExtension)) continue;
    if (only) return {};
    only = entry.path();
  }
  if (!only) return {};
  return loadLecture(*only);
}

std::optional<Program> findLecture(const std::string& nameOrPath) {
  std::error_code ignored;
  const fs::path path(nameOrPath);
  if (nameOrPath.ends_with(kLectureExtension) && fs::exists(path, ignored)) return loadLecture(path);
  if (fs::is_directory(path, ignored)) return loadOnlyLecture(path);
  if (const fs::path file = nameOrPath + std::string(kLectureExtension); fs::is_regular_file(file, ignored))
    return loadLecture(file);
  return {};
}

// ---- built-in programs ----

bool isLecture(const EmbeddedFile& file) { return file.path.ends_with(kLectureExtension); }
std::string folderOf(const EmbeddedFile& file) { return fs::path(file.path).parent_path().string(); }

// Returns whether the file is the only program of its folder, so that the folder's name is its name.
bool isOnlyProgram(const EmbeddedFile& file) {
  const std::string folder = folderOf(file);
  const auto isRival = [&](const EmbeddedFile& other) {
    return other.path != file.path && folderOf(other) == folder &&
           (isLecture(other) || other.path.ends_with("/program.toml"));
  };
  return !folder.empty() && std::ranges::none_of(embeddedPrograms(), isRival);
}

std::string builtInLectureName(const EmbeddedFile& file) {
  return isOnlyProgram(file) ? folderOf(file)
                             : std::string(file.path.substr(0, file.path.size() - kLectureExtension.size()));
}

// `name` is one of builtInPrograms(), or the path below programs/ with or without its extension.
std::optional<Program> findBuiltInLecture(const std::string& name) {
  const auto all = embeddedPrograms();
  const auto found = std::ranges::find_if(all, [&](const EmbeddedFile& file) {
    return isLecture(file) && (file.path == name || file.path == name + std::string(kLectureExtension) ||
                               builtInLectureName(file) == name);
  });
  if (found == all.end()) return {};
  const std::string path(found->path);
  const fs::path folder = fs::path(path).parent_path();
  std::map<std::string, std::string> siblings;
  for (const EmbeddedFile& file : all)
    if (fs::path(file.path).parent_path() == folder && !isLecture(file))
      siblings.emplace(fs::path(file.path).filename().string(), file.data);
  Program program = parseLecture(std::string(found->data), fs::path(path).filename().string(),
                                 "<programs/" + folder.string() + ">", std::move(siblings));
  program.name = builtInLectureName(*found);
  return program;
}

std::optional<Program> findBuiltInFolder(const std::string& name) {
  std::map<std::string, std::string> files;
  const std::string prefix = name + "/";
  for (const EmbeddedFile& file : embeddedPrograms())
    if (file.path.starts_with(prefix)) files.emplace(file.path.substr(prefix.size()), file.data);
  const auto toml = files.find(std::string(kDescription));
  if (toml == files.end()) return {};
  const std::string text = toml->second;
  return parseProgram(text, name, "<programs/" + name + ">", std::move(files));
}

// Returns the unambiguous short names: "lessons/05_shadow" is also called "05_shadow" and "shadow".
std::map<std::string, std::string> shortNames() {
  std::map<std::string, std::string> names;
  for (const std::string& full : builtInPrograms()) {
    std::string last = full.substr(full.rfind('/') + 1);
    for (int i = 0; i < 2; ++i) {
      const bool isNew = names.emplace(last, full).second;
      if (!isNew && names[last] != full) names[last].clear();  // ambiguous
      last.erase(0, last.find_first_not_of("0123456789_"));
    }
  }
  std::erase_if(names, [](const auto& entry) { return entry.second.empty() || entry.first.empty(); });
  return names;
}

// Returns whether a name that was not found is that of a file or folder rather than of a built-in program.
bool isPath(const std::string& name) {
  std::error_code ignored;
  const fs::path path(name), parent = path.parent_path();
  return name.ends_with(kLectureExtension) || name.ends_with('/') || name.starts_with('.') || path.is_absolute() ||
         (!parent.empty() && fs::is_directory(parent, ignored));
}

[[noreturn]] void failUnknown(const std::string& name) {
  const std::map<std::string, std::string> known = shortNames();
  std::vector<std::string> candidates = builtInPrograms();
  for (const auto& [shortName, full] : known) candidates.push_back(shortName);
  const std::string nearest = nearestName(name, candidates);
  const auto found = known.find(nearest);
  const std::string full = found == known.end() ? nearest : found->second;
  throw UsageError(
      fmt::format("unknown program '{}'{}; expected a folder with program.toml, a .rt.glsl file or a built-in program",
                  name, full.empty() ? "" : fmt::format(" (did you mean '{}'?)", full)));
}

// "<programs/lessons/05_shadow>" → "lessons/05_shadow"; empty for any other text.
std::string namedBuiltIn(const std::string& name) {
  constexpr std::string_view kBegin = "<programs/";
  if (!name.starts_with(kBegin) || !name.ends_with('>')) return {};
  return name.substr(kBegin.size(), name.size() - kBegin.size() - 1);
}

Program loadBuiltIn(const std::string& name) {
  if (std::optional<Program> program = findBuiltInLecture(name)) return std::move(*program);
  if (std::optional<Program> program = findBuiltInFolder(name)) return std::move(*program);
  failUnknown(name);
}

}  // namespace

bool isBuiltIn(const Program& program) { return program.origin.starts_with("<programs/"); }

std::vector<std::string> builtInPrograms() {
  std::vector<std::string> names;
  constexpr std::string_view kEnd = "/program.toml";
  for (const EmbeddedFile& file : embeddedPrograms()) {
    if (file.path.ends_with(kEnd)) names.emplace_back(file.path.substr(0, file.path.size() - kEnd.size()));
    if (isLecture(file)) names.push_back(builtInLectureName(file));
  }
  std::ranges::sort(names);
  return names;
}

Program loadProgram(const std::string& nameOrPath) {
  if (const std::string name = namedBuiltIn(nameOrPath); !name.empty()) return loadBuiltIn(name);
  if (std::optional<Program> program = findLecture(nameOrPath)) return std::move(*program);
  if (std::optional<Program> program = findFolder(nameOrPath)) return std::move(*program);
  std::error_code ignored;
  const bool isFolder = fs::is_directory(nameOrPath, ignored);
  if (!isFolder)
    if (std::optional<Program> program = findBuiltInLecture(nameOrPath)) return std::move(*program);
  if (std::optional<Program> program = findBuiltInFolder(nameOrPath)) return std::move(*program);
  if (isFolder) throw FileError(nameOrPath, "contains no program.toml");
  const std::map<std::string, std::string> known = shortNames();
  const auto found = known.find(nameOrPath);
  if (found != known.end() && found->second != nameOrPath) return loadProgram(found->second);
  if (isPath(nameOrPath)) throw FileError(nameOrPath, "does not exist");
  failUnknown(nameOrPath);
}

}  // namespace quintet::program

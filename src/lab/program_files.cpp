// SPDX-License-Identifier: Apache-2.0
#include "lab/program_files.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "program/lecture/lecture.h"
#include "program/load.h"
#include "program/new_program.h"

namespace quintet::lab {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBuiltInBegin = "<programs/";
constexpr std::string_view kDescription = "program.toml";
constexpr std::size_t kMaxSummaries = 200;
constexpr std::size_t kMaxFiles = 200;

bool isLectureName(std::string_view name) { return name.ends_with(program::kLectureExtension); }
std::string folderOf(const std::string& name) { return fs::path(name).parent_path().generic_string(); }
std::string joined(const std::string& folder, const std::string& name) {
  return folder.empty() ? name : folder + "/" + name;
}

std::string titleOf(const std::string& program) {
  if (!isBuiltIn(program)) return program;
  return program.substr(kBuiltInBegin.size(), program.size() - kBuiltInBegin.size() - 1);
}

std::string firstSentence(const std::string& text) {
  const std::size_t end = text.find(". ");
  return end == text.npos ? text : text.substr(0, end + 1);
}

bool isText(const std::string& text) {
  return text.find('\0') == text.npos && std::ranges::none_of(text, [](unsigned char c) { return c < 9; }) &&
         printable(text).size() <= text.size() && text.size() <= program::kMaxLectureBytes;
}

// The roles of the files that the description names.
std::map<std::string, std::string> rolesOf(const program::Program& program) {
  std::map<std::string, std::string> roles;
  const auto add = [&](const std::string& file, const char* role) {
    if (!file.empty() && !program::isLibraryStage(file)) roles.emplace(file, role);
  };
  const bool isLecture = isLectureName(program.descriptionFile);
  add(program.descriptionFile, isLecture ? "lecture" : "description");
  add(program.scene, "scene");
  if (isLecture) return roles;
  add(program.rayGeneration, "raygen");
  for (const program::HitGroup& group : program.hitGroups)
    for (const auto& [ray, shaders] : group.shaders) {
      add(shaders.closestHit, "closesthit");
      add(shaders.anyHit, "anyhit");
      add(shaders.intersection, "intersection");
    }
  for (const program::MissShader& miss : program::missShaders(program)) add(miss.file, "miss");
  for (const program::Callable& callable : program.callables) add(callable.file, "callable");
  return roles;
}

// Parts that the parser of the lecture form has split from the file are not files of the user.
bool isGenerated(const program::Program& program, const std::string& file) {
  return isLectureName(program.descriptionFile) && file.starts_with(program.descriptionFile + ".");
}

// "…/mine/../common.glsl" → "common.glsl": names in the project for the paths below it.
std::string shownName(const ProjectFolder& project, const std::string& path) {
  const std::string prefix = project.root().string() + "/";
  const std::string normal = fs::path(path).lexically_normal().string();
  return normal.starts_with(prefix) ? normal.substr(prefix.size()) : path;
}

void describe(ProgramFiles& result, const ProjectFolder& project, const program::Program& program) {
  const bool builtIn = isBuiltIn(result.name);
  const auto nameOf = [&](const std::string& file) { return shownName(project, program.path(file)); };
  result.form = isLectureName(program.descriptionFile) ? "lecture" : "folder";
  result.main = nameOf(program.descriptionFile);
  if (!program.scene.empty()) result.scene = nameOf(program.scene);
  const std::map<std::string, std::string> roles = rolesOf(program);
  for (const auto& [file, text] : program.files) {
    if (isGenerated(program, file) || !isText(text)) continue;
    if (!builtIn && !isFileName(nameOf(file))) continue;  // it includes a file from outside of the project
    const auto role = roles.find(file);
    const bool scene = file.ends_with(".scene.toml");
    result.files.push_back({nameOf(file),
                            role != roles.end() ? role->second
                            : scene             ? "scene"
                                                : "include",
                            builtIn ? "" : contentHash(text), text});
  }
  for (Diagnostic diagnostic : program.diagnostics) {
    diagnostic.file = shownName(project, diagnostic.file);
    for (RelatedLocation& related : diagnostic.related) related.file = shownName(project, related.file);
    result.diagnostics.push_back(std::move(diagnostic));
  }
}

// The files of a program whose description is broken, so that it can be corrected.
void describeBroken(ProgramFiles& result, const ProjectFolder& project, const FileError& error) {
  const fs::path path = project.locate(result.name);
  const std::string folder = fs::is_directory(path) ? result.name : folderOf(result.name);
  result.form = isLectureName(result.name) ? "lecture" : "folder";
  result.main = isLectureName(result.name) ? result.name : joined(folder, std::string(kDescription));
  for (const ProjectFolder::Entry& entry : project.list().files) {
    if (folderOf(entry.name) != folder || entry.size > program::kMaxLectureBytes) continue;
    const std::string text = project.read(entry.name);
    if (isText(text) && result.files.size() < kMaxFiles)
      result.files.push_back(
          {entry.name, entry.name == result.main ? "description" : "include", contentHash(text), text});
  }
  Diagnostic diagnostic = asDiagnostic(error);
  diagnostic.file = shownName(project, diagnostic.file);
  result.diagnostics.push_back(std::move(diagnostic));
}

ProgramSummary summaryOf(const std::string& name, const std::string& loadable) {
  ProgramSummary summary{name, titleOf(name), ""};
  try {
    summary.description = firstSentence(program::loadProgram(loadable).description);
  } catch (const Error&) {  // it can be opened and corrected
  }
  return summary;
}

}  // namespace

bool isBuiltIn(std::string_view program) { return program.starts_with(kBuiltInBegin) && program.ends_with('>'); }

std::string loadableName(const ProjectFolder& project, const std::string& program) {
  if (isBuiltIn(program)) return program;
  const fs::path path = project.locate(program);
  std::error_code error;
  if (!fs::exists(path, error)) throw FileError(program, "does not exist");
  return path.string();
}

ProgramFiles programFiles(const ProjectFolder& project, const std::string& program) {
  ProgramFiles result{.name = program, .title = titleOf(program)};
  const std::string loadable = loadableName(project, program);
  try {
    describe(result, project, program::loadProgram(loadable));
  } catch (const FileError& error) {
    if (isBuiltIn(program)) throw;
    describeBroken(result, project, error);
  }
  std::ranges::stable_sort(result.files, [&](const ProgramFile& a, const ProgramFile& b) {
    return std::pair(a.name != result.main, a.name) < std::pair(b.name != result.main, b.name);
  });
  return result;
}

std::vector<ProgramSummary> builtInSummaries() {
  std::vector<ProgramSummary> summaries;
  for (const std::string& name : program::builtInPrograms()) {
    const std::string program = fmt::format("{}{}>", kBuiltInBegin, name);
    summaries.push_back(summaryOf(program, program));
  }
  return summaries;
}

std::vector<ProgramSummary> projectSummaries(const ProjectFolder& project) {
  std::map<std::string, std::vector<std::string>> programs;  // of each folder
  for (const ProjectFolder::Entry& entry : project.list().files) {
    const std::string file = fs::path(entry.name).filename().string();
    if (file == kDescription || isLectureName(file)) programs[folderOf(entry.name)].push_back(entry.name);
  }
  std::vector<ProgramSummary> summaries;
  for (const auto& [folder, files] : programs)
    for (const std::string& file : files) {
      const bool hasFolderName = !folder.empty() && (files.size() == 1 || fs::path(file).filename() == kDescription);
      const std::string& name = hasFolderName ? folder : file;
      if (summaries.size() < kMaxSummaries) summaries.push_back(summaryOf(name, (project.root() / name).string()));
    }
  return summaries;
}

std::vector<std::string> projectScenes(const ProjectFolder& project) {
  std::vector<std::string> scenes;
  for (const ProjectFolder::Entry& entry : project.list().files) {
    const std::string name = lowerCase(entry.name);
    if (name.ends_with(".gltf") || name.ends_with(".glb") || name.ends_with(".scene.toml"))
      scenes.push_back(entry.name);
  }
  return scenes;
}

std::map<std::string, std::string> copiedFiles(const ProjectFolder& project, const std::string& program) {
  if (program.empty()) return program::planNewProgram({.name = "new", .from = "", .folder = false}).files;
  const program::Program loaded = program::loadProgram(loadableName(project, program));
  std::map<std::string, std::string> files;
  for (const auto& [file, text] : loaded.files)
    if (!isGenerated(loaded, file) && isFileName(file)) files.emplace(file, text);
  return files;
}

std::vector<std::string> writeFiles(const ProjectFolder& project, const std::string& folder,
                                    const std::map<std::string, std::string>& files, bool replace) {
  std::vector<std::string> names, different;
  for (const auto& [file, text] : files) {
    const std::string name = joined(folder, file);
    std::error_code error;
    const fs::path path = project.locate(name);
    if (fs::exists(path, error) && (!fs::is_regular_file(path, error) || project.read(name) != text))
      different.push_back(name);
    names.push_back(name);
  }
  if (!different.empty() && !replace)
    throw OverwriteError(fmt::format("{}: has a different content", different.front()), different);
  for (const auto& [file, text] : files) project.write(joined(folder, file), text, {});
  return names;
}

}  // namespace quintet::lab

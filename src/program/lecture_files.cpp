// Finds programs of the lecture form: a file with what it includes, or one that is compiled into the binary.
#include <algorithm>
#include <deque>

#include "base/embedded.h"
#include "base/error.h"
#include "base/file.h"
#include "program/lecture.h"
#include "program/lecture_uniforms.h"
#include "shader/include_resolver.h"

namespace quintet {
std::span<const EmbeddedFile> embeddedPrograms();
}

namespace quintet::program {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxImageBytes = std::size_t{1} << 26;
constexpr std::size_t kMaxIncludes = 64;

// Pictures that a uniform's comment names as its default.
void readImages(const fs::path& folder, const std::string& text, std::map<std::string, std::string>& files) {
  const std::vector<Token> tokens = tokenize(text);
  LectureErrors ignored(text, {});
  for (const LectureUniform& uniform : findUniforms(text, tokens, ignored)) {
    const std::string& image = uniform.parameter.defaultImage;
    std::error_code failed;
    if (image.empty() || image.find('\0') != image.npos || files.count(image)) continue;
    if (fs::is_regular_file(folder / image, failed) && fs::file_size(folder / image, failed) <= kMaxImageBytes &&
        !failed)
      files[image] = readTextFile(folder / image);
  }
}

// The files that `text` includes by quoted names, below the folder, and what those include.
std::map<std::string, std::string> readIncludes(const fs::path& folder, const std::string& text) {
  std::map<std::string, std::string> files;
  std::deque<std::string> open{text};
  while (!open.empty()) {
    const std::string current = std::move(open.front());
    open.pop_front();
    for (const shader::IncludeDirective& include : shader::findIncludes(current)) {
      if (!include.quoted || files.size() == kMaxIncludes || include.name.find('\0') != include.name.npos) continue;
      const fs::path path = folder / include.name;
      const std::string name = fs::path(include.name).lexically_normal().generic_string();
      std::error_code failed;
      if (files.count(name) || !fs::is_regular_file(path, failed) || fs::file_size(path, failed) > kMaxLectureBytes ||
          failed)
        continue;
      open.push_back(files[name] = readTextFile(path));
    }
  }
  return files;
}

// Of another lecture file beside this one; one that the text names serves both.
bool isOfAnother(const fs::path& scene, const fs::path& file, const std::string& text) {
  const std::string name = scene.filename().string();
  const std::string stem = name.substr(0, name.size() - std::string_view(".scene.toml").size());
  const std::string owner = stem + std::string(kLectureExtension);
  std::error_code ignored;
  return owner != file.filename() && fs::exists(scene.parent_path() / owner, ignored) && text.find(name) == text.npos;
}

Program load(const fs::path& file) {
  std::error_code failed;
  if (fs::file_size(file, failed) > (1u << 24) && !failed) throw FileError(file, "is larger than 16 MiB");
  const std::string text = readTextFile(file);
  const fs::path folder = file.parent_path();
  std::map<std::string, std::string> files = readIncludes(folder, text);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.empty() ? fs::path(".") : folder, failed)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".scene.toml") && entry.is_regular_file(failed) && entry.file_size(failed) <= kMaxLectureBytes &&
        !isOfAnother(entry.path(), file, text))
      files[name] = readTextFile(entry.path());
  }
  readImages(folder, text, files);
  return parseLecture(text, file.filename().string(), folder.string(), std::move(files));
}

// The folder's lecture file, if it is the only one and there is no program.toml.
std::optional<Program> loadOnly(const fs::path& folder) {
  std::optional<fs::path> only;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
    if (entry.path().filename() == "program.toml") return {};
    if (!entry.path().filename().string().ends_with(kLectureExtension)) continue;
    if (only) return {};
    only = entry.path();
  }
  if (!only) return {};
  return load(*only);
}

bool isLecture(const EmbeddedFile& file) { return file.path.ends_with(kLectureExtension); }
std::string folderOf(const EmbeddedFile& file) { return fs::path(file.path).parent_path().string(); }

// Is it the only lecture file of its folder, and is the folder no folder program? Then the folder's name is its name.
bool isAlone(const EmbeddedFile& file) {
  const std::string folder = folderOf(file);
  const auto rival = [&](const EmbeddedFile& other) {
    return other.path != file.path && folderOf(other) == folder &&
           (isLecture(other) || other.path.ends_with("/program.toml"));
  };
  return !folder.empty() && std::ranges::none_of(embeddedPrograms(), rival);
}

std::string builtInName(const EmbeddedFile& file) {
  return isAlone(file) ? folderOf(file) : std::string(file.path.substr(0, file.path.size() - kLectureExtension.size()));
}

// `name`: as builtInLectures lists it, or the path with or without its extension.
std::optional<Program> builtIn(const std::string& name) {
  const auto all = embeddedPrograms();
  const auto found = std::ranges::find_if(all, [&](const EmbeddedFile& file) {
    return isLecture(file) &&
           (file.path == name || file.path == name + std::string(kLectureExtension) || builtInName(file) == name);
  });
  if (found == all.end()) return {};
  const std::string path(found->path);
  const fs::path folder = fs::path(path).parent_path();
  std::map<std::string, std::string> beside;
  for (const EmbeddedFile& file : all)
    if (fs::path(file.path).parent_path() == folder && !file.path.ends_with(kLectureExtension))
      beside.emplace(fs::path(file.path).filename().string(), file.data);
  Program program = parseLecture(std::string(found->data), fs::path(path).filename().string(),
                                 "<programs/" + folder.string() + ">", std::move(beside));
  program.name = builtInName(*found);
  return program;
}

}  // namespace

std::vector<std::string> builtInLectures() {
  std::vector<std::string> names;
  for (const EmbeddedFile& file : embeddedPrograms())
    if (isLecture(file)) names.push_back(builtInName(file));
  return names;
}

std::optional<Program> findLecture(const std::string& nameOrPath) {
  std::error_code ignored;
  const fs::path path(nameOrPath);
  if (nameOrPath.ends_with(kLectureExtension) && fs::exists(path, ignored)) return load(path);
  if (fs::is_directory(path, ignored)) return loadOnly(path);
  if (nameOrPath.ends_with(kLectureExtension) && path.has_parent_path()) throw FileError(path, "does not exist");
  if (const fs::path file = nameOrPath + std::string(kLectureExtension); fs::is_regular_file(file, ignored))
    return load(file);
  return builtIn(nameOrPath);
}

}  // namespace quintet::program

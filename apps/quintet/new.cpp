// `quintet new`: a program that renders at once, from a template or as a copy of another program.
#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "cli.h"
#include "new_templates.h"
#include "program/lecture.h"
#include "program/program.h"
#include "values.h"

namespace quintet::app {
namespace {

namespace fs = std::filesystem;
using Files = std::map<std::string, std::string>;  // relative path -> text

constexpr const char* kExamples =
    "  quintet new first                       first.rt.glsl, a commented lesson in one file\n"
    "  quintet new sketches/first --folder     the same as a folder with program.toml\n"
    "  quintet new mine --from pathtracer      a copy of a built-in program (quintet run --list)\n";

struct Options {
  std::string name;
  std::string from;
  bool folder = false;
};

// What is to be written, and how the user calls it.
struct NewProgram {
  fs::path folder;  // of the files
  Files files;
  fs::path program;
};

bool isLecture(const program::Program& program) {
  return program.descriptionFile.ends_with(program::kLectureExtension);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); !from.empty() && at != text.npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

// The lecture file under its new name and what it needs: files whose names stand in those that are copied.
Files copyOfLecture(const program::Program& source, const std::string& stem) {
  const std::string& main = source.descriptionFile;
  std::vector<std::string> open{main}, taken{main};
  if (!source.scene.empty()) open.push_back(source.scene), taken.push_back(source.scene);
  while (!open.empty()) {
    const std::string text = source.files.at(open.back());
    open.pop_back();
    for (const auto& [name, ignored] : source.files) {
      const bool generated = name.starts_with(main + ".");
      if (generated || std::ranges::find(taken, name) != taken.end() || text.find(name) == std::string::npos) continue;
      open.push_back(name);
      taken.push_back(name);
    }
  }
  // The scene is called like its program, also where the text names it.
  const std::string ownScene = stem + ".scene.toml";
  Files files;
  for (const std::string& name : taken) {
    const bool isMain = name == main, isScene = name == source.scene;
    const std::string& text = source.files.at(name);
    files[isMain    ? stem + std::string(program::kLectureExtension)
          : isScene ? ownScene
                    : name] = isMain ? replaced(text, source.scene, ownScene) : text;
  }
  return files;
}

NewProgram plan(const Options& options) {
  fs::path path = fs::path(options.name).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  std::string stem = path.filename().string();
  if (stem.ends_with(program::kLectureExtension)) stem.resize(stem.size() - program::kLectureExtension.size());
  if (stem.empty() || stem == "." || stem == "..")
    throw UsageError(fmt::format("'{}' is not a name for a program", options.name));
  const fs::path folder = path.parent_path() / stem;
  const std::string file = stem + std::string(program::kLectureExtension);
  if (options.from.empty())
    return options.folder ? NewProgram{folder, folderTemplate(), folder}
                          : NewProgram{path.parent_path(), lectureTemplate(file), path.parent_path() / file};
  const program::Program source = program::loadProgram(options.from);
  if (!isLecture(source)) return {folder, source.files, folder};
  const fs::path home = options.folder ? folder : path.parent_path();
  return {home, copyOfLecture(source, stem), home / file};
}

// Nothing is written unless everything can be.
void create(const NewProgram& made, const Options& options) {
  std::error_code failed;
  if (made.program == made.folder && fs::exists(made.folder, failed))
    throw FileError(made.folder, "exists already; take another name");
  for (const auto& [name, text] : made.files)
    if (fs::exists(made.folder / name, failed))
      throw FileError(made.folder / name, "exists already; take another name");
  // `quintet run NAME` must mean the new program.
  const bool single = made.program != made.folder && !options.folder;
  const fs::path stem = fs::path(options.name).lexically_normal();
  if (single && fs::is_directory(stem, failed)) throw FileError(stem, "is a folder; take another name");
  failed.clear();
  if (!made.folder.empty()) fs::create_directories(made.folder, failed);
  if (failed) throw FileError(made.folder, "cannot be made: " + failed.message());
  for (const auto& [name, text] : made.files) {
    const fs::path file = made.folder / name;
    if (fs::path(name).has_parent_path()) fs::create_directories(file.parent_path(), failed);
    writeFile(file, text);
  }
}

}  // namespace

int newCommand(Arguments arguments) {
  CLI::App app("Begins a program that renders at once: one file, or a folder.", "quintet new");
  Options options;
  app.add_option("NAME", options.name, "Of the program; folders in front of it are made")->type_name("");
  app.add_option("--from", options.from, "Begin with a copy of this program: a lesson, another built-in one, or a path")
      ->type_name("PROGRAM");
  app.add_flag("--folder", options.folder, "A folder with program.toml instead of one file");
  setUp(app, kExamples);
  if (!parse(app, arguments)) return 0;
  if (options.name.empty()) throw UsageError("no name given; see 'quintet new --help'");

  const NewProgram made = plan(options);
  create(made, options);
  const std::string name = shellQuoted(made.program.string());
  std::string text = fmt::format("{}: made", plain(made.program.string()));
  if (made.files.size() > 1) text += fmt::format(", {} files", made.files.size());
  text += fmt::format(
      "\n\nNext:\n  quintet run {} --watch    render it, and again whenever you save\n"
      "  quintet run {} --help     its parameters\n",
      name, name);
  writeFile("-", text);
  return 0;
}

}  // namespace quintet::app

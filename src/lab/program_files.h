// SPDX-License-Identifier: Apache-2.0
// Programs as the page sees them: names, files with their roles, and copies. A program is a folder or file of the
// project, or a built-in one in angle brackets: "<programs/lessons/05_shadow>".
#ifndef QUINTET_LAB_PROGRAM_FILES_H
#define QUINTET_LAB_PROGRAM_FILES_H

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "lab/project_folder.h"
#include "program/description/program.h"

namespace quintet::lab {

bool isBuiltIn(std::string_view program);

// The program as for program::loadProgram(). Throws NameError for a name outside of the project, FileError for a program
// of the project that does not exist.
std::string loadableName(const ProjectFolder& project, const std::string& program);

struct ProgramFile {
  std::string name;  // as in diagnostics
  std::string role;  // "lecture", "description", "scene", "raygen", …, "include"
  std::string hash;  // of a file of the project; empty if built in
  std::string text;
};

struct ProgramFiles {
  std::string name, title;
  std::string form;                     // "lecture" or "folder"
  std::string main;                     // name of the file that makes it a program
  std::string scene;                    // name of the scene that the program has itself; empty if none
  std::vector<ProgramFile> files;       // texts only, `main` first
  std::vector<Diagnostic> diagnostics;  // why it cannot be read
};

// Throws as loadableName(), and UsageError for an unknown built-in program.
ProgramFiles programFiles(const ProjectFolder& project, const std::string& program);

struct ProgramSummary {
  std::string name, title;
  std::string description;  // one sentence; empty if the program cannot be read
};
std::vector<ProgramSummary> builtInSummaries();
std::vector<ProgramSummary> projectSummaries(const ProjectFolder& project);
std::vector<std::string> projectScenes(const ProjectFolder& project);  // glTF and scene files

// Path in the folder of the program → bytes. Empty `program`: the template of a new program.
std::map<std::string, std::string> copiedFiles(const ProjectFolder& project, const std::string& program);

// Writes the files into a folder of the project and returns their names. Throws OverwriteError before writing if one of
// them exists with a different content, unless `replace` is set.
class OverwriteError : public Error {
 public:
  OverwriteError(const std::string& message, std::vector<std::string> files)
      : Error(message), files_(std::move(files)) {}
  const std::vector<std::string>& files() const { return files_; }

 private:
  std::vector<std::string> files_;
};
std::vector<std::string> writeFiles(const ProjectFolder& project, const std::string& folder,
                                    const std::map<std::string, std::string>& files, bool replace);

}  // namespace quintet::lab
#endif

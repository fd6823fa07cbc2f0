// SPDX-License-Identifier: Apache-2.0
// What the argument of `quintet lab` means: which folder is the project, which files of it, and which program and scene a session
// shows. A file that is opened by its name, such as one in the folder of downloads, gives no access to the files beside it.
#ifndef QUINTET_LAB_START_TARGET_H
#define QUINTET_LAB_START_TARGET_H

#include <filesystem>
#include <string>
#include <vector>

namespace quintet::lab {

struct StartTarget {
  std::filesystem::path folder;    // of the project; may not exist yet
  std::vector<std::string> files;  // that belong to the project, names in `folder`; empty means all
  std::string program;             // as in the protocol
  std::string scene;               // file of the project; empty means that of the program
};

// Folder of the project if the argument is empty or a built-in program.
inline constexpr const char* kDefaultFolder = "quintet-lab";
// Shown if a project has no programs.
inline constexpr const char* kDefaultProgram = "<programs/lessons/01_first_ray>";

// `argument`: a folder of programs, a program, a scene file, or empty. Throws UsageError for an unknown program, FileError
// for a scene that does not exist.
StartTarget chooseStart(const std::string& argument);

}  // namespace quintet::lab
#endif

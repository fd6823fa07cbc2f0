// SPDX-License-Identifier: Apache-2.0
// Creates programs: from a template, or by copying an existing program under a new name.
#ifndef QUINTET_PROGRAM_NEW_PROGRAM_H
#define QUINTET_PROGRAM_NEW_PROGRAM_H

#include <filesystem>
#include <map>
#include <string>

namespace quintet::program {

struct NewProgramOptions {
  std::string name;     // path of the program, with or without .rt.glsl
  std::string from;     // program to copy, as for loadProgram; empty means a template
  bool folder = false;  // create a folder with program.toml instead of one file of the lecture form
};

// The files of a new program, before anything is written.
struct NewProgram {
  std::filesystem::path folder;              // that `files` are relative to
  std::map<std::string, std::string> files;  // relative path → text
  std::filesystem::path program;             // folder or file to run
  // Path that must not be a folder, because `quintet run NAME` would find the folder first; empty if none.
  std::filesystem::path shadowing;
};

// Plans the program. The copy of a lecture-form program has the files that it mentions, directly or indirectly, and its
// scene under the new name. Throws UsageError for an unusable name or an unknown program to copy.
NewProgram planNewProgram(const NewProgramOptions& options);

// Writes the files. Throws FileError before writing anything if one of them exists.
void createProgram(const NewProgram& program);

}  // namespace quintet::program
#endif

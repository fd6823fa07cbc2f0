// SPDX-License-Identifier: Apache-2.0
// The entries of a folder that the viewer can open.
#ifndef QUINTET_VIEWER_FOLDER_LISTING_H
#define QUINTET_VIEWER_FOLDER_LISTING_H

#include <filesystem>
#include <string>
#include <vector>

#include "viewer/dropped_file.h"

namespace quintet::viewer {

struct FolderEntry {
  std::string name;
  FileUse use = FileUse::unknown;  // of a folder: program, or unknown for one that can only be entered
  bool folder = false;
};

// Folders first, then files with a use, each sorted by name without regard to case. Hidden entries are omitted. Throws
// FileError if the folder cannot be read.
std::vector<FolderEntry> listFolder(const std::filesystem::path& folder);

}  // namespace quintet::viewer
#endif

// SPDX-License-Identifier: Apache-2.0
#include "job/live_module_check.h"

#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

namespace quintet::job {

namespace fs = std::filesystem;

namespace {

// Adds a folder and its subfolders, except for hidden ones and symbolic links: checkModuleFiles() does not search those.
void addWatchedFolders(const fs::path& folder, std::vector<fs::path>& folders) {
  folders.push_back(folder);
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
    const bool hidden = entry.path().filename().string().starts_with('.');
    if (!hidden && entry.is_directory(failed) && !entry.is_symlink(failed)) addWatchedFolders(entry.path(), folders);
  }
}

}  // namespace

LiveModuleCheck::LiveModuleCheck(ModuleCheckRequest request) : request_(std::move(request)) {
  watcher_.watch(requested());
}

CheckReport LiveModuleCheck::run(CheckObserver& observer) {
  CheckReport report = checkModuleFiles(request_, observer);
  WatchList list = requested();
  for (const ProgramReport& pipeline : report.programs) list.addFiles(pipeline.files);
  watcher_.watch(std::move(list));
  return report;
}

WatchList LiveModuleCheck::requested() const {
  WatchList list;
  list.anyFile = true;
  if (!request_.groups.empty()) list.addFile(request_.groups);
  for (const fs::path name : request_.modules) {
    std::error_code failed;
    if (fs::is_directory(name, failed))
      addWatchedFolders(name, list.folders);
    else
      list.addFile(name);
  }
  return list;
}

}  // namespace quintet::job

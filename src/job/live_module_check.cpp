// SPDX-License-Identifier: Apache-2.0
#include "job/live_module_check.h"

#include <system_error>
#include <utility>

namespace quintet::job {

namespace fs = std::filesystem;

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
    if (!fs::is_directory(name, failed)) {
      list.addFile(name);
      continue;
    }
    list.folders.push_back(name);
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(name, failed))
      if (entry.is_directory(failed) && !entry.path().filename().string().starts_with('.'))
        list.folders.push_back(entry.path());
  }
  return list;
}

}  // namespace quintet::job

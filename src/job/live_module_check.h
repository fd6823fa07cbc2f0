// SPDX-License-Identifier: Apache-2.0
// Checks raw SPIR-V modules again whenever one of them or their groups file is written.
#ifndef QUINTET_JOB_LIVE_MODULE_CHECK_H
#define QUINTET_JOB_LIVE_MODULE_CHECK_H

#include "job/module_checks.h"
#include "job/source_watcher.h"

namespace quintet::job {

class LiveModuleCheck {
 public:
  // What the request names is watched from now on, so that a save during the first check counts.
  explicit LiveModuleCheck(ModuleCheckRequest request);

  // Checks what is on disk now, and then watches the modules, the groups file, and the folders of the request and their
  // subfolders for new files. Throws as checkModuleFiles(); the files that were watched before stay.
  CheckReport run(CheckObserver& observer);

  SourceWatcher& watcher() { return watcher_; }

 private:
  WatchList requested() const;

  const ModuleCheckRequest request_;
  SourceWatcher watcher_;
};

}  // namespace quintet::job
#endif

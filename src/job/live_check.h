// SPDX-License-Identifier: Apache-2.0
// Checks programs again whenever one of their files is saved.
#ifndef QUINTET_JOB_LIVE_CHECK_H
#define QUINTET_JOB_LIVE_CHECK_H

#include "job/program_checks.h"
#include "job/source_watcher.h"

namespace quintet::job {

class LiveCheck {
 public:
  // `checks` outlives this object. Its programs are watched from now on, so that a save during the first check counts.
  explicit LiveCheck(const ProgramChecks& checks);

  // Checks what is on disk now, and then watches all files that the result depends on, and the folders of the programs
  // for new files. Throws as ProgramChecks::run(); the files that were watched before stay.
  CheckReport run(CheckObserver& observer);

  SourceWatcher& watcher() { return watcher_; }

 private:
  void addRequest(WatchList& list) const;

  const ProgramChecks& checks_;
  SourceWatcher watcher_;
};

}  // namespace quintet::job
#endif

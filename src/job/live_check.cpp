// SPDX-License-Identifier: Apache-2.0
#include "job/live_check.h"

#include <utility>

namespace quintet::job {

LiveCheck::LiveCheck(const ProgramChecks& checks) : checks_(checks) {
  WatchList list;
  addRequest(list);
  watcher_.watch(std::move(list));
}

CheckReport LiveCheck::run(CheckObserver& observer) {
  CheckReport report = checks_.run(observer);
  // With an error, the files of the last check stay: its cause can be among them.
  WatchList list = report.passes(false) ? WatchList() : watcher_.watched();
  addRequest(list);
  for (const ProgramReport& program : report.programs) {
    list.addProgram(program.name);
    list.addFiles(program.files);
  }
  watcher_.watch(std::move(list));
  return report;
}

void LiveCheck::addRequest(WatchList& list) const {
  const CheckRequest& request = checks_.request();
  for (const std::string& name : request.programs) list.addProgram(name);
  if (!request.scene.empty()) list.addFile(request.scene);
  if (!request.run.parameterFile.empty()) list.addFile(request.run.parameterFile);
}

}  // namespace quintet::job

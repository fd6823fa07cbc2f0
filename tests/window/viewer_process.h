// SPDX-License-Identifier: Apache-2.0
// quintet-view as a process on an X server, its events, and its controls by name.
#ifndef QUINTET_TESTS_WINDOW_VIEWER_PROCESS_H
#define QUINTET_TESTS_WINDOW_VIEWER_PROCESS_H

#include <sys/types.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/image.h"
#include "x_server.h"

namespace quintet::test {

using Json = nlohmann::json;

class ViewerProcess {
 public:
  // Starts in `folder`, where the settings are stored too, with validation unless the build has sanitizers.
  // `environment`: additional variables.
  ViewerProcess(const XServer& server, const std::filesystem::path& folder, const std::vector<std::string>& arguments,
                const std::vector<std::pair<std::string, std::string>>& environment = {});
  ~ViewerProcess();  // kills the process if it still runs
  ViewerProcess(const ViewerProcess&) = delete;
  ViewerProcess& operator=(const ViewerProcess&) = delete;

  XWindow& window() { return *window_; }
  void findWindowAgain();  // after the process has replaced itself and its window

  // Waits for an event after the last one that this function returned. Throws std::runtime_error after two minutes, or
  // if the process ends.
  Json waitFor(const std::function<bool(const Json&)>& matches);
  Json waitFor(const std::string& event);  // by the name
  Json waitForImage();                     // that has all samples
  // Waits until no event has arrived for half a second, so that the window shows what happened.
  void settle();

  // The rectangle of a control in the last frame: left, top, right, bottom. Waits until it exists.
  std::array<int, 4> control(const std::string& name);
  std::array<int, 4> imageArea();
  void clickControl(const std::string& name);
  bool hasControl(const std::string& name);

  struct End {
    int status = -1;     // exit status; 1000 + signal
    std::string errors;  // standard error
  };
  End finish();  // waits for the end
  bool running();

 private:
  void readEvents();
  std::string readErrors() const;

  std::string display_;
  std::filesystem::path events_, errors_;
  pid_t process_ = -1;
  int status_ = -1;
  std::unique_ptr<XWindow> window_;
  std::vector<Json> received_;
  std::size_t position_ = 0;  // of the file
  std::size_t next_ = 0;      // in received_, for waitFor()
  Json controls_;             // the last event "controls"
};

}  // namespace quintet::test
#endif

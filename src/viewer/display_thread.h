// SPDX-License-Identifier: Apache-2.0
// Makes displays in the background, so that large images and FLIP do not block the window.
#ifndef QUINTET_VIEWER_DISPLAY_THREAD_H
#define QUINTET_VIEWER_DISPLAY_THREAD_H

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "io/image.h"
#include "viewer/display.h"

namespace quintet::viewer {

// What to display. Images are not changed after they are shared.
struct DisplayRequest {
  std::shared_ptr<const io::Image> image;
  std::shared_ptr<const io::Image> reference;  // null if there is none
  DisplaySettings settings;
};

class DisplayThread {
 public:
  // `onDisplay` is called from the thread after each new display.
  explicit DisplayThread(std::function<void()> onDisplay);
  ~DisplayThread();
  DisplayThread(const DisplayThread&) = delete;
  DisplayThread& operator=(const DisplayThread&) = delete;

  // Replaces a request that was not started. Requests without an image are ignored.
  void request(DisplayRequest request);
  // The latest display; null before the first one. Stays the same object until there is a new one.
  std::shared_ptr<const Display> latest() const;
  // The error of the latest request; empty if it succeeded.
  std::string error() const;

 private:
  void run();

  const std::function<void()> onDisplay_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<DisplayRequest> next_;
  std::shared_ptr<const Display> latest_;
  std::string error_;
  bool stop_ = false;
  std::thread thread_;  // last: it uses the members above
};

}  // namespace quintet::viewer
#endif

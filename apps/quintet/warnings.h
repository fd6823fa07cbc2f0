// Warnings come from the driver's threads, too; they are kept for the report and shown when the bar is gone.
#ifndef QUINTET_APP_WARNINGS_H
#define QUINTET_APP_WARNINGS_H

#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace quintet::app {

class Warnings {
 public:
  void add(const std::string& text) {
    const std::lock_guard lock(mutex_);
    texts_.push_back(text);
  }
  // What was added since the last call.
  std::vector<std::string> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(texts_, {});
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> texts_;
};

}  // namespace quintet::app
#endif

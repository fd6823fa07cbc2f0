// SPDX-License-Identifier: Apache-2.0
// Where diagnostics go: to the application's debug messengers, to a text or SARIF file, or to standard error. Each
// diagnostic is reported once; how often it occurred is counted. Thread-safe.
#ifndef QUINTET_LAYER_MESSAGES_H
#define QUINTET_LAYER_MESSAGES_H

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

#include "base/diagnostic.h"
#include "check/modules/suppression_list.h"
#include "settings.h"

namespace quintet::layer {

// The Vulkan object to which a diagnostic belongs.
struct MessageObject {
  VkObjectType type = VK_OBJECT_TYPE_UNKNOWN;
  std::uint64_t handle = 0;
  std::string name;  // of VK_EXT_debug_utils; can be empty
};

class Messages {
 public:
  explicit Messages(const Settings& settings);
  ~Messages();    // as finish()
  void finish();  // writes the counts and the file, once
  Messages(const Messages&) = delete;

  void addMessenger(VkDebugUtilsMessengerEXT handle, const VkDebugUtilsMessengerCreateInfoEXT& info);
  void removeMessenger(VkDebugUtilsMessengerEXT handle);
  void removeMessengers();

  // `sources`: texts of the files that diagnostics name, from the modules.
  void report(const std::vector<Diagnostic>& diagnostics, const MessageObject& object,
              const std::map<std::string, std::string>& sources);

 private:
  struct Messenger {
    VkDebugUtilsMessengerEXT handle = VK_NULL_HANDLE;
    VkDebugUtilsMessengerCreateInfoEXT info{};
  };
  struct Known {
    Diagnostic diagnostic;
    std::uint64_t count = 0;
  };

  void note(const std::string& text);
  void send(const Diagnostic& d, const MessageObject& object, const std::string& text);
  void writeFile(bool complete);
  std::string textOf(const Diagnostic& d, const MessageObject& object) const;

  const std::filesystem::path output_;
  const bool sarif_;
  check::SuppressionList suppressions_;
  std::mutex mutex_;
  std::vector<Messenger> messengers_;
  std::vector<Known> known_;  // in the order of their first occurrence
  std::vector<check::SuppressedDiagnostic> suppressed_;
  std::map<std::string, std::string> sources_;
  std::string text_;  // of the file
  bool finished_ = false;
  bool fileFailed_ = false;
};

}  // namespace quintet::layer
#endif

#include "gpu/context_validation.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace quintet::gpu {

namespace {

constexpr std::size_t kKeptMessages = 256;  // a broken loop must not fill the memory

// Messages for correct use, each with the layer that gives it and the reason. Both parts must match.
struct FalseAlarm {
  std::string_view id;
  std::string_view text;
};
constexpr std::array<FalseAlarm, 0> kFalseAlarms{};

}  // namespace

bool isFalseAlarm(std::string_view messageId, std::string_view text) {
  return std::any_of(kFalseAlarms.begin(), kFalseAlarms.end(), [&](const FalseAlarm& alarm) {
    return messageId == alarm.id && text.find(alarm.text) != std::string_view::npos;
  });
}

VkDebugUtilsMessengerCreateInfoEXT ValidationSink::messengerInfo() {
  VkDebugUtilsMessengerCreateInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  info.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  info.pfnUserCallback = &ValidationSink::callback;
  info.pUserData = this;
  return info;
}

VKAPI_ATTR VkBool32 VKAPI_CALL ValidationSink::callback(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                                        VkDebugUtilsMessageTypeFlagsEXT types,
                                                        const VkDebugUtilsMessengerCallbackDataEXT* data, void* self) {
  const std::string_view id = data->pMessageIdName ? data->pMessageIdName : "";
  const std::string_view text = data->pMessage ? data->pMessage : "";
  // General messages are the loader's (a driver file that does not load): news, not our mistake.
  const bool counts = (types & VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT) != 0;
  if (!isFalseAlarm(id, text)) static_cast<ValidationSink*>(self)->receive(id, text, counts);
  return VK_FALSE;
}

void ValidationSink::receive(std::string_view id, std::string_view text, bool counts) {
  std::string line = fmt::format("{}: {}: {}", counts ? "Vulkan validation" : "Vulkan", id, text);
  std::replace(line.begin(), line.end(), '\n', ' ');
  if (counts) {
    const std::lock_guard lock(mutex_);
    ++count_;
    if (messages_.size() < kKeptMessages) messages_.push_back(line);
  }
  if (log_) log_(LogLevel::warning, line);
}

std::uint32_t ValidationSink::count() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

std::vector<std::string> ValidationSink::messages() const {
  const std::lock_guard lock(mutex_);
  return messages_;
}

}  // namespace quintet::gpu

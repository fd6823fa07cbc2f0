// SPDX-License-Identifier: Apache-2.0
#include "gpu/instance.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <fmt/format.h>

#include "gpu/error.h"

namespace quintet::gpu {
namespace {

// ---- Validation messages

constexpr std::size_t kKeptMessages = 256;  // limits the memory that repeated messages take

// A message that a layer reports for correct use. Each entry needs a comment with the layer version and the reason.
// Both strings must match.
struct FalseAlarm {
  std::string_view id;
  std::string_view text;
};
constexpr std::array<FalseAlarm, 0> kFalseAlarms{};

// ---- Loader and instance

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

[[noreturn]] void throwNoDriver(std::string_view reason) {
  throw NoDeviceError(
      fmt::format("no Vulkan driver found: {}; install mesa-vulkan-drivers (CPU) or the driver of your GPU, then check "
                  "the output of `quintet info`",
                  reason));
}

void loadLoader() {
  static std::mutex mutex;
  static bool loaded = false;
  const std::lock_guard lock(mutex);
  if (loaded) return;
  if (volkInitialize() != VK_SUCCESS) throwNoDriver("the Vulkan loader libvulkan.so.1 is missing (package libvulkan1)");
  loaded = true;
}

// The loader's functions for core Vulkan dispatch by handle, so all instances use those of the first one. Functions of
// extensions are not shared; each Instance loads its own.
void loadInstanceFunctions(VkInstance instance) {
  static std::once_flag once;
  std::call_once(once, [&] { volkLoadInstanceOnly(instance); });
}

bool hasLayer(const char* name) {
  std::uint32_t count = 0;
  check(vkEnumerateInstanceLayerProperties(&count, nullptr), "list the Vulkan layers");
  std::vector<VkLayerProperties> layers(count);
  check(vkEnumerateInstanceLayerProperties(&count, layers.data()), "list the Vulkan layers");
  layers.resize(count);
  return std::any_of(layers.begin(), layers.end(),
                     [&](const VkLayerProperties& layer) { return std::strcmp(layer.layerName, name) == 0; });
}

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
  // General messages come from the loader, for example if it cannot load a driver. They are not errors of this program.
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

Instance::Instance(ValidationSink* sink, std::span<const std::string> extensions) {
  loadLoader();
  const std::uint32_t version = volkGetInstanceVersion();
  if (version < VK_API_VERSION_1_3)
    throwNoDriver(fmt::format("the Vulkan loader has version {}.{}; 1.3 is required", VK_API_VERSION_MAJOR(version),
                              VK_API_VERSION_MINOR(version)));
  if (sink && !hasLayer(kValidationLayer))
    throw Error(fmt::format("validation requires {}, which is not installed (package vulkan-validationlayers)",
                            kValidationLayer));

  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "Quintet";
  application.pEngineName = "Quintet";
  application.apiVersion = VK_API_VERSION_1_3;

  const VkValidationFeatureEnableEXT enabled[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = enabled;
  std::vector<const char*> names;
  for (const std::string& name : extensions) names.push_back(name.c_str());
  if (sink) names.insert(names.end(), {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME});

  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pApplicationInfo = &application;
  if (sink) {
    info.pNext = &features;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &kValidationLayer;
  }
  info.enabledExtensionCount = static_cast<std::uint32_t>(names.size());
  info.ppEnabledExtensionNames = names.data();
  const VkResult result = vkCreateInstance(&info, nullptr, &handle_);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) throwNoDriver("the Vulkan loader found no working driver");
  check(result, "create the Vulkan instance");
  loadInstanceFunctions(handle_);
  if (sink) addMessenger(*sink);
}

void Instance::addMessenger(ValidationSink& sink) {
  setObjectName_ = instanceFunction<PFN_vkSetDebugUtilsObjectNameEXT>(handle_, "vkSetDebugUtilsObjectNameEXT");
  const auto create = instanceFunction<PFN_vkCreateDebugUtilsMessengerEXT>(handle_, "vkCreateDebugUtilsMessengerEXT");
  const VkDebugUtilsMessengerCreateInfoEXT info = sink.messengerInfo();
  const VkResult result = create ? create(handle_, &info, nullptr, &messenger_) : VK_ERROR_EXTENSION_NOT_PRESENT;
  if (result == VK_SUCCESS) return;
  vkDestroyInstance(handle_, nullptr);
  check(result, "register for messages of the validation layers");
}

Instance::~Instance() {
  if (messenger_)
    instanceFunction<PFN_vkDestroyDebugUtilsMessengerEXT>(handle_, "vkDestroyDebugUtilsMessengerEXT")(
        handle_, messenger_, nullptr);
  vkDestroyInstance(handle_, nullptr);
}

}  // namespace quintet::gpu

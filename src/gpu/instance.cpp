#include "gpu/instance.h"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <vector>

#include <fmt/format.h>

#include "gpu/context_validation.h"
#include "gpu/driver_environment.h"
#include "gpu/error.h"

namespace quintet::gpu {

namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

[[noreturn]] void throwNoDriver(std::string_view reason) {
  throw NoDeviceError(
      fmt::format("no Vulkan driver found: {}; install mesa-vulkan-drivers (CPU) or your GPU's driver, "
                  "then look at `quintet info`",
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

// The loader's functions for core Vulkan dispatch by handle, so those of the first instance serve
// all others. Functions of extensions do not: each Instance fetches its own.
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

template <class Function>
Function instanceFunction(VkInstance instance, const char* name) {
  return reinterpret_cast<Function>(vkGetInstanceProcAddr(instance, name));
}

}  // namespace

Instance::Instance(ValidationSink* sink) {
  prepareDriverEnvironment();
  loadLoader();
  const std::uint32_t version = volkGetInstanceVersion();
  if (version < VK_API_VERSION_1_3)
    throwNoDriver(fmt::format("the Vulkan loader is of version {}.{}, 1.3 is needed", VK_API_VERSION_MAJOR(version),
                              VK_API_VERSION_MINOR(version)));
  if (sink && !hasLayer(kValidationLayer))
    throw Error(fmt::format("validation was asked for, but {} is not installed (package vulkan-validationlayers)",
                            kValidationLayer));

  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "Quintet";
  application.pEngineName = "Quintet";
  application.apiVersion = VK_API_VERSION_1_3;

  const VkValidationFeatureEnableEXT enabled[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = enabled;
  const char* const extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};

  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pApplicationInfo = &application;
  if (sink) {
    info.pNext = &features;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &kValidationLayer;
    info.enabledExtensionCount = 2;
    info.ppEnabledExtensionNames = extensions;
  }
  const VkResult result = vkCreateInstance(&info, nullptr, &handle_);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) throwNoDriver("the Vulkan loader knows of no driver that works");
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
  check(result, "listen to the validation layers");
}

Instance::~Instance() {
  if (messenger_)
    instanceFunction<PFN_vkDestroyDebugUtilsMessengerEXT>(handle_, "vkDestroyDebugUtilsMessengerEXT")(
        handle_, messenger_, nullptr);
  vkDestroyInstance(handle_, nullptr);
}

}  // namespace quintet::gpu

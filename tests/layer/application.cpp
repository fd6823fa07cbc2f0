// SPDX-License-Identifier: Apache-2.0
#include "application.h"

#include <unistd.h>
#include <vulkan/vulkan.h>
#include <shaderc/shaderc.hpp>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <thread>

namespace quintet::test {
namespace {

constexpr std::uint32_t kRegionBytes = 1024, kHeight = 8;

std::uint32_t compileKind(const std::string& file) {
  const auto ends = [&](const char* end) { return file.ends_with(end); };
  if (ends(".rgen")) return shaderc_raygen_shader;
  if (ends(".rmiss")) return shaderc_miss_shader;
  if (ends(".rchit")) return shaderc_closesthit_shader;
  if (ends(".rahit")) return shaderc_anyhit_shader;
  if (ends(".rint")) return shaderc_intersection_shader;
  return shaderc_callable_shader;
}

std::vector<std::uint32_t> compile(const std::string& file, const std::string& text, bool debugInfo) {
  shaderc::Compiler compiler;
  shaderc::CompileOptions options;
  options.SetTargetEnvironment(shaderc_target_env_vulkan, shaderc_env_version_vulkan_1_3);
  options.SetTargetSpirv(shaderc_spirv_version_1_6);
  if (debugInfo) options.SetGenerateDebugInfo();
  if (file.ends_with(".spvasm")) {
    const auto assembled = compiler.AssembleToSpv(text, options);
    if (assembled.GetCompilationStatus() != shaderc_compilation_status_success)
      throw std::runtime_error(file + ": " + assembled.GetErrorMessage());
    std::vector<std::uint32_t> words(assembled.begin(), assembled.end());
    words.at(1) = 0x00010600u;  // the assembler ignores the version of the options
    return words;
  }
  const std::string head = "#version 460\n#extension GL_EXT_ray_tracing : require\n";
  const auto result = compiler.CompileGlslToSpv(head + text, static_cast<shaderc_shader_kind>(compileKind(file)),
                                                file.c_str(), options);
  if (result.GetCompilationStatus() != shaderc_compilation_status_success)
    throw std::runtime_error(file + ": " + result.GetErrorMessage());
  return {result.begin(), result.end()};
}

void require(VkResult result, const char* what) {
  if (result < 0) throw std::runtime_error(std::string(what) + ": " + std::to_string(result));
}

template <class Info>
Info structure(VkStructureType type, void* next = nullptr) {
  Info info{};
  info.sType = type;
  info.pNext = next;
  return info;
}

// CPU time of the calling thread.
double threadSeconds() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::uint64_t residentBytes() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

struct Memory {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkDeviceAddress address = 0;
  std::byte* mapped = nullptr;
};

VKAPI_ATTR VkBool32 VKAPI_CALL collect(VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT,
                                       const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  RunResult& run = *static_cast<RunResult*>(user);
  const std::string id = data->pMessageIdName ? data->pMessageIdName : "";
  const char* name = data->objectCount > 0 ? data->pObjects[0].pObjectName : nullptr;
  if (id.size() == 4 && id[0] == 'Q')
    run.messages.push_back({id, data->pMessage, name ? name : ""});
  else if (severity >= VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT)
    run.others.push_back(id + ": " + data->pMessage);
  return VK_FALSE;
}

class Vulkan {
 public:
  Vulkan(const Application& application, RunResult& target) : app_(application), run_(target) {}
  ~Vulkan() {
    if (device_) {
      vkDeviceWaitIdle(device_);
      if (pipeline_) vkDestroyPipeline(device_, pipeline_, nullptr);
      for (const VkPipeline library : libraries_) vkDestroyPipeline(device_, library, nullptr);
      for (const VkShaderModule module : modules_) vkDestroyShaderModule(device_, module, nullptr);
      if (bottom_) destroyStructure_(device_, bottom_, nullptr);
      if (top_) destroyStructure_(device_, top_, nullptr);
      for (const Memory& memory : memories_) {
        vkDestroyBuffer(device_, memory.buffer, nullptr);
        vkFreeMemory(device_, memory.memory, nullptr);
      }
      vkDestroyDescriptorPool(device_, descriptors_, nullptr);
      vkDestroyPipelineLayout(device_, layout_, nullptr);
      vkDestroyDescriptorSetLayout(device_, setLayout_, nullptr);
      vkDestroyCommandPool(device_, pool_, nullptr);
      vkDestroyDevice(device_, nullptr);
    }
    if (messenger_)
      function<PFN_vkDestroyDebugUtilsMessengerEXT>("vkDestroyDebugUtilsMessengerEXT")(instance_, messenger_, nullptr);
    if (instance_) vkDestroyInstance(instance_, nullptr);
  }

  void execute() {
    createInstance();
    createDevice();
    buildStructures();
    createLayout();
    createPipeline();
    if (app_.submissions == 0) return;
    createTable();
    trace();
  }

 private:
  template <class Function>
  Function function(const char* name) const {
    return reinterpret_cast<Function>(vkGetInstanceProcAddr(instance_, name));
  }
  template <class Function>
  Function deviceFunction(const char* name) const {
    return reinterpret_cast<Function>(vkGetDeviceProcAddr(device_, name));
  }

  bool usesLibrary() const { return app_.modules == Modules::library || app_.modules == Modules::flags2; }

  void createInstance() {
    VkApplicationInfo application{
        VK_STRUCTURE_TYPE_APPLICATION_INFO, nullptr, "layer test", 0, nullptr, 0, VK_API_VERSION_1_3};
    const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    std::vector<const char*> layers;
    for (const std::string& layer : app_.layers) layers.push_back(layer.c_str());
    auto info = structure<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
    info.pApplicationInfo = &application;
    info.enabledLayerCount = static_cast<std::uint32_t>(layers.size());
    info.ppEnabledLayerNames = layers.data();
    info.enabledExtensionCount = 1;
    info.ppEnabledExtensionNames = &extension;
    require(vkCreateInstance(&info, nullptr, &instance_), "vkCreateInstance");
    auto messenger =
        structure<VkDebugUtilsMessengerCreateInfoEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
    messenger.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT |
                                VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                                VK_DEBUG_UTILS_MESSAGE_SEVERITY_INFO_BIT_EXT;
    messenger.messageType =
        VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT;
    messenger.pfnUserCallback = collect;
    messenger.pUserData = &run_;
    require(function<PFN_vkCreateDebugUtilsMessengerEXT>("vkCreateDebugUtilsMessengerEXT")(instance_, &messenger,
                                                                                           nullptr, &messenger_),
            "vkCreateDebugUtilsMessengerEXT");
  }

  void createDevice() {
    std::uint32_t count = 1;
    require(vkEnumeratePhysicalDevices(instance_, &count, &physical_), "vkEnumeratePhysicalDevices");
    rays_.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_PROPERTIES_KHR;
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &rays_, {}};
    vkGetPhysicalDeviceProperties2(physical_, &properties);
    auto rays = structure<VkPhysicalDeviceRayTracingPipelineFeaturesKHR>(
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR);
    rays.rayTracingPipeline = VK_TRUE;
    rays.rayTracingPipelineTraceRaysIndirect = app_.trace != Trace::direct;
    auto maintenance = structure<VkPhysicalDeviceRayTracingMaintenance1FeaturesKHR>(
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_MAINTENANCE_1_FEATURES_KHR);
    maintenance.rayTracingMaintenance1 = maintenance.rayTracingPipelineTraceRaysIndirect2 = VK_TRUE;
    if (app_.trace == Trace::indirect2) rays.pNext = &maintenance;
    auto structures = structure<VkPhysicalDeviceAccelerationStructureFeaturesKHR>(
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR, &rays);
    structures.accelerationStructure = VK_TRUE;
    auto features =
        structure<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, &structures);
    features.bufferDeviceAddress = VK_TRUE;
    features.scalarBlockLayout = VK_TRUE;
    features.runtimeDescriptorArray = features.shaderStorageBufferArrayNonUniformIndexing = VK_TRUE;
    features.descriptorBindingVariableDescriptorCount = VK_TRUE;
    auto newer =
        structure<VkPhysicalDeviceVulkan13Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES, &features);
    newer.maintenance4 = VK_TRUE;
    const float priority = 1.0f;
    VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, nullptr, 0, 0, 1, &priority};
    std::vector<const char*> extensions{
        VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
        VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME, VK_KHR_PIPELINE_LIBRARY_EXTENSION_NAME};
    if (app_.trace == Trace::indirect2) extensions.push_back(VK_KHR_RAY_TRACING_MAINTENANCE_1_EXTENSION_NAME);
    auto info = structure<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &newer);
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    require(vkCreateDevice(physical_, &info, nullptr, &device_), "vkCreateDevice");
    vkGetDeviceQueue(device_, 0, 0, &queue_);
    destroyStructure_ = deviceFunction<PFN_vkDestroyAccelerationStructureKHR>("vkDestroyAccelerationStructureKHR");
    auto pool = structure<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
    require(vkCreateCommandPool(device_, &pool, nullptr, &pool_), "vkCreateCommandPool");
  }

  Memory allocate(VkDeviceSize bytes, VkBufferUsageFlags usage) {
    Memory result;
    auto info = structure<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
    info.size = bytes;
    info.usage = usage | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
    require(vkCreateBuffer(device_, &info, nullptr, &result.buffer), "vkCreateBuffer");
    VkMemoryRequirements needs{};
    vkGetBufferMemoryRequirements(device_, result.buffer, &needs);
    VkPhysicalDeviceMemoryProperties types{};
    vkGetPhysicalDeviceMemoryProperties(physical_, &types);
    std::uint32_t type = 0;
    constexpr VkMemoryPropertyFlags kHost = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    while (type < types.memoryTypeCount &&
           ((needs.memoryTypeBits >> type & 1u) == 0 || (types.memoryTypes[type].propertyFlags & kHost) != kHost))
      ++type;
    VkMemoryAllocateFlagsInfo flags{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO, nullptr,
                                    VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT, 0};
    VkMemoryAllocateInfo allocation{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, &flags, needs.size, type};
    require(vkAllocateMemory(device_, &allocation, nullptr, &result.memory), "vkAllocateMemory");
    require(vkBindBufferMemory(device_, result.buffer, result.memory, 0), "vkBindBufferMemory");
    void* mapped = nullptr;
    require(vkMapMemory(device_, result.memory, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
    std::memset(mapped, 0, static_cast<std::size_t>(bytes));
    result.mapped = static_cast<std::byte*>(mapped);
    VkBufferDeviceAddressInfo address{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, nullptr, result.buffer};
    result.address = vkGetBufferDeviceAddress(device_, &address);
    memories_.push_back(result);
    return result;
  }

  void submit(const std::function<void(VkCommandBuffer)>& record) {
    const double cpu = threadSeconds();
    VkCommandBufferAllocateInfo allocation{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, pool_,
                                           VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
    VkCommandBuffer commands = VK_NULL_HANDLE;
    require(vkAllocateCommandBuffers(device_, &allocation, &commands), "vkAllocateCommandBuffers");
    auto begin = structure<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    require(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
    record(commands);
    require(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
    auto info = structure<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
    info.commandBufferCount = 1;
    info.pCommandBuffers = &commands;
    require(vkQueueSubmit(queue_, 1, &info, VK_NULL_HANDLE), "vkQueueSubmit");
    submitCpuSeconds_ += threadSeconds() - cpu;
    require(vkQueueWaitIdle(queue_), "vkQueueWaitIdle");
    vkFreeCommandBuffers(device_, pool_, 1, &commands);
  }

  VkAccelerationStructureKHR build(VkAccelerationStructureTypeKHR type,
                                   const VkAccelerationStructureGeometryKHR& geometry) {
    auto info = structure<VkAccelerationStructureBuildGeometryInfoKHR>(
        VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR);
    info.type = type;
    info.geometryCount = 1;
    info.pGeometries = &geometry;
    const std::uint32_t count = 1;
    auto sizes = structure<VkAccelerationStructureBuildSizesInfoKHR>(
        VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR);
    deviceFunction<PFN_vkGetAccelerationStructureBuildSizesKHR>("vkGetAccelerationStructureBuildSizesKHR")(
        device_, VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info, &count, &sizes);
    const Memory memory =
        allocate(sizes.accelerationStructureSize, VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR);
    const Memory scratch = allocate(sizes.buildScratchSize + 256, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    auto create =
        structure<VkAccelerationStructureCreateInfoKHR>(VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR);
    create.buffer = memory.buffer;
    create.size = sizes.accelerationStructureSize;
    create.type = type;
    VkAccelerationStructureKHR structure = VK_NULL_HANDLE;
    require(deviceFunction<PFN_vkCreateAccelerationStructureKHR>("vkCreateAccelerationStructureKHR")(
                device_, &create, nullptr, &structure),
            "vkCreateAccelerationStructureKHR");
    info.dstAccelerationStructure = structure;
    info.scratchData.deviceAddress = (scratch.address + 255) / 256 * 256;
    const VkAccelerationStructureBuildRangeInfoKHR range{1, 0, 0, 0};
    const VkAccelerationStructureBuildRangeInfoKHR* ranges = &range;
    if (app_.hostBuilds) {
      require(deviceFunction<PFN_vkBuildAccelerationStructuresKHR>("vkBuildAccelerationStructuresKHR")(
                  device_, VK_NULL_HANDLE, 1, &info, &ranges),
              "vkBuildAccelerationStructuresKHR");
      return structure;
    }
    submit([&](VkCommandBuffer commands) {
      deviceFunction<PFN_vkCmdBuildAccelerationStructuresKHR>("vkCmdBuildAccelerationStructuresKHR")(commands, 1, &info,
                                                                                                     &ranges);
    });
    return structure;
  }

  void buildStructures() {
    constexpr VkBufferUsageFlags kInput = VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR;
    const Memory data = allocate(256, kInput);
    auto geometry =
        structure<VkAccelerationStructureGeometryKHR>(VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR);
    if (app_.boxes) {
      const float box[6] = {-1, -1, 4, 1, 1, 6};
      std::memcpy(data.mapped, box, sizeof box);
      geometry.geometryType = VK_GEOMETRY_TYPE_AABBS_KHR;
      geometry.geometry.aabbs = {
          VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_AABBS_DATA_KHR, nullptr, {data.address}, 24};
    } else {
      const float vertices[9] = {-9, -9, 5, 9, -9, 5, 0, 9, 5};
      std::memcpy(data.mapped, vertices, sizeof vertices);
      geometry.geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR;
      auto triangles = structure<VkAccelerationStructureGeometryTrianglesDataKHR>(
          VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR);
      triangles.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
      triangles.vertexData.deviceAddress = data.address;
      triangles.vertexStride = 12;
      triangles.maxVertex = 2;
      triangles.indexType = VK_INDEX_TYPE_NONE_KHR;
      geometry.geometry.triangles = triangles;
    }
    if (app_.opaque) geometry.flags = VK_GEOMETRY_OPAQUE_BIT_KHR;
    bottom_ = build(VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, geometry);
    VkAccelerationStructureDeviceAddressInfoKHR address{
        VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR, nullptr, bottom_};
    VkAccelerationStructureInstanceKHR instance{};
    instance.transform = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    instance.mask = 0xFF;
    instance.instanceShaderBindingTableRecordOffset = app_.recordOffset & 0xFFFFFFu;
    instance.instanceCustomIndex = app_.customIndex & 0xFFFFFFu;
    instance.accelerationStructureReference = deviceFunction<PFN_vkGetAccelerationStructureDeviceAddressKHR>(
        "vkGetAccelerationStructureDeviceAddressKHR")(device_, &address);
    if (app_.hostBuilds) instance.accelerationStructureReference = reinterpret_cast<std::uint64_t>(bottom_);
    const Memory instances = allocate(sizeof instance, kInput);
    std::memcpy(instances.mapped, &instance, sizeof instance);
    auto top = structure<VkAccelerationStructureGeometryKHR>(VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR);
    top.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
    top.geometry.instances = {
        VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR, nullptr, VK_FALSE, {instances.address}};
    if (app_.hostBuilds) top.geometry.instances.data.hostAddress = instances.mapped;
    top_ = build(VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, top);
  }

  void createLayout() {
    constexpr VkShaderStageFlags kAll = VK_SHADER_STAGE_ALL;
    const VkDescriptorSetLayoutBinding bindings[] = {
        {0, VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, 1, kAll, nullptr},
        {1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, kAll, nullptr},
        {2, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, app_.buffers, kAll, nullptr}};
    const std::uint32_t count = app_.buffers > 0 ? 3 : 2;
    const VkDescriptorBindingFlags flags[] = {0, 0, VK_DESCRIPTOR_BINDING_VARIABLE_DESCRIPTOR_COUNT_BIT};
    const VkDescriptorSetLayoutBindingFlagsCreateInfo flagsInfo{
        VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_BINDING_FLAGS_CREATE_INFO, nullptr, count, flags};
    VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                        app_.setBuffers ? &flagsInfo : nullptr, 0, count, bindings};
    require(vkCreateDescriptorSetLayout(device_, &set, nullptr, &setLayout_), "vkCreateDescriptorSetLayout");
    VkPipelineLayoutCreateInfo layout{
        VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO, nullptr, 0, 1, &setLayout_, 0, nullptr};
    require(vkCreatePipelineLayout(device_, &layout, nullptr, &layout_), "vkCreatePipelineLayout");
    const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, 1},
                                          {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1 + app_.buffers}};
    VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, nullptr, 0, 1, 2, sizes};
    require(vkCreateDescriptorPool(device_, &pool, nullptr, &descriptors_), "vkCreateDescriptorPool");
    const std::uint32_t setBuffers = app_.setBuffers.value_or(app_.buffers);
    const VkDescriptorSetVariableDescriptorCountAllocateInfo variable{
        VK_STRUCTURE_TYPE_DESCRIPTOR_SET_VARIABLE_DESCRIPTOR_COUNT_ALLOCATE_INFO, nullptr, 1, &setBuffers};
    VkDescriptorSetAllocateInfo allocation{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                           app_.setBuffers ? &variable : nullptr, descriptors_, 1, &setLayout_};
    require(vkAllocateDescriptorSets(device_, &allocation, &set_), "vkAllocateDescriptorSets");
    result_ = allocate(kHeight * 64 * sizeof(float), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    VkWriteDescriptorSetAccelerationStructureKHR structure{
        VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR, nullptr, 1, &top_};
    const VkDescriptorBufferInfo buffer{result_.buffer, 0, VK_WHOLE_SIZE};
    VkWriteDescriptorSet writes[2]{};
    for (std::uint32_t i = 0; i < 2; ++i) {
      writes[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
      writes[i].dstSet = set_;
      writes[i].dstBinding = i;
      writes[i].descriptorCount = 1;
      writes[i].descriptorType = bindings[i].descriptorType;
    }
    writes[0].pNext = &structure;
    writes[1].pBufferInfo = &buffer;
    vkUpdateDescriptorSets(device_, 2, writes, 0, nullptr);
    const std::vector<VkDescriptorBufferInfo> all(setBuffers, buffer);
    VkWriteDescriptorSet array = writes[1];
    array.dstBinding = 2;
    array.descriptorCount = setBuffers;
    array.pBufferInfo = all.data();
    if (setBuffers > 0) vkUpdateDescriptorSets(device_, 1, &array, 0, nullptr);
  }

  // The stages and groups of a pipeline or a library, with the memory that their create infos need.
  struct Parts {
    std::vector<VkPipelineShaderStageCreateInfo> stages;
    std::vector<VkRayTracingShaderGroupCreateInfoKHR> groups;
  };

  std::uint32_t addStage(Parts& parts, const std::string& file) {
    if (file.empty()) return VK_SHADER_UNUSED_KHR;
    words_.push_back(compile(file, app_.shaders.at(file), app_.debugInfo));
    auto stage = structure<VkPipelineShaderStageCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO);
    const std::string name = file.substr(0, file.find(".spvasm"));
    switch (compileKind(name)) {
      case shaderc_raygen_shader: stage.stage = VK_SHADER_STAGE_RAYGEN_BIT_KHR; break;
      case shaderc_miss_shader: stage.stage = VK_SHADER_STAGE_MISS_BIT_KHR; break;
      case shaderc_closesthit_shader: stage.stage = VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR; break;
      case shaderc_anyhit_shader: stage.stage = VK_SHADER_STAGE_ANY_HIT_BIT_KHR; break;
      case shaderc_intersection_shader: stage.stage = VK_SHADER_STAGE_INTERSECTION_BIT_KHR; break;
      default: stage.stage = VK_SHADER_STAGE_CALLABLE_BIT_KHR;
    }
    stage.pName = "main";
    moduleInfos_.push_back(
        {VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, nullptr, 0, words_.back().size() * 4, words_.back().data()});
    if (app_.modules == Modules::inlined) {
      stage.pNext = &moduleInfos_.back();
    } else if (app_.modules == Modules::identifiers) {
      VkShaderModule module = VK_NULL_HANDLE;
      require(vkCreateShaderModule(device_, &moduleInfos_.back(), nullptr, &module), "vkCreateShaderModule");
      modules_.push_back(module);
      VkShaderModuleIdentifierEXT& identifier = identifiers_.emplace_back(
          structure<VkShaderModuleIdentifierEXT>(VK_STRUCTURE_TYPE_SHADER_MODULE_IDENTIFIER_EXT));
      deviceFunction<PFN_vkGetShaderModuleIdentifierEXT>("vkGetShaderModuleIdentifierEXT")(device_, module,
                                                                                           &identifier);
      identifierInfos_.push_back({VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_MODULE_IDENTIFIER_CREATE_INFO_EXT, nullptr,
                                  identifier.identifierSize, identifier.identifier});
      stage.pNext = &identifierInfos_.back();
    } else {
      require(vkCreateShaderModule(device_, &moduleInfos_.back(), nullptr, &stage.module), "vkCreateShaderModule");
      modules_.push_back(stage.module);
    }
    if (stage.stage == VK_SHADER_STAGE_RAYGEN_BIT_KHR && !app_.constants.empty()) {
      for (const auto& [id, value] : app_.constants) {
        entries_.push_back({id, static_cast<std::uint32_t>(values_.size() * 4), 4});
        values_.push_back(value);
      }
      specialization_ = {static_cast<std::uint32_t>(entries_.size()), entries_.data(), values_.size() * 4,
                         values_.data()};
      stage.pSpecializationInfo = &specialization_;
    }
    parts.stages.push_back(stage);
    return static_cast<std::uint32_t>(parts.stages.size() - 1);
  }

  void addGeneral(Parts& parts, const std::string& file) {
    auto group =
        structure<VkRayTracingShaderGroupCreateInfoKHR>(VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR);
    group.type = VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR;
    group.generalShader = addStage(parts, file);
    group.closestHitShader = group.anyHitShader = group.intersectionShader = VK_SHADER_UNUSED_KHR;
    parts.groups.push_back(group);
  }

  // Adds a stage with the module of an earlier one.
  static std::uint32_t repeatStage(Parts& parts, std::uint32_t stage) {
    if (stage == VK_SHADER_UNUSED_KHR) return stage;
    const VkPipelineShaderStageCreateInfo repeated = parts.stages[stage];
    parts.stages.push_back(repeated);
    return static_cast<std::uint32_t>(parts.stages.size() - 1);
  }

  void addHit(Parts& parts, const Application::HitGroup& hit) {
    auto group =
        structure<VkRayTracingShaderGroupCreateInfoKHR>(VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR);
    group.type = hit.intersection.empty() ? VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR
                                          : VK_RAY_TRACING_SHADER_GROUP_TYPE_PROCEDURAL_HIT_GROUP_KHR;
    group.generalShader = VK_SHADER_UNUSED_KHR;
    group.closestHitShader = addStage(parts, hit.closestHit);
    group.anyHitShader = addStage(parts, hit.anyHit);
    group.intersectionShader = addStage(parts, hit.intersection);
    parts.groups.push_back(group);
    for (std::uint32_t i = 1; i < app_.hitCopies; ++i) {
      for (std::uint32_t* stage : {&group.closestHitShader, &group.anyHitShader, &group.intersectionShader})
        *stage = repeatStage(parts, *stage);
      parts.groups.push_back(group);
    }
  }

  VkPipeline create(const Parts& parts, VkPipelineCreateFlags flags, const VkPipelineLibraryCreateInfoKHR* libraries,
                    bool deferred) {
    auto limits = structure<VkRayTracingPipelineInterfaceCreateInfoKHR>(
        VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_INTERFACE_CREATE_INFO_KHR);
    limits.maxPipelineRayPayloadSize = 64;
    limits.maxPipelineRayHitAttributeSize = 32;
    const VkDynamicState dynamic = VK_DYNAMIC_STATE_RAY_TRACING_PIPELINE_STACK_SIZE_KHR;
    const VkPipelineDynamicStateCreateInfo states{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO, nullptr, 0, 1,
                                                  &dynamic};
    auto info = structure<VkRayTracingPipelineCreateInfoKHR>(VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_CREATE_INFO_KHR);
    info.flags = flags;
    if (app_.modules == Modules::identifiers) info.flags |= VK_PIPELINE_CREATE_FAIL_ON_PIPELINE_COMPILE_REQUIRED_BIT;
    struct {
      VkStructureType type;
      const void* next;
      std::uint64_t flags;
    } flags2{static_cast<VkStructureType>(1000470005), nullptr, flags};
    if (app_.modules == Modules::flags2) info.pNext = &flags2, info.flags = 0;
    info.stageCount = static_cast<std::uint32_t>(parts.stages.size());
    info.pStages = parts.stages.data();
    info.groupCount = static_cast<std::uint32_t>(parts.groups.size());
    info.pGroups = parts.groups.data();
    info.maxPipelineRayRecursionDepth = app_.depth;
    info.pLibraryInfo = libraries;
    if (usesLibrary()) info.pLibraryInterface = &limits;
    if (app_.stack) info.pDynamicState = &states;
    info.layout = layout_;
    VkPipeline pipeline = VK_NULL_HANDLE;
    VkDeferredOperationKHR operation = VK_NULL_HANDLE;
    if (deferred)
      require(deviceFunction<PFN_vkCreateDeferredOperationKHR>("vkCreateDeferredOperationKHR")(device_, nullptr,
                                                                                               &operation),
              "vkCreateDeferredOperationKHR");
    const VkResult result = deviceFunction<PFN_vkCreateRayTracingPipelinesKHR>("vkCreateRayTracingPipelinesKHR")(
        device_, operation, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline);
    require(result, "vkCreateRayTracingPipelinesKHR");
    if (deferred) {
      if (result == VK_OPERATION_DEFERRED_KHR)
        while (deviceFunction<PFN_vkDeferredOperationJoinKHR>("vkDeferredOperationJoinKHR")(device_, operation) ==
               VK_THREAD_IDLE_KHR) {
        }
      deviceFunction<PFN_vkDestroyDeferredOperationKHR>("vkDestroyDeferredOperationKHR")(device_, operation, nullptr);
    }
    return pipeline;
  }

  // The hit groups of Application::hitVariants.
  void addVariants(Parts& parts) {
    std::vector<std::vector<std::uint32_t>> texts;
    for (std::uint32_t k = 0; k < std::min(app_.hitVariants, Application::kVariantTexts); ++k) {
      const std::string file = "v" + std::to_string(k) + ".rchit";
      texts.push_back(compile(file, app_.shaders.at(file), app_.debugInfo));
    }
    for (std::uint32_t i = 0; i < app_.hitVariants; ++i) {
      words_.push_back(texts[i % texts.size()]);
      std::ranges::replace(words_.back(), Application::kVariantMark, i);
      const VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, nullptr, 0,
                                          words_.back().size() * 4, words_.back().data()};
      auto stage = structure<VkPipelineShaderStageCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO);
      stage.stage = VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR;
      stage.pName = "main";
      require(vkCreateShaderModule(device_, &info, nullptr, &stage.module), "vkCreateShaderModule");
      modules_.push_back(stage.module);
      auto group =
          structure<VkRayTracingShaderGroupCreateInfoKHR>(VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR);
      group.type = VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR;
      group.generalShader = group.anyHitShader = group.intersectionShader = VK_SHADER_UNUSED_KHR;
      group.closestHitShader = static_cast<std::uint32_t>(parts.stages.size());
      parts.stages.push_back(stage);
      parts.groups.push_back(group);
    }
  }

  void createPipeline() {
    const bool library = usesLibrary();
    words_.reserve(64 + app_.hitVariants);
    moduleInfos_.reserve(64), identifiers_.reserve(64), identifierInfos_.reserve(64);
    Parts own, hits;
    addGeneral(own, "a.rgen");
    for (const std::string& miss : app_.misses) addGeneral(own, miss);
    for (const std::string& callable : app_.callables) addGeneral(own, callable);
    for (const Application::HitGroup& hit : app_.hitGroups) addHit(library ? hits : own, hit);
    for (const std::string& generation : app_.otherGenerations) addGeneral(own, generation);
    addVariants(own);
    groupCount_ = static_cast<std::uint32_t>(own.groups.size() + hits.groups.size());
    auto info = structure<VkPipelineLibraryCreateInfoKHR>(VK_STRUCTURE_TYPE_PIPELINE_LIBRARY_CREATE_INFO_KHR);
    if (library) {
      libraries_.push_back(create(hits, VK_PIPELINE_CREATE_LIBRARY_BIT_KHR, nullptr, false));
      info.libraryCount = 1;
      info.pLibraries = libraries_.data();
    }
    std::vector<std::thread> others;
    for (std::uint32_t i = 1; i < app_.pipelines; ++i)
      others.emplace_back([&] {
        const VkPipeline other = create(own, 0, library ? &info : nullptr, app_.modules == Modules::deferred);
        vkDestroyPipeline(device_, other, nullptr);
      });
    const double cpu = threadSeconds();
    const auto start = std::chrono::steady_clock::now();
    pipeline_ = create(own, 0, library ? &info : nullptr, app_.modules == Modules::deferred);
    run_.creationSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    run_.creationCpuSeconds = threadSeconds() - cpu;
    run_.residentBytes = residentBytes();
    for (std::thread& other : others) other.join();
    if (app_.exit != Exit::no) std::exit(0);
    VkDebugUtilsObjectNameInfoEXT name{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT, nullptr,
                                       VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(pipeline_), "main"};
    deviceFunction<PFN_vkSetDebugUtilsObjectNameEXT>("vkSetDebugUtilsObjectNameEXT")(device_, &name);
  }

  void createTable() {
    const std::uint32_t bytes = rays_.shaderGroupHandleSize;
    std::vector<std::byte> handles(std::size_t{bytes} * groupCount_);
    require(deviceFunction<PFN_vkGetRayTracingShaderGroupHandlesKHR>("vkGetRayTracingShaderGroupHandlesKHR")(
                device_, pipeline_, 0, groupCount_, handles.size(), handles.data()),
            "vkGetRayTracingShaderGroupHandlesKHR");
    const auto misses = static_cast<std::uint32_t>(app_.misses.size());
    const auto callables = static_cast<std::uint32_t>(app_.callables.size());
    const auto range = [](std::uint32_t first, std::size_t count) {
      std::vector<std::uint32_t> result;
      for (std::uint32_t i = 0; i < count; ++i) result.push_back(first + i);
      return result;
    };
    const std::vector<std::vector<std::uint32_t>> records{
        {0},
        app_.missRecords.empty() ? range(1, misses) : app_.missRecords,
        app_.hitRecords.empty() ? range(1 + misses + callables, app_.hitGroups.size()) : app_.hitRecords,
        range(1 + misses, callables)};
    std::vector<std::byte> table(4 * kRegionBytes);
    std::vector<Application::Region> regions(4);
    for (std::size_t r = 0; r < 4; ++r) {
      regions[r] = {r * kRegionBytes, app_.recordBytes, app_.recordBytes * records[r].size()};
      for (std::size_t i = 0; i < records[r].size(); ++i)
        std::memcpy(table.data() + regions[r].offset + i * app_.recordBytes,
                    handles.data() + std::size_t{bytes} * records[r][i], bytes);
    }
    if (app_.editTable) app_.editTable(table, regions);
    const Memory memory = allocate(table.size() + 256, VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR);
    const VkDeviceAddress base = (memory.address + 255) / 256 * 256;
    std::memcpy(memory.mapped + (base - memory.address), table.data(), table.size());
    for (std::size_t r = 0; r < 4; ++r)
      regions_[r] = {regions[r].size > 0 ? base + regions[r].offset : 0, regions[r].size > 0 ? regions[r].stride : 0,
                     regions[r].size};
    traceRays_ = deviceFunction<PFN_vkCmdTraceRaysKHR>("vkCmdTraceRaysKHR");
    if (app_.trace == Trace::direct) return;
    arguments_ = allocate(sizeof(VkTraceRaysIndirectCommand2KHR), VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT);
    const auto [generation, miss, hit, callable] = regions_;
    const VkTraceRaysIndirectCommand2KHR command{generation.deviceAddress,
                                                 generation.size,
                                                 miss.deviceAddress,
                                                 miss.size,
                                                 miss.stride,
                                                 hit.deviceAddress,
                                                 hit.size,
                                                 hit.stride,
                                                 callable.deviceAddress,
                                                 callable.size,
                                                 callable.stride,
                                                 app_.width,
                                                 kHeight,
                                                 1};
    std::memcpy(arguments_.mapped, &command, sizeof command);
  }

  void trace() {
    auto start = std::chrono::steady_clock::now();
    submit([&](VkCommandBuffer commands) { recordTrace(commands); });
    run_.firstSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    submitCpuSeconds_ = 0;
    start = std::chrono::steady_clock::now();
    for (std::uint32_t i = 1; i < app_.submissions; ++i)
      submit([&](VkCommandBuffer commands) { recordTrace(commands); });
    run_.traceSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    run_.recordCpuSeconds = submitCpuSeconds_;
    run_.pixels.resize(std::size_t{kHeight} * app_.width);
    std::memcpy(run_.pixels.data(), result_.mapped, run_.pixels.size() * sizeof(float));
  }

  void recordTrace(VkCommandBuffer commands) const {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, pipeline_);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, layout_, 0, 1, &set_, 0, nullptr);
    if (app_.stack)
      deviceFunction<PFN_vkCmdSetRayTracingPipelineStackSizeKHR>("vkCmdSetRayTracingPipelineStackSizeKHR")(commands,
                                                                                                           *app_.stack);
    switch (app_.trace) {
      case Trace::direct:
        traceRays_(commands, &regions_[0], &regions_[1], &regions_[2], &regions_[3], app_.width, kHeight, 1);
        return;
      case Trace::indirect:
        deviceFunction<PFN_vkCmdTraceRaysIndirectKHR>("vkCmdTraceRaysIndirectKHR")(
            commands, &regions_[0], &regions_[1], &regions_[2], &regions_[3],
            arguments_.address + offsetof(VkTraceRaysIndirectCommand2KHR, width));
        return;
      case Trace::indirect2:
        deviceFunction<PFN_vkCmdTraceRaysIndirect2KHR>("vkCmdTraceRaysIndirect2KHR")(commands, arguments_.address);
    }
  }

  const Application& app_;
  RunResult& run_;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkPhysicalDeviceRayTracingPipelinePropertiesKHR rays_{};
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  PFN_vkDestroyAccelerationStructureKHR destroyStructure_ = nullptr;
  std::vector<Memory> memories_;
  VkAccelerationStructureKHR bottom_ = VK_NULL_HANDLE, top_ = VK_NULL_HANDLE;
  VkDescriptorSetLayout setLayout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkDescriptorPool descriptors_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  Memory result_;
  std::vector<std::vector<std::uint32_t>> words_;
  std::vector<VkShaderModuleCreateInfo> moduleInfos_;
  std::vector<VkShaderModuleIdentifierEXT> identifiers_;
  std::vector<VkPipelineShaderStageModuleIdentifierCreateInfoEXT> identifierInfos_;
  std::vector<VkSpecializationMapEntry> entries_;
  std::vector<std::uint32_t> values_;
  VkSpecializationInfo specialization_{};
  std::vector<VkShaderModule> modules_;
  std::vector<VkPipeline> libraries_;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
  std::uint32_t groupCount_ = 0;
  VkStridedDeviceAddressRegionKHR regions_[4]{};
  PFN_vkCmdTraceRaysKHR traceRays_ = nullptr;
  Memory arguments_;  // of an indirect trace
  double submitCpuSeconds_ = 0;
};

}  // namespace

Application correctApplication() {
  Application app;
  app.shaders["a.rgen"] = R"(layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(set = 0, binding = 1, std430) buffer Result { float at[]; } result;
struct Payload { vec3 color; float t; };
layout(location = 0) rayPayloadEXT Payload payload;
void main() {
  vec2 p = (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 0.5;
  vec3 origin = vec3(p, 0.0), direction = vec3(0, 0, 1);
  traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFF, 0, 1, 0, origin, 0.001, direction, 100.0, 0);
  result.at[gl_LaunchIDEXT.y * gl_LaunchSizeEXT.x + gl_LaunchIDEXT.x] = payload.color.x + payload.t;
}
)";
  app.shaders["a.rmiss"] = R"(struct Payload { vec3 color; float t; };
layout(location = 0) rayPayloadInEXT Payload payload;
void main() { payload = Payload(vec3(0.5), -1.0); }
)";
  app.shaders["a.rchit"] = R"(struct Payload { vec3 color; float t; };
layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 weights;
void main() { payload = Payload(vec3(weights, 0.25), gl_HitTEXT); }
)";
  return app;
}

namespace {

// Older than the objects of the layer, so destroyed after them.
std::unique_ptr<Vulkan> destroyedLate;

}  // namespace

RunResult runApplication(const Application& application) {
  RunResult result;
  try {
    if (application.exit == Exit::destroysLate) {
      destroyedLate = std::make_unique<Vulkan>(application, result);
      destroyedLate->execute();
    }
    if (application.exit == Exit::withoutDestroying) (new Vulkan(application, result))->execute();
    Vulkan vulkan(application, result);
    vulkan.execute();
  } catch (const std::exception& error) {
    result.error = error.what();
  }
  return result;
}

}  // namespace quintet::test

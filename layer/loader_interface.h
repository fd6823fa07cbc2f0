// SPDX-License-Identifier: Apache-2.0
// The interface between the Vulkan loader and a layer, also for the layers of tests. Its specification is in the documentation
// of the loader, LoaderLayerInterface.md.
#ifndef QUINTET_LAYER_LOADER_INTERFACE_H
#define QUINTET_LAYER_LOADER_INTERFACE_H

#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

namespace quintet::layer {

// The entry of the loader's chain that names the next layer; null if there is none.
template <class Info>
Info* chainEntry(const void* chain, VkStructureType type) {
  for (auto* entry = static_cast<const VkBaseInStructure*>(chain); entry; entry = entry->pNext) {
    auto* info = reinterpret_cast<Info*>(const_cast<VkBaseInStructure*>(entry));
    if (entry->sType == type && info->function == VK_LAYER_LINK_INFO) return info;
  }
  return nullptr;
}

template <class Function>
PFN_vkVoidFunction asVoid(Function* function) {
  return reinterpret_cast<PFN_vkVoidFunction>(function);
}

// vkNegotiateLoaderLayerInterfaceVersion of a layer with these functions.
inline VkResult negotiate(VkNegotiateLayerInterface& negotiation, PFN_vkGetInstanceProcAddr getInstanceProcAddr,
                          PFN_vkGetDeviceProcAddr getDeviceProcAddr) {
  if (negotiation.loaderLayerInterfaceVersion < 2) return VK_ERROR_INITIALIZATION_FAILED;
  negotiation.loaderLayerInterfaceVersion = 2;
  negotiation.pfnGetInstanceProcAddr = getInstanceProcAddr;
  negotiation.pfnGetDeviceProcAddr = getDeviceProcAddr;
  negotiation.pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}

}  // namespace quintet::layer
#endif

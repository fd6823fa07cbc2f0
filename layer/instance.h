// SPDX-License-Identifier: Apache-2.0
// A Vulkan instance with this layer: settings, messages, and the thread that links pipelines.
#ifndef QUINTET_LAYER_INSTANCE_H
#define QUINTET_LAYER_INSTANCE_H

#include "dispatch.h"
#include "link_worker.h"
#include "messages.h"
#include "settings.h"

namespace quintet::layer {

struct Instance {
  Instance(VkInstance instance, PFN_vkGetInstanceProcAddr nextLayer)
      : handle(instance), next(nextLayer), settings(readSettings()), messages(settings) {
#define QUINTET_LOAD(name) table.name = reinterpret_cast<PFN_vk##name>(next(handle, "vk" #name));
    QUINTET_INSTANCE_FUNCTIONS(QUINTET_LOAD)
#undef QUINTET_LOAD
  }

  VkInstance handle = VK_NULL_HANDLE;
  PFN_vkGetInstanceProcAddr next = nullptr;
  InstanceTable table;
  const Settings settings;
  Messages messages;
  LinkWorker worker;  // its tasks use the members above
};

}  // namespace quintet::layer
#endif

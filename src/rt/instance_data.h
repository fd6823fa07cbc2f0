// Host side of a TLAS build.
#ifndef QUINTET_RT_INSTANCE_DATA_H
#define QUINTET_RT_INSTANCE_DATA_H

#include "rt/tlas.h"

namespace quintet::rt {

// Why the instance is left out of the build: its transform is not finite or not invertible, or its
// BLAS is empty.
bool isActive(const InstanceInput& instance);

// Throws UsageError if a field does not fit the bits that Vulkan has for it.
VkAccelerationStructureInstanceKHR packInstance(const InstanceInput& instance);

// spatial: the active instances in spatial order; given: the active ones as they come; numbered: all, each at its
// place (so that gl_InstanceID is its index), the inactive ones with mask 0.
enum class InstanceOrder { spatial, given, numbered };
std::vector<VkAccelerationStructureInstanceKHR> packInstances(std::span<const InstanceInput> instances,
                                                              InstanceOrder order);

}  // namespace quintet::rt
#endif

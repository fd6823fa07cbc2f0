// SPDX-License-Identifier: Apache-2.0
// Implementation of volk.
#define VOLK_IMPLEMENTATION
#include <volk.h>

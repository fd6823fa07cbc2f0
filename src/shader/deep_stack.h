// SPDX-License-Identifier: Apache-2.0
// Threads for glslang and spirv-opt, which recurse as deep as the expressions of the source.
#ifndef QUINTET_SHADER_DEEP_STACK_H
#define QUINTET_SHADER_DEEP_STACK_H

#include <cstddef>
#include <functional>

namespace quintet::shader {

// Returns a stack size that is sufficient for any source of that size: one nesting level of an expression takes at
// least 2 characters ("+a") and about 2 KiB of stack. Untouched pages cost no memory.
std::size_t stackBytesFor(std::size_t textBytes);

// Calls `body` on a thread with a stack of `bytes`, or the largest that the system grants, and waits. `body` must not
// throw.
void runOnDeepStack(std::size_t bytes, const std::function<void()>& body);

}  // namespace quintet::shader
#endif

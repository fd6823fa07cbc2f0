// SPDX-License-Identifier: Apache-2.0
// Data-parallel loops on the cores of the host.
#ifndef QUINTET_BASE_PARALLEL_H
#define QUINTET_BASE_PARALLEL_H

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>

namespace quintet {

// Number of threads that parallelFor uses: the cores that this process may run on, at least 1.
unsigned hardwareThreads();

// Calls body(i) once for each i in [0, count), in any order, on all cores, and returns after the last call. The first
// exception that a call throws is rethrown; the remaining calls are skipped. A loop inside a body runs on the thread of
// that body, unless the outer loop has only one iteration.
void parallelFor(std::size_t count, const std::function<void(std::size_t)>& body);

// Calls body(first, last) for consecutive ranges of [0, count) of at most `grain` indices, on all cores.
template <class Body>
void parallelRanges(std::size_t count, const Body& body, std::size_t grain = 65536) {
  parallelFor((count + grain - 1) / grain, [&](std::size_t i) { body(i * grain, std::min(count, (i + 1) * grain)); });
}

// memcpy on all cores. Most of its time is spent in page faults, which the first write to each new page causes.
void parallelCopy(std::byte* to, std::span<const std::byte> from);

}  // namespace quintet
#endif

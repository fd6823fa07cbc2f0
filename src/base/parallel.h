// Data-parallel loops on the host's cores.
#ifndef QUINTET_BASE_PARALLEL_H
#define QUINTET_BASE_PARALLEL_H

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>

namespace quintet {

// Threads that parallelFor uses: the cores this process may run on, at least 1.
unsigned hardwareThreads();

// Calls body(i) once for each i in [0, count), in any order, on all cores; returns when all have
// ended. The first exception thrown by a body is rethrown here; the remaining calls are skipped. A loop inside a body
// runs on that body's core, unless the outer loop has one body only.
void parallelFor(std::size_t count, const std::function<void(std::size_t)>& body);

// Calls body(first, last) for consecutive parts of [0, count) of at most `grain` indices, on all cores.
template <class Body>
void parallelRanges(std::size_t count, const Body& body, std::size_t grain = 65536) {
  parallelFor((count + grain - 1) / grain,
              [&](std::size_t part) { body(part * grain, std::min(count, (part + 1) * grain)); });
}

// memcpy on all cores: first writes to new memory are page faults, and those are what takes the time.
void parallelCopy(std::byte* to, std::span<const std::byte> from);

}  // namespace quintet
#endif

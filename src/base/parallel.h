// Data-parallel loops on the host's cores.
#ifndef QUINTET_BASE_PARALLEL_H
#define QUINTET_BASE_PARALLEL_H

#include <cstddef>
#include <functional>

namespace quintet {

// Threads that parallelFor uses: the cores this process may run on, at least 1.
unsigned hardwareThreads();

// Calls body(i) once for each i in [0, count), in any order, on all cores; returns when all have
// ended. The first exception thrown by a body is rethrown here; the remaining calls are skipped.
void parallelFor(std::size_t count, const std::function<void(std::size_t)>& body);

}  // namespace quintet
#endif

// How much memory this process holds, as the system counts it.
#ifndef QUINTET_BASE_MEMORY_H
#define QUINTET_BASE_MEMORY_H

#include <cstddef>
#include <cstdint>
#include <span>

namespace quintet {

// Bytes in physical memory, mapped files that were read included. 0 where the system does not tell.
std::uint64_t residentBytes();
// The most that it ever was since the process began.
std::uint64_t peakResidentBytes();

// From now on large blocks go back to the system when they are freed; glibc would learn from the first ones to keep them.
// For a program's beginning.
void returnLargeBlocksAtOnce();
// Gives the pages that lie wholly inside these bytes of a vector back to the system: they read as zeros from then on. For
// parts of a large block that nobody reads again.
void givePagesBack(std::span<const std::byte> bytes);
// Gives memory that was freed, but kept for later, back to the system.
void returnFreedMemory();

}  // namespace quintet
#endif

// SPDX-License-Identifier: Apache-2.0
// Memory of this process: resident size, and control over when freed memory returns to the system.
#ifndef QUINTET_BASE_MEMORY_H
#define QUINTET_BASE_MEMORY_H

#include <cstddef>
#include <cstdint>
#include <span>

namespace quintet {

// Returns the bytes of physical memory of the machine; 2^46 if unknown.
std::uint64_t machineMemory();
// Returns the bytes in physical memory, including the pages of mapped files; 0 if unknown.
std::uint64_t residentBytes();
// Returns the maximum of residentBytes() since the process started.
std::uint64_t peakResidentBytes();

// Makes the allocator return blocks of 4 MiB or more to the system as soon as they are freed. By default glibc raises
// this threshold after the first large blocks and keeps later ones. Call it at the start of the program.
void releaseLargeBlocksImmediately();
// Returns the pages that are completely inside `bytes` to the system; they read as zeros afterwards. Use it for parts
// of a large block that are not read again.
void releasePages(std::span<const std::byte> bytes);
// Returns freed memory that the allocator has kept to the system.
void releaseFreedMemory();

}  // namespace quintet
#endif

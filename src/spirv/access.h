// SPDX-License-Identifier: Apache-2.0
// What a load or store accesses: members of structures, and members of buffers.
#ifndef QUINTET_SPIRV_ACCESS_H
#define QUINTET_SPIRV_ACCESS_H

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spirv/module.h"

namespace quintet::spirv {

using IndexPath = std::span<const std::optional<std::uint32_t>>;  // nullopt for dynamic indices

// True if two lists of indices into the same type can select common parts.
bool overlap(IndexPath a, IndexPath b);

// A member that indices select on their way into a type.
struct SelectedMember {
  const Type& structure;
  std::uint32_t member = 0;
  std::size_t position = 0;  // of the member's index

  const std::string& name() const { return structure.memberNames[member]; }
};
// Returns the members from the outermost structure inwards. `module` must outlive them.
std::vector<SelectedMember> selectedMembers(const Module& module, Id type, IndexPath indices);
std::vector<SelectedMember> selectedMembers(const Module& module, const Access& access);

// The member of a buffer that is read or written: the innermost structure and its member.
struct BufferMember {
  std::string structure, member;
  std::uint32_t component = 0;
};
// Returns the member of a structure in a buffer or push constant that a load or store accesses, with `path` into the
// value. Nullopt for any other storage.
std::optional<BufferMember> bufferMember(const Module& module, const Instruction& access, const Path& path = {});

}  // namespace quintet::spirv
#endif

// SPDX-License-Identifier: Apache-2.0
// Where a diagnostic about an instruction belongs: in a file of the user, never in the library.
#ifndef QUINTET_CHECK_RULES_USER_LOCATION_H
#define QUINTET_CHECK_RULES_USER_LOCATION_H

#include <optional>
#include <string_view>

#include "spirv/module.h"

namespace quintet::check {

bool isLibrary(const SourceLocation& location);

// Returns the location of the instruction, at the token if its own line has it.
SourceLocation locationAt(const spirv::Module& module, const spirv::Instruction& instruction, std::string_view token);

// Returns the location of an instruction in a file of the user: its own, or that of the first user of its result there.
// Nullopt if there is none.
std::optional<SourceLocation> userLocation(const spirv::Module& module, const spirv::Instruction& instruction,
                                           std::string_view token = {});

// Returns the location of the call for which the instruction runs, if it is in a function other than main(): the first
// call in the file at or after the line in which `operand` is computed. Nullopt if it is in main(), or not found.
std::optional<SourceLocation> callLocation(const spirv::Module& module, const spirv::Instruction& instruction,
                                           spirv::Id operand);

}  // namespace quintet::check
#endif

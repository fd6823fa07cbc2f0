// SPDX-License-Identifier: Apache-2.0
// The space tags (space_tag.h) of all values of one stage. Sources are the ray tracing built-ins, the matrices and
// buffers of the library, and what other stages store in shared variables. Names of variables have no influence.
//
// The module must be compiled with `optimize`, so functions are inlined. Structures have one tag per leaf: a vector,
// scalar or matrix. Variables that spirv-opt does not remove have the tags of all stores, regardless of the order.
#ifndef QUINTET_CHECK_FLOW_SPACE_TAGS_H
#define QUINTET_CHECK_FLOW_SPACE_TAGS_H

#include <map>
#include <unordered_map>
#include <vector>

#include "check/flow/space_tag.h"
#include "spirv/value_flow.h"

namespace quintet::check {

using SpaceLeaves = std::vector<SpaceTag>;

constexpr std::uint32_t kAnyIndex = ~0u;  // in a path: the index is unknown

// True if an access and a path, which can have kAnyIndex, can select common parts.
bool overlaps(const spirv::Access& access, const spirv::Path& path);

class SpaceTags {
 public:
  // `usesLibrary`: structures with the names of the shader library are those of the library.
  SpaceTags(const spirv::Module& module, bool usesLibrary);

  // Adds the tags that other stages store in a shared variable. Returns whether it changes the variable's tags.
  bool add(spirv::Id variable, const SpaceLeaves& leaves);
  // Tags of a variable: what add() and the stores of the stage give.
  SpaceLeaves contents(spirv::Id variable) const;
  // Propagates tags until they do not change.
  void run();
  // Makes the tags of variables that no stage stores to unknown, and propagates them.
  void finish();

  const spirv::Module& module() const { return module_; }
  // Tag of a vector, scalar or matrix; unknown for a structure.
  SpaceTag of(spirv::Id value) const;
  // The transform by which an instruction multiplies a vector, and the tag of the vector: a product of a matrix and a
  // vector, or the same computation by rows or columns. nullopt if it is none.
  struct Product {
    Transform transform;
    SpaceTag vector;
    spirv::Id operand = 0;  // id of the vector; 0 if unknown
    spirv::Id matrix = 0;   // id of the matrix or of its first row
  };
  std::optional<Product> product(const spirv::Instruction& instruction) const;
  // Loads of a variable, as indices of instructions.
  const std::vector<std::size_t>& loads(spirv::Id variable) const;

 private:
  struct Layout {
    std::size_t count = 1;             // leaves
    bool opaque = false;               // too large: one leaf that is unknown
    bool summary = false;              // array: all elements share their leaves
    std::vector<std::size_t> offsets;  // of the members of a structure
  };
  struct Slice {                       // part of a value
    std::vector<std::size_t> offsets;  // one per possible element
    spirv::Id type = 0;
    std::vector<std::optional<std::uint32_t>> rest;  // indices within the leaf
  };

  const Layout& layout(spirv::Id type) const;
  Slice slice(spirv::Id type, const std::vector<std::optional<std::uint32_t>>& path) const;
  SpaceLeaves read(const SpaceLeaves& leaves, spirv::Id type,
                   const std::vector<std::optional<std::uint32_t>>& path) const;
  SpaceTag part(SpaceTag tag, spirv::Id type, std::span<const std::optional<std::uint32_t>> rest) const;

  SpaceLeaves leavesOf(spirv::Id value) const;
  SpaceLeaves libraryLeaves(spirv::Id type) const;
  SpaceLeaves unknownLeaves(spirv::Id type) const;
  SpaceTag builtInTag(const spirv::Variable& variable) const;
  SpaceLeaves sourceLeaves(const spirv::Access& pointer) const;
  SpaceTag constantTag(spirv::Id value) const;

  SpaceLeaves evaluate(const spirv::Instruction& instruction) const;
  SpaceTag evaluateLeaf(const spirv::Instruction& instruction) const;
  SpaceTag evaluateExtended(const spirv::Instruction& instruction) const;
  SpaceTag evaluateProduct(const spirv::Instruction& instruction) const;
  SpaceTag construct(const spirv::Instruction& instruction) const;
  SpaceTag constructMatrix(const spirv::Instruction& instruction) const;
  SpaceTag vectorOf(std::span<const SpaceTag> components) const;
  SpaceTag shuffle(const spirv::Instruction& instruction) const;
  SpaceTag dot(const spirv::Instruction& instruction) const;
  SpaceTag matrixProduct(const SpaceTag& a, const SpaceTag& b) const;
  SpaceLeaves load(const spirv::Instruction& instruction) const;
  bool store(const spirv::Instruction& instruction);
  bool isAffine(spirv::Id matrix) const;
  bool isTable(spirv::Id variable) const;
  void push(std::size_t instruction);
  void pushUsers(spirv::Id value);

  const spirv::Module& module_;
  const bool usesLibrary_;
  std::vector<SpaceLeaves> tags_;  // by id; empty for undefined
  std::vector<std::uint8_t> visits_;
  std::unordered_map<spirv::Id, SpaceLeaves> variables_;  // that are stored to
  std::unordered_map<spirv::Id, std::vector<std::size_t>> loads_;
  std::vector<std::size_t> open_;
  std::vector<bool> isOpen_;
  mutable std::unordered_map<spirv::Id, Layout> layouts_;
  mutable std::unordered_map<spirv::Id, SpaceLeaves> library_;
};

}  // namespace quintet::check
#endif

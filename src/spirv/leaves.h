// SPDX-License-Identifier: Apache-2.0
// The leaves of a type: the parts without parts of their own, down to the components of vectors. Leaves are numbered in
// the order of declaration, so each part of a value is a range of leaves. The numbers depend only on the type: stages
// with the same type have the same leaves.
//
// Limits: matrices and arrays with more than 16 elements are one leaf. Types with more than 256 leaves are divided less
// finely: into vectors, or else into their outermost members.
#ifndef QUINTET_SPIRV_LEAVES_H
#define QUINTET_SPIRV_LEAVES_H

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spirv/type.h"

namespace quintet::spirv {

// Consecutive leaves [first, last).
struct LeafRange {
  std::uint32_t first = 0;
  std::uint32_t last = 0;
  bool exact = true;  // false if an access to the range concerns only some of its leaves, which are unknown

  std::uint32_t count() const { return last - first; }
  bool covers(std::uint32_t leaf) const { return first <= leaf && leaf < last; }
  bool operator==(const LeafRange&) const = default;
};

class Leaves {
 public:
  Leaves() = default;
  Leaves(const Types& types, Id type);

  std::uint32_t count() const { return static_cast<std::uint32_t>(paths_.size()); }
  const Path& path(std::uint32_t leaf) const { return paths_[leaf]; }
  // The leaves of a part. A path into a leaf gives the leaf. A dynamic index gives all elements, not exact.
  LeafRange range(std::span<const std::optional<std::uint32_t>> indices) const;
  LeafRange range(const Path& path) const;
  // The leaves of the outermost member with this leaf; all leaves if the type has no members.
  LeafRange member(std::uint32_t leaf) const;

  // Names of parts that together are exactly these leaves, sorted, as GLSL appends them to a variable: ".light.color",
  // "[2]", ".color.xy", "" for a whole value that is not a structure. Outermost members are named one by one.
  std::vector<std::string> names(const std::vector<std::uint32_t>& leaves) const;

 private:
  struct Node {
    std::string name;  // as it is appended to the name of the parent
    LeafRange range;
    std::vector<std::size_t> children;
    bool vector = false;
  };
  enum class Detail { components, vectors, members };

  bool build(const Types& types, Id type, Detail detail);
  bool add(const Types& types, Id type, Detail detail, std::string name, Path& path);
  void addNames(std::size_t node, const std::string& prefix, const std::vector<bool>& wanted,
                std::vector<std::string>& result) const;

  std::vector<Node> nodes_;  // the root is the first
  std::vector<Path> paths_;  // by leaf
};

}  // namespace quintet::spirv
#endif

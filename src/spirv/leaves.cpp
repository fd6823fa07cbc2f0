// SPDX-License-Identifier: Apache-2.0
#include "spirv/leaves.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace quintet::spirv {
namespace {

constexpr std::size_t kMaxLeaves = 256;
constexpr std::size_t kMaxElements = 16;  // of an array
constexpr std::size_t kMaxDepth = 16;

constexpr std::string_view kComponents = "xyzw";

}  // namespace

Leaves::Leaves(const Types& types, Id type) {
  for (const Detail detail : {Detail::components, Detail::vectors, Detail::members})
    if (build(types, type, detail)) return;
  nodes_ = {{"", {0, 1}, {}, false}};  // too many members
  paths_ = {{}};
}

bool Leaves::build(const Types& types, Id type, Detail detail) {
  nodes_.clear();
  paths_.clear();
  Path path;
  return add(types, type, detail, "", path);
}

bool Leaves::add(const Types& types, Id id, Detail detail, std::string name, Path& path) {
  const Type& type = types.get(id);
  const std::size_t node = nodes_.size();
  const auto first = static_cast<std::uint32_t>(paths_.size());
  nodes_.push_back({std::move(name), {first, first}, {}, type.kind == Type::Kind::vector});
  const auto addPart = [&](Id part, std::uint32_t index, std::string partName) {
    nodes_[node].children.push_back(nodes_.size());
    path.push_back(index);
    const bool added = add(types, part, detail, std::move(partName), path);
    path.pop_back();
    return added;
  };
  const bool divided = path.size() < kMaxDepth && (detail != Detail::members || path.empty());
  bool leaf = false;
  if (divided && type.kind == Type::Kind::structure && !type.members.empty()) {
    for (std::uint32_t i = 0; i < type.members.size(); ++i) {
      const std::string& member = type.memberNames[i];
      if (!addPart(type.members[i], i, member.empty() ? fmt::format(".member {}", i) : "." + member)) return false;
    }
  } else if (divided && type.kind == Type::Kind::array && type.count > 0 && type.count <= kMaxElements) {
    for (std::uint32_t i = 0; i < type.count; ++i)
      if (!addPart(type.element, i, fmt::format("[{}]", i))) return false;
  } else if (divided && type.kind == Type::Kind::vector && detail == Detail::components &&
             type.count <= kComponents.size()) {
    for (std::uint32_t i = 0; i < type.count; ++i)
      if (!addPart(type.element, i, fmt::format(".{}", kComponents[i]))) return false;
  } else {
    leaf = true;
  }
  if (leaf) paths_.push_back(path);
  nodes_[node].range.last = static_cast<std::uint32_t>(paths_.size());
  return paths_.size() <= kMaxLeaves;
}

LeafRange Leaves::range(std::span<const std::optional<std::uint32_t>> indices) const {
  if (nodes_.empty()) return {};
  std::size_t node = 0;
  for (const std::optional<std::uint32_t>& index : indices) {
    const Node& at = nodes_[node];
    if (at.children.empty()) break;
    if (!index || *index >= at.children.size()) return {at.range.first, at.range.last, false};
    node = at.children[*index];
  }
  return nodes_[node].range;
}

LeafRange Leaves::range(const Path& path) const {
  return range(std::vector<std::optional<std::uint32_t>>(path.begin(), path.end()));
}

LeafRange Leaves::member(std::uint32_t leaf) const {
  const Node& root = nodes_.front();
  for (const std::size_t child : root.children)
    if (!root.vector && nodes_[child].range.covers(leaf)) return nodes_[child].range;
  return root.range;
}

std::vector<std::string> Leaves::names(const std::vector<std::uint32_t>& leaves) const {
  std::vector<std::string> result;
  if (nodes_.empty()) return result;
  std::vector<bool> wanted(paths_.size(), false);
  for (const std::uint32_t leaf : leaves)
    if (leaf < wanted.size()) wanted[leaf] = true;
  const Node& root = nodes_.front();
  const bool structure = !root.children.empty() && nodes_[root.children.front()].name.starts_with('.') && !root.vector;
  if (!structure) {
    addNames(0, "", wanted, result);
  } else {
    for (const std::size_t child : root.children) addNames(child, "", wanted, result);
  }
  return result;
}

void Leaves::addNames(std::size_t node, const std::string& prefix, const std::vector<bool>& wanted,
                      std::vector<std::string>& result) const {
  const Node& at = nodes_[node];
  const auto begin = wanted.begin() + at.range.first, end = wanted.begin() + at.range.last;
  const auto count = std::count(begin, end, true);
  if (count == 0) return;
  const std::string name = prefix + at.name;
  if (count == end - begin) {
    result.push_back(name);
  } else if (at.vector) {
    std::string components;
    for (const std::size_t child : at.children)
      if (wanted[nodes_[child].range.first]) components += nodes_[child].name.substr(1);
    result.push_back(name + "." + components);
  } else {
    for (const std::size_t child : at.children) addNames(child, name, wanted, result);
  }
}

}  // namespace quintet::spirv

// SPDX-License-Identifier: Apache-2.0
#include "spirv/type.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/plural.h"

namespace quintet::spirv {
namespace {

using Kind = Type::Kind;
constexpr int kMaxNesting = 24;           // nesting that is compared or written out
constexpr int kMaxComparisons = 1 << 14;  // of one comparison: nested structures can share parts 2^n times
constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 40;

std::uint64_t limited(std::uint64_t bytes) { return bytes > kMaxBytes ? 0 : bytes; }

std::string scalarName(const Type& type) {
  switch (type.kind) {
    case Kind::boolean: return "bool";
    case Kind::integer: {
      const std::string base = type.isSigned ? "int" : "uint";
      return type.width == 32 ? base : base + std::to_string(type.width) + "_t";
    }
    case Kind::floating:
      return type.width == 32 ? "float" : type.width == 64 ? "double" : fmt::format("float{}_t", type.width);
    default: return "?";
  }
}

std::string vectorPrefix(const Type& type) {
  if (type.kind == Kind::boolean) return "b";
  if (type.kind == Kind::integer)
    return (type.isSigned ? "i" : "u") + (type.width == 32 ? "" : std::to_string(type.width));
  return type.width == 32 ? "" : type.width == 64 ? "d" : fmt::format("f{}", type.width);
}

struct TypeComparison {
  const Types& aTypes;
  const Types& bTypes;
  int steps = 0;

  std::string versus(Id a, Id b) const {
    const std::string left = aTypes.nameOf(a), right = bTypes.nameOf(b);
    return left == right ? fmt::format("'{}' differs", left) : fmt::format("{} vs {}", left, right);
  }

  std::optional<std::string> members(const Type& a, const Type& b, int depth) {
    const std::size_t common = std::min(a.members.size(), b.members.size());
    for (std::size_t i = 0; i < common; ++i) {
      if (auto inner = compare(a.members[i], b.members[i], depth + 1)) {
        const std::string& name = a.memberNames[i].empty() ? b.memberNames[i] : a.memberNames[i];
        const std::string both =
            !b.memberNames[i].empty() && !a.memberNames[i].empty() && a.memberNames[i] != b.memberNames[i]
                ? fmt::format(" / '{}'", b.memberNames[i])
                : "";
        return fmt::format("member {}{}: {}", i, name.empty() ? "" : fmt::format(" '{}'{}", name, both), *inner);
      }
    }
    if (a.members.size() != b.members.size()) {
      const bool more = a.members.size() > b.members.size();
      const std::string extra = more ? a.memberNames[common] : b.memberNames[common];
      return fmt::format(
          "{} vs {}{}", counted(a.members.size(), "member"), b.members.size(),
          extra.empty() ? "" : fmt::format(" ('{}' exists only in the {})", extra, more ? "first" : "second"));
    }
    return differentOrder(a, b);
  }

  // Reports members with the same names in a different order.
  static std::optional<std::string> differentOrder(const Type& a, const Type& b) {
    auto left = a.memberNames, right = b.memberNames;
    const auto differ = std::ranges::mismatch(left, right);
    if (differ.in1 == left.end() || std::ranges::count(left, "") != 0) return {};
    const auto at = static_cast<std::size_t>(differ.in1 - left.begin());
    const std::string text =
        fmt::format("same members in a different order: member {} is '{}' vs '{}'", at, left[at], right[at]);
    std::ranges::sort(left);
    std::ranges::sort(right);
    return left == right ? std::optional(text) : std::nullopt;
  }

  std::optional<std::string> compare(Id a, Id b, int depth) {
    const Type& left = aTypes.get(a);
    const Type& right = bTypes.get(b);
    if (++steps > kMaxComparisons || depth > kMaxNesting) return {};
    // HLSL and Slang put a single value into a structure.
    if (left.kind == Kind::structure && right.kind != Kind::structure && left.members.size() == 1)
      return compare(left.members[0], b, depth + 1) ? std::optional(versus(a, b)) : std::nullopt;
    if (right.kind == Kind::structure && left.kind != Kind::structure && right.members.size() == 1)
      return compare(a, right.members[0], depth + 1) ? std::optional(versus(a, b)) : std::nullopt;
    if (left.kind != right.kind || left.width != right.width || left.isSigned != right.isSigned) return versus(a, b);
    switch (left.kind) {
      case Kind::vector:
      case Kind::matrix:
      case Kind::array:
      case Kind::runtimeArray: {
        // A specialization constant can be the length of an array; it is unknown until it has a value.
        if (left.count != right.count && left.count != 0 && right.count != 0) return versus(a, b);
        if (auto inner = compare(left.element, right.element, depth + 1))
          return aTypes.get(left.element).kind == Kind::structure ? fmt::format("elements: {}", *inner) : versus(a, b);
        return {};
      }
      case Kind::structure: return members(left, right, depth);
      default: return {};  // pointers: all buffer references have the same layout
    }
  }
};

}  // namespace

const Type& Types::get(Id id) const {
  static const Type kNoType;
  const auto found = types_.find(id);
  return found == types_.end() ? kNoType : found->second;
}

void Types::setName(Id id, std::string name) {
  if (const auto found = types_.find(id); found != types_.end()) found->second.name = std::move(name);
}

void Types::setMemberName(Id id, std::uint32_t member, std::string name) {
  const auto found = types_.find(id);
  if (found != types_.end() && member < found->second.memberNames.size())
    found->second.memberNames[member] = std::move(name);
}

void Types::add(Id id, Type type) {
  const std::uint64_t element = get(type.element).bytes;
  switch (type.kind) {
    case Kind::boolean: type.bytes = 4; break;
    case Kind::integer:
    case Kind::floating: type.bytes = (type.width + 7) / 8; break;
    case Kind::vector:
    case Kind::matrix:
    case Kind::array: type.bytes = limited(element * type.count); break;
    case Kind::pointer: type.bytes = 8; break;
    case Kind::structure:
      type.memberNames.resize(type.members.size());
      for (const Id member : type.members) type.bytes = limited(type.bytes + get(member).bytes);
      break;
    default: break;
  }
  types_[id] = std::move(type);
}

Id Types::part(Id id, const Path& path) const {
  for (const std::uint32_t index : path) id = get(id).part(index);
  return id;
}

std::string Types::nameOf(Id id) const {
  std::string suffix;
  for (int depth = 0; depth < kMaxNesting; ++depth) {
    const Type& type = get(id);
    const Type& element = get(type.element);
    switch (type.kind) {
      case Kind::array: suffix += type.count == 0 ? "[?]" : fmt::format("[{}]", type.count); break;
      case Kind::runtimeArray: suffix += "[]"; break;
      case Kind::vector: return vectorPrefix(element) + fmt::format("vec{}", type.count) + suffix;
      case Kind::matrix:
        return vectorPrefix(get(element.element)) +
               (type.count == element.count ? fmt::format("mat{}", type.count)
                                            : fmt::format("mat{}x{}", type.count, element.count)) +
               suffix;
      case Kind::structure: return (type.name.empty() ? "struct" : type.name) + suffix;
      case Kind::voidType: return "void" + suffix;
      case Kind::pointer: return "reference" + suffix;
      case Kind::accelerationStructure: return "accelerationStructureEXT" + suffix;
      case Kind::boolean:
      case Kind::integer:
      case Kind::floating: return scalarName(type) + suffix;
      default: return "?" + suffix;
    }
    id = type.element;
  }
  return "?" + suffix;
}

std::string Types::describe(Id id) const {
  const Type& type = get(id);
  if (type.kind != Kind::structure) return nameOf(id);
  std::string text = type.name.empty() ? "struct {" : fmt::format("struct {} {{", type.name);
  constexpr std::size_t kMaxMembers = 16;
  for (std::size_t i = 0; i < std::min(type.members.size(), kMaxMembers); ++i)
    text += fmt::format(" {} {};", nameOf(type.members[i]),
                        type.memberNames[i].empty() ? fmt::format("_{}", i) : type.memberNames[i]);
  return text + (type.members.size() > kMaxMembers ? " ... }" : " }");
}

std::string Types::signature(Id id) const {
  std::string text;
  addSignature(id, 0, text);
  constexpr std::size_t kMaxSignature = 1 << 14;
  return text.size() > kMaxSignature ? std::string() : text;
}

void Types::addSignature(Id id, int depth, std::string& text) const {
  constexpr std::size_t kEnough = 1 << 15;  // too long in any case
  if (text.size() > kEnough) return;
  if (depth > kMaxNesting) {
    text.append(kEnough, '?');
    return;
  }
  const Type& type = get(id);
  text += fmt::format("{}:{}:{}:{}(", static_cast<int>(type.kind), type.width, type.isSigned ? 1 : 0, type.count);
  if (type.kind == Kind::structure) {
    for (std::size_t i = 0; i < type.members.size(); ++i) {
      addSignature(type.members[i], depth + 1, text);
      text += type.memberNames[i] + ";";
    }
  } else if (type.element != 0 && type.kind != Kind::pointer) {
    addSignature(type.element, depth + 1, text);
  }
  text += ")";
}

std::string Types::memberName(Id id, std::uint32_t member) const {
  const Type& type = get(id);
  if (type.kind != Kind::structure) return "value";
  if (member >= type.memberNames.size() || type.memberNames[member].empty()) return fmt::format("member {}", member);
  return fmt::format("member {} '{}'", member, type.memberNames[member]);
}

std::optional<std::string> differenceOf(const Types& aTypes, Id a, const Types& bTypes, Id b) {
  return TypeComparison{aTypes, bTypes}.compare(a, b, 0);
}

}  // namespace quintet::spirv

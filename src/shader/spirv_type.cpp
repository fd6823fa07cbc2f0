#include "shader/spirv_type.h"

#include <fmt/format.h>

#include <algorithm>

namespace quintet::shader {
namespace {

using Kind = SpirvType::Kind;
constexpr int kMaxDepth = 24;       // of nesting that is compared or written out
constexpr int kMaxSteps = 1 << 14;  // of one comparison: nested structures can share parts 2^n times
constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 40;

std::uint64_t limited(std::uint64_t bytes) { return bytes > kMaxBytes ? 0 : bytes; }

std::string scalarName(const SpirvType& type) {
  switch (type.kind) {
    case Kind::boolean: return "bool";
    case Kind::integer: {
      const std::string base = type.isSigned ? "int" : "uint";
      return type.width == 32 ? base : base + std::to_string(type.width) + "_t";
    }
    case Kind::real:
      return type.width == 32 ? "float" : type.width == 64 ? "double" : fmt::format("float{}_t", type.width);
    default: return "?";
  }
}

std::string vectorPrefix(const SpirvType& type) {
  if (type.kind == Kind::boolean) return "b";
  if (type.kind == Kind::integer)
    return (type.isSigned ? "i" : "u") + (type.width == 32 ? "" : std::to_string(type.width));
  return type.width == 32 ? "" : type.width == 64 ? "d" : fmt::format("f{}", type.width);
}

struct Comparison {
  const SpirvTypes& aTypes;
  const SpirvTypes& bTypes;
  int steps = 0;

  std::string against(SpirvId a, SpirvId b) const {
    const std::string left = aTypes.nameOf(a), right = bTypes.nameOf(b);
    return left == right ? fmt::format("'{}' differs", left) : fmt::format("{} against {}", left, right);
  }

  std::optional<std::string> members(const SpirvType& a, const SpirvType& b, int depth) {
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
          "{} member{} against {}{}", a.members.size(), a.members.size() == 1 ? "" : "s", b.members.size(),
          extra.empty() ? "" : fmt::format(" ('{}' is only in the {} one)", extra, more ? "first" : "second"));
    }
    return otherOrder(a, b);
  }

  // Two members of one type that changed places: each name is in both, but not at the same position.
  static std::optional<std::string> otherOrder(const SpirvType& a, const SpirvType& b) {
    auto left = a.memberNames, right = b.memberNames;
    const auto differ = std::ranges::mismatch(left, right);
    if (differ.in1 == left.end() || std::ranges::count(left, "") != 0) return {};
    const auto at = static_cast<std::size_t>(differ.in1 - left.begin());
    const std::string text =
        fmt::format("the same members in another order: member {} is '{}' against '{}'", at, left[at], right[at]);
    std::ranges::sort(left);
    std::ranges::sort(right);
    return left == right ? std::optional(text) : std::nullopt;
  }

  std::optional<std::string> compare(SpirvId a, SpirvId b, int depth) {
    const SpirvType& left = aTypes.get(a);
    const SpirvType& right = bTypes.get(b);
    if (++steps > kMaxSteps || depth > kMaxDepth) return {};
    if (left.kind != right.kind || left.width != right.width || left.isSigned != right.isSigned) return against(a, b);
    switch (left.kind) {
      case Kind::vector:
      case Kind::matrix:
      case Kind::array:
      case Kind::runtimeArray: {
        if (left.count != right.count) return against(a, b);
        if (auto inner = compare(left.element, right.element, depth + 1))
          return aTypes.get(left.element).kind == Kind::structure ? fmt::format("elements: {}", *inner) : against(a, b);
        return {};
      }
      case Kind::structure: return members(left, right, depth);
      default: return {};  // pointers: all buffer references are alike
    }
  }
};

}  // namespace

const SpirvType& SpirvTypes::get(SpirvId id) const {
  static const SpirvType kNoType;
  const auto found = types_.find(id);
  return found == types_.end() ? kNoType : found->second;
}

void SpirvTypes::setName(SpirvId id, std::string name) {
  if (const auto found = types_.find(id); found != types_.end()) found->second.name = std::move(name);
}

void SpirvTypes::setMemberName(SpirvId id, std::uint32_t member, std::string name) {
  const auto found = types_.find(id);
  if (found != types_.end() && member < found->second.memberNames.size())
    found->second.memberNames[member] = std::move(name);
}

void SpirvTypes::add(SpirvId id, SpirvType type) {
  const std::uint64_t element = get(type.element).bytes;
  switch (type.kind) {
    case Kind::boolean: type.bytes = 4; break;
    case Kind::integer:
    case Kind::real: type.bytes = (type.width + 7) / 8; break;
    case Kind::vector:
    case Kind::matrix:
    case Kind::array: type.bytes = limited(element * type.count); break;
    case Kind::pointer: type.bytes = 8; break;
    case Kind::structure:
      type.memberNames.resize(type.members.size());
      for (const SpirvId member : type.members) type.bytes = limited(type.bytes + get(member).bytes);
      break;
    default: break;
  }
  types_[id] = std::move(type);
}

std::string SpirvTypes::nameOf(SpirvId id) const {
  std::string suffix;
  for (int depth = 0; depth < kMaxDepth; ++depth) {
    const SpirvType& type = get(id);
    const SpirvType& element = get(type.element);
    switch (type.kind) {
      case Kind::array: suffix += fmt::format("[{}]", type.count); break;
      case Kind::runtimeArray: suffix += "[]"; break;
      case Kind::vector: return vectorPrefix(element) + fmt::format("vec{}", type.count) + suffix;
      case Kind::matrix:
        return vectorPrefix(get(element.element)) +
               (type.count == element.count ? fmt::format("mat{}", type.count)
                                            : fmt::format("mat{}x{}", type.count, element.count)) +
               suffix;
      case Kind::structure: return (type.name.empty() ? "struct" : type.name) + suffix;
      case Kind::nothing: return "void" + suffix;
      case Kind::pointer: return "reference" + suffix;
      case Kind::accelerationStructure: return "accelerationStructureEXT" + suffix;
      case Kind::boolean:
      case Kind::integer:
      case Kind::real: return scalarName(type) + suffix;
      default: return "?" + suffix;
    }
    id = type.element;
  }
  return "?" + suffix;
}

std::string SpirvTypes::describe(SpirvId id) const {
  const SpirvType& type = get(id);
  if (type.kind != Kind::structure) return nameOf(id);
  std::string text = type.name.empty() ? "struct {" : fmt::format("struct {} {{", type.name);
  constexpr std::size_t kMaxMembers = 16;
  for (std::size_t i = 0; i < std::min(type.members.size(), kMaxMembers); ++i)
    text += fmt::format(" {} {};", nameOf(type.members[i]),
                        type.memberNames[i].empty() ? fmt::format("_{}", i) : type.memberNames[i]);
  return text + (type.members.size() > kMaxMembers ? " ... }" : " }");
}

std::string SpirvTypes::memberName(SpirvId id, std::uint32_t member) const {
  const SpirvType& type = get(id);
  if (type.kind != Kind::structure) return "value";
  if (member >= type.memberNames.size() || type.memberNames[member].empty()) return fmt::format("member {}", member);
  return fmt::format("member {} '{}'", member, type.memberNames[member]);
}

std::optional<std::string> differenceOf(const SpirvTypes& aTypes, SpirvId a, const SpirvTypes& bTypes, SpirvId b) {
  return Comparison{aTypes, bTypes}.compare(a, b, 0);
}

}  // namespace quintet::shader

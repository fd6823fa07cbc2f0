// SPDX-License-Identifier: Apache-2.0
// Q713: results stored at a wrong pixel. Q716: integer division of the launch id by the size.
//
// Both follow the two coordinates of the launch id through sums, conversions and choices. Other operations, such as the
// bits of a tile's Morton order, end the search.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "check/library_names.h"
#include "check/rules/rules.h"
#include "check/rules/user_location.h"
#include "spirv/access.h"
#include "spirv/source_text.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spirv::Id;
using spirv::Path;
using spv::Op;

constexpr int kMaxPixelDepth = 24;
constexpr int kMaxPixelValues = 500;  // that a search follows; it finds nothing if there are more

bool isMember(const spirv::Module& module, const spirv::Instruction& access, const Path& path,
              std::string_view structure, std::string_view member) {
  const auto found = spirv::bufferMember(module, access, path);
  return found && found->member == member && libraryName(found->structure) == structure;
}

// The component of a vector built-in that is read; nullopt for any other value.
std::optional<std::uint32_t> componentOf(const spirv::Module& module, const spirv::Instruction& load, const Path& path,
                                         spv::BuiltIn builtIn) {
  if (!spirv::loadsBuiltIn(module, load, builtIn)) return {};
  const spirv::Access access = module.access(load.at(0));
  if (access.indices.size() + path.size() != 1) return {};
  return path.empty() ? access.indices[0] : std::optional(path[0]);
}

// The value before conversions to float and between signed and unsigned.
spirv::ValuePart withoutConversions(const spirv::Module& module, spirv::ValuePart value) {
  for (int depth = 0; depth < kMaxPixelDepth; ++depth) {
    value = spirv::originOf(module, std::move(value));
    const spirv::Instruction* i = module.definition(value.id);
    if (!i || (i->op != Op::OpConvertUToF && i->op != Op::OpConvertSToF && i->op != Op::OpBitcast)) break;
    value.id = i->at(0);
  }
  return value;
}

// A value that is a coordinate of the pixel: that of the launch, or of the image.
struct Coordinate {
  std::uint32_t axis = 0;  // 0 x, 1 y
  bool ofImage = false;
  bool operator==(const Coordinate&) const = default;
};

// `budget` is the number of values that the search still follows.
std::optional<Coordinate> coordinateOf(const spirv::Module& module, Id value, Path given, int& budget, int depth = 0) {
  const spirv::ValuePart origin = spirv::originOf(module, {value, std::move(given)});
  const Id id = origin.id;
  const Path& path = origin.path;
  const spirv::Instruction* i = module.definition(id);
  if (!i || depth > kMaxPixelDepth || --budget < 0) return {};
  const auto operand = [&](std::size_t k) { return module.definition(spirv::originOf(module, {i->at(k), path}).id); };
  const auto partOf = [&](std::size_t k) { return spirv::originOf(module, {i->at(k), path}).path; };
  switch (i->op) {
    case Op::OpLoad: {
      const auto axis = componentOf(module, *i, path, spv::BuiltIn::LaunchIdKHR);
      return axis && *axis < 2 ? std::optional(Coordinate{*axis, false}) : std::nullopt;
    }
    case Op::OpBitcast:
    case Op::OpUConvert:
    case Op::OpSConvert: return coordinateOf(module, i->at(0), path, budget, depth + 1);
    case Op::OpIAdd:
      for (const std::size_t k : {0u, 1u}) {
        const spirv::Instruction* other = operand(1 - k);
        if (!other || !isMember(module, *other, partOf(1 - k), "Launch", "offset")) continue;
        if (const auto found = coordinateOf(module, i->at(k), path, budget, depth + 1))
          return Coordinate{found->axis, true};
      }
      return {};
    case Op::OpISub: {  // height - 1 - y
      const auto found = coordinateOf(module, i->at(1), path, budget, depth + 1);
      const spirv::Instruction* top = operand(0);
      if (!found || found->axis != 1 || !top || (top->op != Op::OpISub && top->op != Op::OpIAdd)) return {};
      const spirv::Instruction* height = module.definition(spirv::originOf(module, {top->at(0), partOf(0)}).id);
      return height && isMember(module, *height, {}, "Frame", "height") ? found : std::nullopt;
    }
    case Op::OpPhi:
    case Op::OpSelect: {
      std::optional<Coordinate> result;
      const bool phi = i->op == Op::OpPhi;
      for (std::size_t k = phi ? 0 : 1; k < i->operands.size(); k += phi ? 2 : 1) {
        const auto found = coordinateOf(module, i->at(k), path, budget, depth + 4);
        if (found && result && *found != *result) return {};
        if (found) result = found;
      }
      return result;
    }
    default: return {};
  }
}

std::optional<Coordinate> coordinateOf(const spirv::Module& module, Id value, const Path& path) {
  int budget = kMaxPixelValues;
  const auto found = coordinateOf(module, value, path, budget);
  return budget >= 0 ? found : std::nullopt;
}

// A value `coordinate * pixel + size * (extent of the image) + constant` along one axis.
struct Linear {
  double coordinate = 0.0, size = 0.0, constant = 0.0;
};

std::optional<Linear> linearOf(const spirv::Module& module, Id value, Path given, std::uint32_t axis, int& budget,
                               int depth = 0) {
  const spirv::ValuePart part = spirv::originOf(module, {value, std::move(given)});
  const spirv::Instruction* i = module.definition(part.id);
  if (!i || depth > kMaxPixelDepth || --budget < 0) return {};
  if (const auto number = spirv::constantNumber(module, part))  // 1u - 2u is a constant of the type uint
    return Linear{0.0, 0.0, *number > 2147483647.0 ? *number - 4294967296.0 : *number};
  if (i->op == Op::OpBitcast) return linearOf(module, i->at(0), part.path, axis, budget, depth + 1);
  if (isMember(module, *i, part.path, "Frame", axis == 0 ? "width" : "height")) return Linear{0.0, 1.0, 0.0};
  if (i->op == Op::OpIAdd || i->op == Op::OpISub) {
    const auto a = linearOf(module, i->at(0), part.path, axis, budget, depth + 1);
    const auto b = linearOf(module, i->at(1), part.path, axis, budget, depth + 1);
    const double sign = i->op == Op::OpIAdd ? 1.0 : -1.0;
    if (a && b)
      return Linear{a->coordinate + sign * b->coordinate, a->size + sign * b->size, a->constant + sign * b->constant};
  }
  const auto coordinate = coordinateOf(module, part.id, part.path, budget);
  return coordinate && coordinate->axis == axis ? std::optional(Linear{1.0, 0.0, 0.0}) : std::nullopt;
}

// Returns the text of a mirrored coordinate that is not `size - 1 - pixel`; empty for any other value.
std::string mirroredOutside(const spirv::Module& module, const spirv::ValuePart& value, std::uint32_t axis) {
  int budget = kMaxPixelValues;
  const auto linear = linearOf(module, value.id, value.path, axis, budget);
  if (budget < 0 || !linear || linear->coordinate != -1.0 || linear->size != 1.0 || linear->constant == -1.0) return {};
  const char* size = axis == 0 ? "width" : "height";
  const char* name = axis == 0 ? "column" : "row";
  return linear->constant > -1.0
             ? fmt::format("the result of {} 0 is stored at {} frame.{}{}, but the last {} is frame.{} - 1", name, name,
                           size, linear->constant == 0.0 ? "" : fmt::format(" + {}", linear->constant), name, size)
             : fmt::format("the result of the last {} is stored at {} {}", name, name, linear->constant + 1.0);
}

// Which launch coordinates a value is made of by sums and differences, and by which factor they are scaled.
struct Parts {
  bool x = false, y = false;
  double factor = 1.0;
  bool normalized = false;       // divided by the size of the image
  int budget = kMaxPixelValues;  // number of values that the search still follows
};

// True for frame.width, frame.height and components of gl_LaunchSizeEXT, also as float.
bool isSize(const spirv::Module& module, Id value, Path path) {
  const spirv::ValuePart size = withoutConversions(module, {value, std::move(path)});
  const spirv::Instruction* i = module.definition(size.id);
  return i && i->op == Op::OpLoad &&
         (spirv::loadsBuiltIn(module, *i, spv::BuiltIn::LaunchSizeKHR) ||
          isMember(module, *i, size.path, "Frame", "width") || isMember(module, *i, size.path, "Frame", "height"));
}

void addParts(const spirv::Module& module, const spirv::ValueRanges& ranges, Id value, Path given, Parts& parts,
              double factor = 1.0, int depth = 0) {
  const spirv::ValuePart origin = spirv::originOf(module, {value, std::move(given)});
  const Id id = origin.id;
  const Path& path = origin.path;
  const spirv::Instruction* i = module.definition(id);
  if (!i || depth > kMaxPixelDepth || --parts.budget < 0) return;
  const auto follow = [&](std::size_t k, double by = 1.0, int deeper = 1) {
    addParts(module, ranges, i->at(k), path, parts, factor * by, depth + deeper);
  };
  switch (i->op) {
    case Op::OpLoad:
      if (const auto axis = componentOf(module, *i, path, spv::BuiltIn::LaunchIdKHR)) {
        (*axis == 0 ? parts.x : parts.y) = true;
        parts.factor = factor;
      }
      return;
    case Op::OpBitcast:
    case Op::OpUConvert:
    case Op::OpSConvert:
    case Op::OpConvertUToF:
    case Op::OpConvertSToF:
    case Op::OpConvertFToU:
    case Op::OpConvertFToS: return follow(0);
    case Op::OpIAdd:
    case Op::OpISub:
    case Op::OpFAdd:
    case Op::OpFSub: return follow(0), follow(1);
    case Op::OpIMul:
    case Op::OpFMul:
    case Op::OpVectorTimesScalar:
    case Op::OpUDiv:
    case Op::OpSDiv:
    case Op::OpFDiv: {
      const bool product = i->op == Op::OpIMul || i->op == Op::OpFMul || i->op == Op::OpVectorTimesScalar;
      const Path second = i->op == Op::OpVectorTimesScalar ? Path{} : path;
      const std::optional<double> by = ranges.range(i->at(1), second).constant();
      const std::optional<double> first = ranges.range(i->at(0), path).constant();
      if (by && *by != 0.0) return follow(0, product ? *by : 1.0 / *by);
      if (first && product) return follow(1, *first);
      if (i->op == Op::OpFDiv && isSize(module, i->at(1), path)) parts.normalized = true, follow(0);
      return;
    }
    case Op::OpShiftLeftLogical:
    case Op::OpShiftRightLogical: {
      const std::optional<double> by = ranges.range(i->at(1), path).constant();
      if (by && *by >= 0.0 && *by < 16.0)
        follow(0, i->op == Op::OpShiftLeftLogical ? 1 << static_cast<int>(*by) : 1.0 / (1 << static_cast<int>(*by)));
      return;
    }
    case Op::OpPhi:
      for (std::size_t k = 0; k < i->operands.size(); k += 2) follow(k, 1.0, 4);
      return;
    case Op::OpSelect: return follow(1, 1.0, 4), follow(2, 1.0, 4);
    default: return;
  }
}

// A value without `- frame.filmOffset`.
spirv::ValuePart withoutFilmOffset(const spirv::Module& module, Id value, Path path) {
  const spirv::ValuePart part = spirv::originOf(module, {value, std::move(path)});
  const spirv::Instruction* i = module.definition(part.id);
  if (!i || i->op != Op::OpISub) return part;
  const spirv::ValuePart subtracted = spirv::originOf(module, {i->at(1), part.path});
  const spirv::Instruction* offset = module.definition(subtracted.id);
  if (!offset || !isMember(module, *offset, subtracted.path, "Frame", "filmOffset")) return part;
  return spirv::originOf(module, {i->at(0), part.path});
}

// The coordinates of a stored pixel.
struct Target {
  spirv::ValuePart x, y;
};

// The target of an index y * filmWidth + x. In outputIndex(), it is one of two values; the other one is for tiles.
std::optional<Target> targetOfIndex(const spirv::Module& module, Id index, int depth = 0) {
  const spirv::Instruction* i = module.definition(spirv::originOf(module, {index}).id);
  if (!i || depth > kMaxPixelDepth) return {};
  if (i->op == Op::OpPhi || i->op == Op::OpSelect) {
    const bool phi = i->op == Op::OpPhi;
    for (std::size_t k = phi ? 0 : 1; k < i->operands.size(); k += phi ? 2 : 1)
      if (const auto found = targetOfIndex(module, i->at(k), depth + 4)) return found;
    return {};
  }
  if (i->op != Op::OpIAdd) return {};
  for (const std::size_t k : {0u, 1u}) {
    const spirv::Instruction* row = module.definition(spirv::originOf(module, {i->at(k)}).id);
    if (!row || row->op != Op::OpIMul) continue;
    for (const std::size_t f : {0u, 1u}) {
      const spirv::ValuePart factor = spirv::originOf(module, {row->at(f)});
      const spirv::Instruction* width = module.definition(factor.id);
      if (width && isMember(module, *width, factor.path, "Frame", "filmWidth"))
        return Target{withoutFilmOffset(module, i->at(1 - k), {}), withoutFilmOffset(module, row->at(1 - f), {})};
    }
  }
  return {};
}

// The target of a store to an output.
std::optional<Target> outputTarget(const spirv::Module& module, const spirv::Instruction& store) {
  const spirv::Instruction* chain = module.definition(store.at(0));
  if (!chain || (chain->op != Op::OpAccessChain && chain->op != Op::OpInBoundsAccessChain) ||
      chain->operands.size() < 3)
    return {};
  const auto member = spirv::bufferMember(module, store);
  if (!member || libraryName(member->structure) != "OutputArray") return {};
  return targetOfIndex(module, chain->at(2));
}

std::optional<Target> targetOf(const spirv::Module& module, const spirv::Instruction& i) {
  if (i.op == Op::OpStore) return outputTarget(module, i);
  if (i.op != Op::OpImageWrite) return {};
  return Target{spirv::originOf(module, {i.at(1), {0}}), spirv::originOf(module, {i.at(1), {1}})};
}

// The branch that the library's own test of the pixel starts with, or the store if there is none.
std::size_t withoutLibraryTests(const spirv::Module& module, std::size_t store) {
  const auto position = module.position(store);
  if (!position) return store;
  const spirv::ControlFlow flow(module, position->function);
  std::size_t found = store;
  for (std::size_t block = flow.dominator(position->block); block != spirv::Module::kNone;
       block = flow.dominator(block)) {
    const std::size_t branch = flow.function().blocks[block].end - 1;
    const bool conditional = module.instructions()[branch].op != Op::OpBranch;
    if (conditional && !isLibrary(module.location(module.instructions()[branch]))) break;
    found = branch;
  }
  return found;
}

// True if a condition on the launch id decides whether the store runs.
bool guardedByLaunch(const spirv::Module& module, const spirv::ValueRanges& ranges, std::size_t store) {
  const std::size_t instruction = withoutLibraryTests(module, store);
  for (const spirv::Instruction& load : module.instructions())
    if (load.op == Op::OpLoad && spirv::loadsBuiltIn(module, load, spv::BuiltIn::LaunchIdKHR))
      return ranges.guarded(instruction, load.result);
  return false;
}

// Location of a store to an output, in the user's file: the call of a library function at or after the line where the
// stored value is computed.
SourceLocation locationOf(const spirv::Module& module, const spirv::Instruction& store) {
  const SourceLocation own = module.location(store, "imageStore");
  if (!isLibrary(own) || store.op != Op::OpStore) return own;
  SourceLocation from;
  (void)spirv::dependsOn(module, store.at(1), [&](const spirv::Instruction& i) {
    const SourceLocation location = module.location(i);
    if (location.line > 0 && !isLibrary(location) && location.line > from.line) from = location;
    return false;
  });
  if (from.line == 0) return own;
  const std::string_view text = module.source(from.file);
  const int last = static_cast<int>(std::ranges::count(text, '\n')) + 1;
  for (int line = from.line; line <= last; ++line)
    for (const std::string_view name : {"storeOutput", "addOutput", "storeCoverage"})
      if (const std::size_t at = spirv::findToken(spirv::lineOf(text, line), name); at != std::string_view::npos)
        return {from.file, line, static_cast<int>(at) + 1};
  return from;
}

void checkTarget(const spirv::Module& module, const spirv::ValueRanges& ranges, std::size_t instruction,
                 const Target& target, Report& report) {
  const bool isOutput = module.instructions()[instruction].op == Op::OpStore;
  Parts x, y;
  addParts(module, ranges, target.x.id, target.x.path, x);
  addParts(module, ranges, target.y.id, target.y.path, y);
  if (x.budget < 0 || y.budget < 0) return;
  const SourceLocation location = locationOf(module, module.instructions()[instruction]);
  if (!x.x && x.y && y.x && !y.y)
    return report.addOncePerLine(
        "Q713", location,
        "the result is stored at the transposed pixel: x comes from gl_LaunchIDEXT.y and y from "
        "gl_LaunchIDEXT.x");
  if (guardedByLaunch(module, ranges, instruction)) return;
  const std::optional<double> column = ranges.range(target.x.id, target.x.path).constant();
  const std::optional<double> row = ranges.range(target.y.id, target.y.path).constant();
  if (column && row)
    return report.addOncePerLine(
        "Q713", location, fmt::format("all invocations store their result at the same pixel ({}, {})", *column, *row));
  if ((x.x && x.normalized) || (y.y && y.normalized))
    return report.addOncePerLine("Q713", location,
                                 fmt::format("the result is stored at the pixel scaled to a fixed size of {}, but the "
                                             "image can have any size",
                                             x.x && x.normalized ? x.factor : y.factor));
  for (const std::uint32_t axis : {0u, 1u})
    if (const std::string text = mirroredOutside(module, axis == 0 ? target.x : target.y, axis); !text.empty())
      return report.addOncePerLine("Q713", location, text);
  const auto coordinateX = coordinateOf(module, target.x.id, target.x.path);
  const auto coordinateY = coordinateOf(module, target.y.id, target.y.path);
  if (isOutput && coordinateX == Coordinate{0, false} && coordinateY == Coordinate{1, false})
    return report.addOncePerLine("Q713", location,
                                 "the result is stored at gl_LaunchIDEXT.xy, but a launch is a part of the image; the "
                                 "pixel is launchPixel()");
  // 1 for an axis that is not scaled, or not made of its own coordinate alone.
  const double factors[] = {x.x && !x.y ? x.factor : 1.0, y.y && !y.x ? y.factor : 1.0};
  const auto isMultiplied = [](double factor) { return factor > 1.0; };
  const auto isDivided = [](double factor) { return factor > 0.0 && factor < 1.0; };
  if (const auto* const factor = std::ranges::find_if(factors, isMultiplied); factor != std::end(factors))
    report.addOncePerLine(
        "Q713", location,
        fmt::format("the result is stored at the pixel times {}, which is outside of the image for most "
                    "pixels",
                    *factor));
  else if (const auto* const part = std::ranges::find_if(factors, isDivided); part != std::end(factors))
    report.addOncePerLine(
        "Q713", location,
        fmt::format("the result is stored at the pixel divided by {}, so several invocations store to "
                    "the same pixel",
                    1.0 / *part));
}

// True if the divisor is the size along the axis of the coordinate, which is larger.
bool isSizeOf(const spirv::Module& module, Id value, const Path& path, const Coordinate& coordinate, bool library) {
  const spirv::ValuePart size = withoutConversions(module, {value, path});
  const spirv::Instruction* i = module.definition(size.id);
  if (!i || i->op != Op::OpLoad) return false;
  if (!coordinate.ofImage && componentOf(module, *i, size.path, spv::BuiltIn::LaunchSizeKHR) == coordinate.axis)
    return true;
  return library && isMember(module, *i, size.path, "Frame", coordinate.axis == 0 ? "width" : "height");
}

}  // namespace

void checkPixels(const spirv::Module& module, Report& report) {
  const spirv::ValueRanges ranges(module);
  for (std::size_t k = 0; k < module.instructions().size(); ++k)
    if (const auto target = targetOf(module, module.instructions()[k])) checkTarget(module, ranges, k, *target, report);
}

void checkPixelDivision(const spirv::Module& module, bool library, Report& report) {
  for (const spirv::Instruction& i : module.instructions()) {
    if (i.op != Op::OpUDiv && i.op != Op::OpSDiv) continue;
    const spirv::Type& type = module.types().get(i.type);
    const std::uint32_t count = type.kind == spirv::Type::Kind::vector ? type.count : 0;
    for (std::uint32_t c = 0; c < std::max(1u, count); ++c) {
      const Path path = count > 0 ? Path{c} : Path{};
      const auto coordinate = coordinateOf(module, i.at(0), path);
      if (!coordinate || !isSizeOf(module, i.at(1), path, *coordinate, library)) continue;
      report.addOncePerLine("Q716", locationAt(module, i, "gl_LaunchIDEXT"),
                            fmt::format("this integer division of gl_LaunchIDEXT.{} by the size is always 0; convert "
                                        "both to float first",
                                        coordinate->axis == 0 ? "x" : "y"));
      break;
    }
  }
}

}  // namespace quintet::check

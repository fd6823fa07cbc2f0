// SPDX-License-Identifier: Apache-2.0
#include "spirv/value_range.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <set>
#include <utility>

namespace quintet::spirv {
namespace {

using spv::Op;
using Kind = Type::Kind;

constexpr std::size_t kMaxPairs = 256;  // of values that an operation combines

std::uint32_t bitsOf(double value) { return static_cast<std::uint32_t>(static_cast<std::int64_t>(value)); }

// What an operation with a constant keeps of the other operand's occurrence.
enum class Keeps { nothing, each, many };

using Exact = std::function<std::optional<double>(double, double)>;
using Hull = std::function<std::optional<std::pair<double, double>>(const ValueRange&, const ValueRange&)>;

Occurrence combined(const ValueRange& a, const ValueRange& b, Keeps keeps) {
  const bool aConstant = a.values.size() == 1, bConstant = b.values.size() == 1;
  if (!aConstant && !bConstant) return Occurrence::unknown;
  const Occurrence other = aConstant ? b.occurrence : a.occurrence;
  if (other == Occurrence::many) return keeps == Keeps::many ? other : Occurrence::unknown;
  return other;
}

ValueRange combine(const Type& type, const ValueRange& a, const ValueRange& b, const Exact& exact, const Hull& hull,
                   Keeps keeps) {
  if (a.empty() || b.empty()) return never();
  if (a.onlyNan() || b.onlyNan()) return isFloat(type) ? onlyNan() : rangeOf(type);
  if (!a.values.empty() && !b.values.empty() && a.values.size() * b.values.size() <= kMaxPairs && !a.nan && !b.nan) {
    std::set<double> found;
    bool known = true;
    for (const double x : a.values)
      for (const double y : b.values) {
        const std::optional<double> value = exact(x, y);
        if (value && !std::isnan(*value))
          found.insert(stored(type, *value) + 0.0);
        else
          known = false;
      }
    if (known) {
      const bool few = found.size() <= ValueRange::kMaxValues;
      ValueRange result = few ? ValueRange::among({found.begin(), found.end()}, combined(a, b, Keeps::each))
                              : ValueRange::between(*found.begin(), *found.rbegin(), combined(a, b, Keeps::each));
      return fitted(type, std::move(result));
    }
  }
  const auto ends = hull(a, b);
  if (!ends || std::isnan(ends->first) || std::isnan(ends->second)) return rangeOf(type);
  ValueRange result = ValueRange::between(ends->first, ends->second);
  if (isFloat(type)) {
    result.min = stored(type, result.min), result.max = stored(type, result.max);
    result.nan = a.nan || b.nan || std::isinf(a.min) || std::isinf(a.max) || std::isinf(b.min) || std::isinf(b.max);
  }
  const Occurrence occurrence = combined(a, b, keeps);
  if (keeps != Keeps::nothing && a.values.empty() != b.values.empty()) {
    result.occurrence = occurrence;
    result.run = a.values.empty() ? a.run : b.run;
  }
  return fitted(type, std::move(result));
}

// The quotients of runs of consecutive integers are shorter runs.
ValueRange withShorterRuns(ValueRange quotient, const ValueRange& dividend, std::optional<double> divisor) {
  if (dividend.occurrence != Occurrence::many || dividend.min < 0.0 || !divisor || *divisor < 1.0) return quotient;
  const double run = std::floor(dividend.run / *divisor);
  if (run < 2.0 || !quotient.values.empty()) return quotient;
  quotient.occurrence = Occurrence::many;
  quotient.run = run;
  return quotient;
}

using Pair = std::pair<double, double>;

double product(double x, double y) { return x == 0.0 || y == 0.0 ? 0.0 : x * y; }

std::optional<Pair> productHull(const ValueRange& a, const ValueRange& b) {
  const double all[] = {product(a.min, b.min), product(a.min, b.max), product(a.max, b.min), product(a.max, b.max)};
  return Pair{*std::ranges::min_element(all), *std::ranges::max_element(all)};
}

std::optional<bool> decided(Relation relation, const ValueRange& a, const ValueRange& b) {
  const bool disjoint = a.max < b.min || b.max < a.min ||
                        (!a.values.empty() && !b.values.empty() && std::ranges::none_of(a.values, [&](double v) {
                          return std::ranges::binary_search(b.values, v);
                        }));
  switch (relation) {
    case Relation::equal:
      if (disjoint) return false;
      return a.constant() && a.constant() == b.constant() ? std::optional(true) : std::nullopt;
    case Relation::notEqual:
      if (disjoint) return true;
      return a.constant() && a.constant() == b.constant() ? std::optional(false) : std::nullopt;
    case Relation::less:
      return a.max < b.min ? std::optional(true) : a.min >= b.max ? std::optional(false) : std::nullopt;
    case Relation::lessOrEqual:
      return a.max <= b.min ? std::optional(true) : a.min > b.max ? std::optional(false) : std::nullopt;
    case Relation::greater: return decided(Relation::less, b, a);
    case Relation::greaterOrEqual: return decided(Relation::lessOrEqual, b, a);
  }
  return {};
}

}  // namespace

ValueRange ValueRange::of(double value) { return among({value}, Occurrence::each); }

ValueRange ValueRange::between(double min, double max, Occurrence occurrence) {
  ValueRange result;
  result.min = min, result.max = max, result.nan = false, result.occurrence = occurrence;
  return result;
}

ValueRange ValueRange::among(std::vector<double> values, Occurrence occurrence) {
  ValueRange result = between(values.front(), values.back(), occurrence);
  result.values = std::move(values);
  return result;
}

std::optional<double> ValueRange::atLeast(double count) const {
  if (empty()) return {};
  if (min >= count) return min;
  return occurrence == Occurrence::each && max >= count ? std::optional(max) : std::nullopt;
}

bool ValueRange::contains(double value) const {
  if (!values.empty()) return std::ranges::binary_search(values, value);
  return value >= min && value <= max;
}

bool isInteger(const Type& type) { return type.kind == Kind::integer && type.width <= 32; }
bool isFloat(const Type& type) { return type.kind == Kind::floating && type.width == 32; }

double lowest(const Type& type) { return type.isSigned ? -std::ldexp(1.0, static_cast<int>(type.width) - 1) : 0.0; }
double highest(const Type& type) {
  return std::ldexp(1.0, static_cast<int>(type.width) - (type.isSigned ? 1 : 0)) - 1.0;
}

ValueRange rangeOf(const Type& type) {
  if (type.kind == Kind::boolean) return ValueRange::between(0.0, 1.0);
  if (isInteger(type)) return ValueRange::between(lowest(type), highest(type));
  ValueRange result;
  result.nan = type.kind == Kind::floating;
  return result;
}

ValueRange never() { return ValueRange::between(1.0, 0.0); }

ValueRange onlyNan() {
  ValueRange result = never();
  result.nan = true;
  return result;
}

double stored(const Type& type, double value) {
  if (isFloat(type)) return static_cast<double>(static_cast<float>(value));
  if (!isInteger(type) || !(std::abs(value) < 9e15)) return value;
  const auto size = std::int64_t{1} << type.width;
  std::int64_t bits = static_cast<std::int64_t>(value) & (size - 1);
  if (type.isSigned && bits >= size / 2) bits -= size;
  return static_cast<double>(bits);
}

ValueRange fitted(const Type& type, ValueRange range) {
  if (range.empty()) return range;
  if (range.values.size() == 1 && range.min == range.max) range.occurrence = Occurrence::each;
  if (!isInteger(type)) return range;
  if (range.min < lowest(type) || range.max > highest(type)) {
    const std::uint32_t ones = range.ones, zeros = range.zeros;
    range = rangeOf(type);
    range.ones = ones, range.zeros = zeros;
  }
  if (!range.values.empty()) {
    range.ones = ~0u, range.zeros = ~0u;
    for (const double v : range.values) range.ones &= bitsOf(v), range.zeros &= ~bitsOf(v);
    return range;
  }
  if (range.min >= 0.0) {
    std::uint32_t above = 0xFFFFFFFFu;
    for (std::uint32_t high = bitsOf(range.max); high != 0; high >>= 1) above <<= 1;
    range.zeros |= above;
    const double least = range.ones, most = static_cast<double>(~range.zeros);
    if (range.min < least || range.max > most) range.occurrence = Occurrence::unknown;
    range.min = std::max(range.min, least), range.max = std::min(range.max, most);
  }
  if (range.min == range.max) range.values = {range.min}, range.occurrence = Occurrence::each;
  return range;
}

ValueRange joined(const ValueRange& a, const ValueRange& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  if (a.onlyNan() || b.onlyNan()) {
    ValueRange other = a.onlyNan() ? b : a;
    other.nan = true, other.occurrence = Occurrence::unknown;
    return other;
  }
  ValueRange result = ValueRange::between(std::min(a.min, b.min), std::max(a.max, b.max));
  result.nan = a.nan || b.nan;
  result.ones = a.ones & b.ones, result.zeros = a.zeros & b.zeros;
  if (a.values.empty() || b.values.empty()) return result;
  std::vector<double> all;
  std::ranges::set_union(a.values, b.values, std::back_inserter(all));
  if (all.size() <= ValueRange::kMaxValues) result.values = std::move(all);
  return result;
}

ValueRange limited(ValueRange range, double min, double max) {
  if (range.onlyNan()) return never();
  range.nan = false;
  if (range.min >= min && range.max <= max) return range;
  range.min = std::max(range.min, min), range.max = std::min(range.max, max);
  const bool known = !range.values.empty();
  std::erase_if(range.values, [&](double v) { return v < min || v > max; });
  if (range.min > range.max || (known && range.values.empty())) return never();
  if (!range.values.empty()) range.min = range.values.front(), range.max = range.values.back();
  if (range.occurrence == Occurrence::many && range.min < range.max && range.values.empty() && max < kInf)
    range.occurrence = Occurrence::unknown;
  if (range.occurrence == Occurrence::each) range.occurrence = Occurrence::unknown;
  return range;
}

ValueRange binary(const Type& type, Op op, const ValueRange& a, const ValueRange& b) {
  switch (op) {
    case Op::OpIAdd:
    case Op::OpFAdd:
      return combine(
          type, a, b, [](double x, double y) { return x + y; },
          [](auto& l, auto& r) {
            return Pair{l.min + r.min, l.max + r.max};
          },
          Keeps::many);
    case Op::OpISub:
    case Op::OpFSub:
      return combine(
          type, a, b, [](double x, double y) { return x - y; },
          [](auto& l, auto& r) {
            return Pair{l.min - r.max, l.max - r.min};
          },
          b.values.size() == 1 ? Keeps::many : Keeps::each);
    case Op::OpIMul: {
      const auto exact = [](double x, double y) -> std::optional<double> {
        return std::abs(x * y) < 9e15 ? std::optional(x * y) : std::nullopt;
      };
      return combine(type, a, b, exact, productHull, Keeps::each);
    }
    case Op::OpFMul:
      return combine(
          type, a, b, [](double x, double y) { return x * y; }, productHull, Keeps::nothing);
    case Op::OpFDiv: {
      // Quotients that a float cannot hold have an error.
      const auto exact = [&](double x, double y) {
        return y != 0.0 && stored(type, x / y) * y == x ? std::optional(x / y) : std::nullopt;
      };
      const auto hull = [](const ValueRange& l, const ValueRange& r) -> std::optional<Pair> {
        if (r.min <= 0.0 && r.max >= 0.0) return {};
        const double all[] = {l.min / r.min, l.min / r.max, l.max / r.min, l.max / r.max};
        const double low = *std::ranges::min_element(all), high = *std::ranges::max_element(all);
        return Pair{low - std::abs(low) * kRangeError, high + std::abs(high) * kRangeError};
      };
      return combine(type, a, b, exact, hull, Keeps::nothing);
    }
    case Op::OpUDiv:
    case Op::OpSDiv: {
      const auto exact = [](double x, double y) { return y != 0.0 ? std::optional(std::trunc(x / y)) : std::nullopt; };
      const auto hull = [](const ValueRange& l, const ValueRange& r) -> std::optional<Pair> {
        if (r.min <= 0.0 && r.max >= 0.0) return {};
        const double all[] = {l.min / r.min, l.min / r.max, l.max / r.min, l.max / r.max};
        return Pair{std::trunc(*std::ranges::min_element(all)), std::trunc(*std::ranges::max_element(all))};
      };
      return withShorterRuns(combine(type, a, b, exact, hull, Keeps::each), a, b.constant());
    }
    case Op::OpUMod:
    case Op::OpSRem:
    case Op::OpSMod: {
      const std::optional<double> size = b.constant();
      if (size && *size > 0.0 && *size <= a.run && a.min >= 0.0 && a.max >= *size - 1.0 &&
          a.occurrence == Occurrence::many) {
        ValueRange result = ValueRange::between(0.0, *size - 1.0, Occurrence::each);
        if (*size <= ValueRange::kMaxValues)
          for (double v = 0.0; v < *size; ++v) result.values.push_back(v);
        return fitted(type, std::move(result));
      }
      const auto exact = [op](double x, double y) -> std::optional<double> {
        if (y <= 0.0) return {};
        const double rest = std::fmod(x, y);
        return op == Op::OpSMod && rest < 0.0 ? rest + y : rest;
      };
      const auto hull = [op](const ValueRange& l, const ValueRange& r) -> std::optional<Pair> {
        if (r.min <= 0.0) return {};
        if (l.min >= 0.0 && l.max < r.min) return Pair{l.min, l.max};
        const double least = l.min >= 0.0 || op == Op::OpSMod ? 0.0 : 1.0 - r.max;
        return Pair{least, l.min >= 0.0 ? std::min(l.max, r.max - 1.0) : r.max - 1.0};
      };
      return combine(type, a, b, exact, hull, Keeps::nothing);
    }
    case Op::OpFMod: {
      const auto exact = [&](double x, double y) {
        const double rest = x - y * std::floor(x / y);
        return y != 0.0 && stored(type, x / y) * y == x ? std::optional(rest) : std::nullopt;
      };
      const auto hull = [](const ValueRange& l, const ValueRange& r) -> std::optional<Pair> {
        const double largest = std::max(std::abs(l.min), std::abs(l.max));
        if (r.min <= 0.0 || largest / r.min > std::numeric_limits<float>::max()) return {};
        const double error = std::max(largest, r.max) * kRangeError;
        return Pair{-error, r.max + error};
      };
      return combine(type, a, b, exact, hull, Keeps::nothing);
    }
    default: return rangeOf(type);
  }
}

ValueRange bitwise(const Type& type, Op op, const ValueRange& a, const ValueRange& b) {
  if (!isInteger(type)) return rangeOf(type);
  const auto shiftOf = [](const ValueRange& range) -> std::optional<int> {
    const std::optional<double> by = range.constant();
    return by && *by >= 0.0 && *by < 32.0 ? std::optional(static_cast<int>(*by)) : std::nullopt;
  };
  const std::uint32_t mask = type.width == 32 ? ~0u : (1u << type.width) - 1u;
  const auto exact = [&](double x, double y) -> std::optional<double> {
    const std::uint32_t l = bitsOf(x), r = bitsOf(y);
    switch (op) {
      case Op::OpBitwiseAnd: return l & r;
      case Op::OpBitwiseOr: return l | r;
      case Op::OpBitwiseXor: return l ^ r;
      case Op::OpShiftLeftLogical: return r < type.width ? std::optional<double>(l << r) : std::nullopt;
      case Op::OpShiftRightLogical: return r < type.width ? std::optional<double>((l & mask) >> r) : std::nullopt;
      case Op::OpShiftRightArithmetic:
        return r < type.width ? std::optional<double>(std::floor(std::ldexp(x, -static_cast<int>(r)))) : std::nullopt;
      default: return {};
    }
  };
  const std::optional<double> constant = b.constant() ? b.constant() : a.constant();
  if (op == Op::OpBitwiseAnd && constant && *constant >= 0.0) {
    const ValueRange& other = b.constant() ? a : b;
    const std::uint32_t bits = bitsOf(*constant);
    if (other.occurrence == Occurrence::many && other.min >= 0.0 && other.max >= *constant && *constant < other.run &&
        (bits & (bits + 1)) == 0) {
      ValueRange result = ValueRange::between(0.0, *constant, Occurrence::each);
      if (*constant < ValueRange::kMaxValues)
        for (double v = 0.0; v <= *constant; ++v) result.values.push_back(v);
      return fitted(type, std::move(result));
    }
  }
  const auto hull = [&](const ValueRange& l, const ValueRange& r) -> std::optional<Pair> {
    const std::optional<int> shift = shiftOf(r);
    switch (op) {
      case Op::OpBitwiseAnd:
        if (l.min >= 0.0 && r.min >= 0.0) return Pair{0.0, std::min(l.max, r.max)};
        if (l.min >= 0.0) return Pair{0.0, l.max};
        if (r.min >= 0.0) return Pair{0.0, r.max};
        return {};
      case Op::OpBitwiseOr:
        if (l.min >= 0.0 && r.min >= 0.0 && !type.isSigned) return Pair{std::max(l.min, r.min), highest(type)};
        return {};
      case Op::OpShiftLeftLogical:
        if (!shift || l.min < 0.0) return {};
        return Pair{std::ldexp(l.min, *shift), std::ldexp(l.max, *shift)};
      case Op::OpShiftRightLogical:
        if (!shift || l.min < 0.0) return {};
        return Pair{std::floor(std::ldexp(l.min, -*shift)), std::floor(std::ldexp(l.max, -*shift))};
      case Op::OpShiftRightArithmetic:
        if (!shift) return {};
        return Pair{std::floor(std::ldexp(l.min, -*shift)), std::floor(std::ldexp(l.max, -*shift))};
      default: return {};
    }
  };
  const bool shifts = op != Op::OpBitwiseAnd && op != Op::OpBitwiseOr && op != Op::OpBitwiseXor;
  ValueRange result = combine(type, a, b, exact, hull, shifts ? Keeps::each : Keeps::nothing);
  if (shifts && op != Op::OpShiftLeftLogical)
    if (const std::optional<int> shift = shiftOf(b)) result = withShorterRuns(result, a, std::ldexp(1.0, *shift));
  if (!result.values.empty()) return result;
  if (op == Op::OpBitwiseAnd) result.ones |= a.ones & b.ones, result.zeros |= a.zeros | b.zeros;
  if (op == Op::OpBitwiseOr) result.ones |= a.ones | b.ones, result.zeros |= a.zeros & b.zeros;
  if (op == Op::OpShiftLeftLogical && type.width == 32)
    if (const std::optional<int> shift = shiftOf(b))
      result.ones |= a.ones << *shift, result.zeros |= (a.zeros << *shift) | ((1u << *shift) - 1u);
  return fitted(type, std::move(result));
}

ValueRange truth(std::optional<bool> value) {
  return value ? ValueRange::of(*value ? 1.0 : 0.0) : ValueRange::between(0.0, 1.0);
}

ValueRange compared(const Comparison& comparison, const ValueRange& a, const ValueRange& b) {
  if (a.onlyNan() || b.onlyNan()) return truth(comparison.unordered);
  const std::optional<bool> result = decided(comparison.relation, a, b);
  if (result && (a.nan || b.nan) && *result != comparison.unordered) return truth({});
  return truth(result);
}

ValueRange mapped(const Type& type, const ValueRange& a, double (*f)(double)) {
  if (a.onlyNan()) return a;
  ValueRange result = a;
  result.ones = result.zeros = 0;
  result.min = f(a.min), result.max = f(a.max);
  std::set<double> values;
  for (const double v : a.values) values.insert(f(v) + 0.0);
  result.values.assign(values.begin(), values.end());
  return fitted(type, std::move(result));
}

ValueRange signOf(const Type& type, const ValueRange& a) {
  ValueRange result = mapped(type, a, [](double v) { return v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0; });
  if (result.occurrence == Occurrence::many) result.occurrence = Occurrence::unknown;
  return result;
}

ValueRange magnitude(const Type& type, const ValueRange& a) {
  if (a.onlyNan()) return a;
  ValueRange result = ValueRange::between(a.min > 0.0   ? a.min
                                          : a.max < 0.0 ? -a.max
                                                        : 0.0,
                                          std::max(std::abs(a.min), std::abs(a.max)));
  result.nan = a.nan;
  std::set<double> values;
  for (const double v : a.values) values.insert(std::abs(v));
  result.values.assign(values.begin(), values.end());
  if (!values.empty()) result.occurrence = a.occurrence;
  return fitted(type, std::move(result));
}

ValueRange chosen(const Type& type, const ValueRange& a, const ValueRange& b, bool larger) {
  if (a.nan || b.nan) return joined(a, b);
  const auto pick = [larger](double x, double y) { return larger ? std::max(x, y) : std::min(x, y); };
  const auto hull = [&](const ValueRange& l, const ValueRange& r) {
    return std::optional(Pair{pick(l.min, r.min), pick(l.max, r.max)});
  };
  return combine(
      type, a, b, [&](double x, double y) { return std::optional(pick(x, y)); }, hull, Keeps::each);
}

ValueRange clamped(const Type& type, ValueRange a, const ValueRange& low, const ValueRange& high) {
  if (low.nan || high.nan) return rangeOf(type);
  if (a.nan) {  // clamp(NaN) gives one of the limits in practice; all values between them are assumed
    a.nan = false;
    return fitted(type, ValueRange::between(std::min(low.min, high.min), std::max(low.max, high.max)));
  }
  return chosen(type, chosen(type, a, low, true), high, false);
}

}  // namespace quintet::spirv

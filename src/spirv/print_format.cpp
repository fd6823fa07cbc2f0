// SPDX-License-Identifier: Apache-2.0
#include "spirv/print_format.h"

#include <fmt/printf.h>

#include <bit>
#include <utility>

#include "base/error.h"
#include "base/plural.h"

namespace quintet::spirv {
namespace {

using ArgumentKind = PrintArgument::Kind;

constexpr std::string_view kFlags = "-+ #0";
constexpr std::string_view kIntegers = "diouxXc";
constexpr std::string_view kFloats = "fFeEgGaA";
constexpr std::size_t kMaxNumber = 100;  // of width and precision: a line is not longer than a few screens

// A specifier as it is written, before it is known whether it fits to its argument.
struct Parsed {
  std::string text;         // "%5.2v3f"
  std::string flags;        // "5.2", with width and precision
  std::uint32_t count = 1;  // of components
  bool isLong = false;      // with l
  bool canBeLong = false;   // an l follows the conversion, which belongs to it if the argument has 64 bits
  char conversion = 0;
};

class Reader {
 public:
  explicit Reader(std::string_view format) : format_(format) {}
  bool atEnd() const { return at_ >= format_.size(); }
  // Text up to the next specifier, with "%%" as "%".
  std::string literal();
  Parsed specifier();
  void skip() { ++at_; }

 private:
  char peek() const { return atEnd() ? '\0' : format_[at_]; }
  std::string number(std::string_view what);

  std::string_view format_;
  std::size_t at_ = 0;
};

std::string Reader::literal() {
  std::string text;
  while (!atEnd()) {
    if (format_[at_] != '%') {
      text += format_[at_++];
    } else if (format_.substr(at_, 2) == "%%") {
      text += '%';
      at_ += 2;
    } else {
      break;
    }
  }
  return text;
}

std::string Reader::number(std::string_view what) {
  std::string digits;
  while (peek() >= '0' && peek() <= '9') digits += format_[at_++];
  if (digits.size() > 3 || (!digits.empty() && std::stoul(digits) > kMaxNumber))
    throw Error(fmt::format("the {} {} of a specifier is larger than {}", what, digits, kMaxNumber));
  return digits;
}

Parsed Reader::specifier() {
  const std::size_t begin = at_++;
  Parsed parsed;
  while (!atEnd() && kFlags.find(peek()) != kFlags.npos) parsed.flags += format_[at_++];
  if (peek() == '*') throw Error("the width * of a specifier is not supported; write a number");
  parsed.flags += number("width");
  if (peek() == '.') {
    ++at_;
    parsed.flags += "." + number("precision");
  }
  if (peek() == 'v') {
    ++at_;
    const char count = peek();
    if (count < '2' || count > '4') throw Error("v in a specifier must be followed by 2, 3 or 4, as in %v3f");
    parsed.count = static_cast<std::uint32_t>(count - '0');
    ++at_;
  }
  if (peek() == 'l') {
    parsed.isLong = true;
    ++at_;
  }
  parsed.conversion = peek();
  if (parsed.conversion == 0)
    throw Error(fmt::format("the specifier {} at the end of the format is incomplete; write %% for a percent sign",
                            format_.substr(begin)));
  ++at_;
  parsed.text = format_.substr(begin, at_ - begin);
  if (kIntegers.find(parsed.conversion) == kIntegers.npos && kFloats.find(parsed.conversion) == kFloats.npos)
    throw Error(
        fmt::format("the specifier {} is unknown; debugPrintfEXT supports %d %i %u %o %x %X %c %f %e %g %a, with "
                    "l for 64 bits and v2 to v4 for vectors",
                    parsed.text));
  parsed.canBeLong = !parsed.isLong && peek() == 'l';
  return parsed;
}

// The specifier that prints an argument.
std::string specifierFor(const PrintArgument& argument) {
  return fmt::format("%{}{}{}", argument.count > 1 ? fmt::format("v{}", argument.count) : "",
                     argument.kind == ArgumentKind::integer && argument.bits == 64 ? "l" : "",
                     argument.kind == ArgumentKind::floating                        ? "f"
                     : argument.kind == ArgumentKind::boolean || !argument.isSigned ? "u"
                                                                                    : "d");
}

// True if the specifier prints the argument. It sets isLong for "%ul".
bool fits(Parsed& parsed, const PrintArgument& argument) {
  if (parsed.count != argument.count) return false;
  const bool isFloat = kFloats.find(parsed.conversion) != kFloats.npos;
  if (isFloat) return argument.kind == ArgumentKind::floating;
  if (argument.kind != ArgumentKind::integer && argument.kind != ArgumentKind::boolean) return false;
  const bool needsLong = argument.bits == 64;
  if (needsLong && parsed.canBeLong) parsed.isLong = true;
  return parsed.isLong == needsLong && (parsed.conversion != 'c' || !needsLong);
}

std::uint64_t rawComponent(std::span<const std::uint32_t> words, std::size_t at, bool isLong) {
  const auto word = [&](std::size_t i) { return i < words.size() ? std::uint64_t{words[i]} : 0u; };
  return isLong ? word(at) | word(at + 1) << 32 : word(at);
}

std::string componentText(const std::string& format, char conversion, const PrintArgument& argument,
                          std::uint64_t raw) {
  if (argument.kind == ArgumentKind::floating)
    return fmt::sprintf(format, argument.bits == 64 ? std::bit_cast<double>(raw)
                                                    : double{std::bit_cast<float>(static_cast<std::uint32_t>(raw))});
  if (conversion == 'c') {
    const bool isPrintable = raw >= 0x20 && raw < 0x7F;
    return fmt::sprintf(format, isPrintable ? static_cast<char>(raw) : '?');
  }
  const bool asSigned = conversion == 'd' || conversion == 'i';
  if (argument.bits == 64) {
    if (asSigned) return fmt::sprintf(format, static_cast<long long>(raw));
    return fmt::sprintf(format, static_cast<unsigned long long>(raw));
  }
  if (asSigned) return fmt::sprintf(format, static_cast<std::int32_t>(raw));
  return fmt::sprintf(format, static_cast<std::uint32_t>(raw));
}

}  // namespace

PrintFormat::PrintFormat(std::string_view format, const std::vector<PrintArgument>& arguments) {
  Reader reader(format);
  std::vector<Parsed> specifiers;
  std::vector<std::string> literals;
  std::size_t used = 0;
  for (literals.push_back(reader.literal()); !reader.atEnd(); literals.push_back(reader.literal())) {
    Parsed& parsed = specifiers.emplace_back(reader.specifier());
    if (used < arguments.size() && fits(parsed, arguments[used]) && parsed.isLong && parsed.canBeLong) reader.skip();
    ++used;
  }
  if (specifiers.size() != arguments.size())
    throw Error(fmt::format("the format has {}, but the call has {} for it", counted(specifiers.size(), "specifier"),
                            counted(arguments.size(), "argument")));
  for (std::size_t i = 0; i < specifiers.size(); ++i) {
    Parsed& parsed = specifiers[i];
    const PrintArgument& argument = arguments[i];
    if (argument.kind == ArgumentKind::other)
      throw Error(fmt::format("argument {} is {}, which cannot be printed; print its scalars or vectors", i + 1,
                              argument.typeName));
    if (!fits(parsed, argument))
      throw Error(fmt::format("the specifier {} does not match argument {}, which is {}; write for example {}",
                              parsed.text, i + 1, argument.typeName, specifierFor(argument)));
    parts_.emplace_back(std::move(literals[i]));
    parts_.emplace_back(Specifier{fmt::format("%{}{}", parsed.flags, parsed.conversion), parsed.conversion, argument});
    wordCount_ += argument.wordCount();
  }
  parts_.emplace_back(std::move(literals.back()));
}

std::string PrintFormat::text(std::span<const std::uint32_t> words) const {
  std::string result;
  std::size_t at = 0;
  for (const auto& part : parts_) {
    if (const auto* literal = std::get_if<std::string>(&part)) {
      result += *literal;
      continue;
    }
    const Specifier& specifier = std::get<Specifier>(part);
    const PrintArgument& argument = specifier.argument;
    const std::size_t step = argument.wordCount() / argument.count;
    for (std::uint32_t i = 0; i < argument.count; ++i, at += step) {
      if (i > 0) result += ", ";
      result += componentText(specifier.format, specifier.conversion, argument, rawComponent(words, at, step == 2));
    }
  }
  return result;
}

}  // namespace quintet::spirv

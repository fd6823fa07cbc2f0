#include "picture_names.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "base/error.h"

namespace quintet::app {
namespace {

constexpr std::uint32_t kFrameDigits = 4;
constexpr std::uint32_t kMaxDigits = 9;

struct FramePlace {
  std::size_t begin = 0;  // of "%04d"
  std::size_t end = 0;
  std::uint32_t digits = 0;
};

bool isDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

std::optional<FramePlace> findPlace(const std::string& name, std::size_t from) {
  for (std::size_t at = name.find('%', from); at != name.npos; at = name.find('%', at + 1)) {
    FramePlace place{at, at + 1, 0};
    while (place.end < name.size() && isDigit(name[place.end]))
      place.digits = std::min(place.digits * 10 + static_cast<std::uint32_t>(name[place.end++] - '0'), kMaxDigits);
    if (place.end >= name.size() || name[place.end] != 'd') continue;
    ++place.end;
    return place;
  }
  return std::nullopt;
}

}  // namespace

bool hasFramePlace(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  const std::optional<FramePlace> place = findPlace(name, 0);
  if (place && findPlace(name, place->end))
    throw UsageError(fmt::format("{}: one place for the frame's number is enough", file.string()));
  return place.has_value();
}

std::filesystem::path pictureName(const std::filesystem::path& file, const std::string& output,
                                  std::optional<std::uint32_t> frame) {
  std::string name = file.filename().string();
  std::optional<FramePlace> place = frame ? findPlace(name, 0) : std::nullopt;
  if (frame && !place) {
    const std::size_t at = file.stem().string().size();
    name.insert(at, fmt::format(".%0{}d", kFrameDigits));
    place = findPlace(name, at);
  }
  if (place) name.replace(place->begin, place->end - place->begin, fmt::format("{:0{}}", *frame, place->digits));
  if (!output.empty()) {
    // In front of the frame's number and what separates it, so that numbers stay last.
    std::size_t at = place ? place->begin : file.stem().string().size();
    if (at > 0 && place && (name[at - 1] == '.' || name[at - 1] == '_' || name[at - 1] == '-')) --at;
    const char separator = place && at < place->begin ? name[at] : '.';
    name.insert(at, at == 0 ? output + "." : separator + output);
  }
  return file.parent_path() / name;
}

}  // namespace quintet::app

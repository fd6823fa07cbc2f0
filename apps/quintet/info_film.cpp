#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "film_facts.h"
#include "info.h"
#include "values.h"

namespace quintet::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kShown = 100;  // characters of a value

Json factsJson(const render::FilmFacts& facts) {
  Json json = Json::object();
  for (const auto& [name, value] : facts) json[name] = value;
  return json;
}

// Samples per pixel that are there, and those of the last decision.
Json adaptiveJson(const render::FilmFile& film) {
  Json json{{"average", render::averageSamples(film.film.region, film.film.counts)}, {"planned", nullptr}};
  render::SampleCounts planned = film.film.counts;
  planned.cellBatches = film.plan;
  if (!film.plan.empty()) json["planned"] = render::averageSamples(film.film.region, planned);
  return json;
}

std::string factsText(const render::FilmFacts& facts) {
  std::string text;
  for (const auto& [name, value] : facts) {
    if (value.empty()) continue;
    text +=
        fmt::format("   {:<25} {}{}\n", plain(name), plain(value.substr(0, kShown)), value.size() > kShown ? " …" : "");
  }
  return text;
}

// Without what the program says of outputs that this film does not hold.
render::FilmFacts ownNotes(const render::FilmFile& film) {
  render::FilmFacts notes = film.notes;
  for (const render::FilmPlane& plane : film.film.planes)
    if (!plane.stored())
      std::erase_if(notes, [&](const auto& note) {
        return note.first == "kind of " + plane.name || note.first == "colour in " + plane.name;
      });
  return notes;
}

}  // namespace

std::string filmInfo(const std::filesystem::path& file, std::span<const std::byte> bytes, bool json) {
  const render::FilmFile film = render::decodeFilm(bytes, file);
  const render::Region& region = film.film.region;
  if (json) {
    Json samples = Json::array();
    for (const render::SampleRange& range : film.film.counts.ranges) samples.push_back({range.begin, range.end});
    Json result{{"file", file.string()},
                {"kind", "film"},
                {"width", region.width},
                {"height", region.height},
                {"samples", samples},
                {"bytes", bytes.size()},
                {"identity", factsJson(film.identity)},
                {"notes", factsJson(film.notes)}};
    if (isAdaptive(film)) result["adaptive"] = adaptiveJson(film);
    return result.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  }
  const std::optional<std::uint64_t> planned = plannedSamples(film);
  return fmt::format("{}: film, {}x{}, {}{}, {}\n", plain(file.string()), region.width, region.height,
                     samplesText(film), planned ? fmt::format(" of {}", *planned) : "", bytesText(bytes.size())) +
         factsText(film.identity) + factsText(ownNotes(film));
}

}  // namespace quintet::app

// SPDX-License-Identifier: Apache-2.0
// Why does a pixel have its value? Prints the rays of one sample with what they hit, and the light that they contribute;
// then searches the image for samples that are not finite and for fireflies. Usage: explain_pixel [SCENE]; writes
// explain_pixel.json.
#include <cstdio>
#include <exception>
#include <fstream>

#include <quintet/quintet.h>

namespace {

void printEvents(const std::vector<quintet::Event>& events, int indent = 0) {
  for (const quintet::Event& event : events) {
    const auto* distance = event.get<float>("t");  // of hits, meters
    const auto* name = event.get<std::string>("instanceName");
    const auto* lobe = event.get<std::string>("lobe");  // of samples of the BSDF
    std::printf("%*s%s", indent, "", event.type.c_str());
    if (name) std::printf(" on '%s'", name->c_str());
    if (distance) std::printf(" at %.3f m", static_cast<double>(*distance));
    if (lobe) std::printf(" of the %s lobe", lobe->c_str());
    std::puts("");
    printEvents(event.children, indent + 2);
  }
}

}  // namespace

int main(int count, char** arguments) try {
  const quintet::Program program = quintet::Program::load("pathtracer");
  const quintet::Scene scene = count > 1 ? quintet::Scene::load(arguments[1]) : quintet::Scene::of(program);
  quintet::prepareDrivers();  // before the process has other threads
  quintet::Device device;
  quintet::Renderer renderer(device, scene, program, {.width = 240, .height = 160, .plannedSamples = 64});

  const quintet::Explanation explanation = renderer.explain(120, 100);  // sample 0 of this pixel
  printEvents(explanation.events);
  for (const quintet::Contribution& c : explanation.contributions)
    std::printf("%s: %g %g %g\n", c.source.c_str(), static_cast<double>(c.value[0]), static_cast<double>(c.value[1]),
                static_cast<double>(c.value[2]));
  std::ofstream("explain_pixel.json") << explanation.json;

  const quintet::SearchReport report = renderer.search({.samples = 8});
  std::printf("%llu samples are not finite, %llu are fireflies\n",
              static_cast<unsigned long long>(report.notFiniteCount),
              static_cast<unsigned long long>(report.fireflyCount));
  for (const quintet::FoundSample& found : report.fireflies)
    std::printf("pixel %u,%u, sample %u: %s lobe of '%s'\n", found.x, found.y, found.sample, found.lobe.c_str(),
                found.material.c_str());
} catch (const std::exception& error) {
  return std::fprintf(stderr, "explain_pixel: %s\n", error.what()), 1;
}

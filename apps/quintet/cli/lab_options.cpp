// SPDX-License-Identifier: Apache-2.0
#include "cli/lab_options.h"

#include "base/error.h"
#include "cli/candidates.h"
#include "cli/parser.h"
#include "cli/values.h"

#include <fmt/format.h>

namespace quintet::cli {

OptionTable labOptionTable(LabOptions& options, LabTexts& texts) {
  OptionTable table("lab",
                    "Opens the lab in a browser: editors for shaders beside a live image, and the lessons as a course. "
                    "Starts the server quintet-lab, prints its URL and opens it.");
  table.add(
      {{.names = "TARGET",
        .help = "Folder with programs, program, or scene file (default: the folder quintet-lab, which is created)",
        .target = &options.target,
        .candidates = programOrSceneCandidates()}});
  table.add("Server",
            {{.names = "--port",
              .value = "N",
              .help = fmt::format("Port of the server; 0 is any free one (default: {}, or a free one if it is in use)",
                                  kLabPort),
              .target = &texts.port},
             {.names = "--bind",
              .value = "ADDRESS",
              .help = "IP address to which the server listens (default: 127.0.0.1, only this machine)",
              .target = &options.bind},
             {.names = "--no-open", .help = "Print the URL, but start no browser", .target = &options.noOpen},
             {.names = "--sessions",
              .value = "N",
              .help = "Number of pages that can be open at a time, each with a process (default: 16)",
              .target = &texts.sessions},
             {.names = "--idle",
              .value = "SECONDS",
              .help = "Time without a command after which the process of a page ends (default: 600)",
              .target = &texts.idle},
             {.names = "--max-memory",
              .value = "BYTES",
              .help = "Memory that the process of a page can use: 8G, 500M (default: half of the machine's)",
              .target = &texts.maxMemory},
             {.names = "--no-sandbox",
              .help = "Do not restrict what shaders of a CPU device can reach: for drivers in unusual folders",
              .target = &options.noSandbox}});
  table.add("Image", {{.names = "--size",
                       .value = "WxH",
                       .help = "Size of a new image, pixels (default: 640x360)",
                       .target = &texts.size},
                      {.names = "--spp",
                       .value = "N",
                       .help = "Number of samples per pixel that an image reaches (default: 64)",
                       .target = &texts.samples}});
  table.add("Run", {{.names = "--device",
                     .value = "NAME",
                     .help = fmt::format("{}: 0, h200, lavapipe, cpu, gpu", kDeviceHelp),
                     .target = &options.device,
                     .candidates = {.names = deviceNames()}},
                    {.names = "--timeout",
                     .value = "SECONDS",
                     .help = "Time limit of one launch, after which a shader counts as endless (default: 30)",
                     .target = &texts.timeout}});
  table.addExamples({
      {"quintet lab", "the lessons; copies of them are stored in the folder quintet-lab"},
      {"quintet lab my_program"},
      {"quintet lab scene.glb --port 8080 --no-open", "on a server; docs/lab.md shows how to reach it through SSH"},
  });
  return table;
}

std::optional<LabOptions> parseLabOptions(Arguments arguments) {
  LabOptions options;
  LabTexts texts;
  if (!parse(labOptionTable(options, texts), arguments)) return std::nullopt;
  if (const auto port = parseInteger("--port", texts.port, 0, 65535)) options.port = static_cast<std::uint16_t>(*port);
  options.maxMemory = parseBytes("--max-memory", texts.maxMemory).value_or(0);
  options.timeout = parseReal("--timeout", texts.timeout, 0.1, 86400).value_or(options.timeout);
  options.idle = parseReal("--idle", texts.idle, 1, 1e6).value_or(options.idle);
  if (const auto samples = parseInteger("--spp", texts.samples, 1, 1 << 24))
    options.samples = static_cast<std::uint32_t>(*samples);
  if (const auto sessions = parseInteger("--sessions", texts.sessions, 1, 1000))
    options.sessions = static_cast<std::uint32_t>(*sessions);
  if (!texts.size.empty()) options.size = parseSize("--size", texts.size);
  constexpr std::uint32_t kMaxSide = 4096;
  if (options.size.x > kMaxSide || options.size.y > kMaxSide || options.size.x == 0 || options.size.y == 0)
    throw UsageError(fmt::format("--size: '{}' must have two sides of at most {} pixels", texts.size, kMaxSide));
  return options;
}

}  // namespace quintet::cli

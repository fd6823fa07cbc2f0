// SPDX-License-Identifier: Apache-2.0
#include "cli/failure.h"

#include <algorithm>
#include <new>

#include "base/diagnostic.h"
#include "base/file.h"
#include "base/text.h"
#include "check/diagnostic_text.h"
#include "cli/console.h"
#include "farm/plan.h"
#include "output/report.h"

namespace quintet::cli {

std::string optionHint(Remedy remedy) {
  switch (remedy) {
    case Remedy::none: break;
    case Remedy::overwrite: return "; use --force to overwrite it";
    case Remedy::startOver: return "; use --force to start over";
    case Remedy::resumeOrStartOver: return "; use --resume to continue or --force to start over";
    case Remedy::renderRegion: return "; render a part of it with --region";
    case Remedy::selectLayer: return "; select it as a layer with --aov";
    case Remedy::allowDifference: return "; --may-differ NAME allows a difference";
    case Remedy::measureLaunches:
      return "; --profile measures all scenes, and 'quintet bench PROGRAM SCENE' the launches of the program";
    case Remedy::raiseMemoryLimit: return "; --max-memory raises it";
    case Remedy::allowExternal: return "; --allow-external permits it";
    case Remedy::omitTextures: return "; --missing-textures warn renders without it";
  }
  return "";
}

FailureJson failureJson(std::span<const std::string> arguments) {
  const auto end = std::ranges::find(arguments, "--");
  if (std::find(arguments.begin(), end, "--json") == end) return FailureJson::none;
  return arguments.front() == "check" ? FailureJson::diagnostics : FailureJson::object;
}

int printFailure(std::string message, int status) {
  std::ranges::replace(message, '\n', ' ');
  printMessage("quintet: " + printable(message));
  return status;
}

int failureStatus(const std::exception& error) {
  if (dynamic_cast<const UsageError*>(&error)) return kWrongCommandLine;
  return dynamic_cast<const farm::VersionError*>(&error) ? kWrongVersion : kRuntimeError;
}

int reportFailure(const std::exception& error, FailureJson json, const std::string& hint,
                  const std::filesystem::path& scene) {
  const int status = failureStatus(error);
  const bool memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
  std::string message = memory ? "out of memory" : error.what();
  if (const auto* ours = dynamic_cast<const Error*>(&error)) message += optionHint(ours->remedy());
  if (!memory) message += hint;
  if (message.find(scene.filename().string()) == message.npos) message = scene.string() + ": " + message;
  const auto* file = dynamic_cast<const FileError*>(&error);
  if (json == FailureJson::object)
    printFailureJson(output::errorJson(message, file, status, scene.string()));
  else if (json == FailureJson::diagnostics)
    printFailureJson(check::diagnosticsJson({file ? asDiagnostic(*file) : Diagnostic{.text = message}}));
  return printFailure(message, status);
}

}  // namespace quintet::cli

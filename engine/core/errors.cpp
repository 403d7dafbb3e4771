#include "mallow/errors.h"

#include <utility>

namespace mallow {
namespace {

std::string join(const std::vector<Problem>& problems) {
  std::string text;
  for (const Problem& problem : problems) {
    if (!text.empty()) text += '\n';
    text += to_string(problem);
  }
  return text;
}

}  // namespace

std::string to_string(const Problem& problem) {
  std::string place = problem.file;
  if (problem.line > 0) {
    if (!place.empty()) place += ':';
    place += std::to_string(problem.line);
    if (problem.column > 0) place.append(1, ':').append(std::to_string(problem.column));
  }
  std::string text;
  for (const std::string* part : {&std::as_const(place), &problem.field, &problem.message}) {
    if (part->empty()) continue;
    if (!text.empty()) text += ": ";
    text += *part;
  }
  // Names and values from files are in it: none may write to a terminal what is no text.
  for (char& c : text)
    if ((static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') || c == 0x7f) c = '?';
  return text;
}

ConfigError::ConfigError(std::vector<Problem> problems)
    : Error(join(problems)), problems_(std::move(problems)) {}

ConfigError::ConfigError(std::string field, std::string message)
    : ConfigError(std::vector<Problem>{{.field = std::move(field), .message = std::move(message)}}) {}

IoError::IoError(Problem problem) : Error(to_string(problem)), problem_(std::move(problem)) {}

StepError::StepError(const std::string& message, ParticleId particle_id, Phase phase)
    : Error(message), particle_id_(particle_id), phase_(phase) {}

}  // namespace mallow

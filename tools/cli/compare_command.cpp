#include "cli/compare_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/messages.h"
#include "mallow/errors.h"
#include "mallow/files.h"
#include "program/compare.h"
#include "program/difference_picture.h"
#include "program/failure.h"
#include "program/input_files.h"
#include "program/machine.h"
#include "program/output_files.h"
#include "program/threads_option.h"

namespace mallow::cli {
namespace {

struct CompareOptions {
  std::string a, b;
  std::string tolerance;
  std::optional<float> spacing;
  std::string csv, picture;
  bool json = false;
  int threads = 0;
  bool overwrite = false;
};

/// Two runs or states, frame by frame.
struct Comparison {
  std::vector<program::FrameDifference> frames;
  std::vector<int> only_a, only_b;  ///< frames
  std::size_t surfaces = 0;         ///< frames of which both have one
  std::string other_bodies;         ///< why ids are not of the same particles; mostly empty

  bool same_bits() const {
    return only_a.empty() && only_b.empty() &&
           std::ranges::none_of(frames, &program::FrameDifference::differs);
  }
  const program::FrameDifference* first_that_differs() const {
    const auto first = std::ranges::find_if(frames, &program::FrameDifference::differs);
    return first == frames.end() ? nullptr : &*first;
  }
  /// Where particles are farthest apart.
  const program::FrameDifference& worst() const {
    return *std::ranges::max_element(frames, {}, &program::FrameDifference::largest);
  }
};

/// "0.1h" or "0.1": in spacings. Nothing where it is not given.
std::optional<double> tolerance_of(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const std::string number = text.ends_with('h') ? text.substr(0, text.size() - 1) : text;
  double value = -1;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error != std::errc() || end != number.data() + number.size() || !std::isfinite(value) || value < 0)
    throw ConfigError("--tolerance", "'" + text + "' is not allowed: a number >= 0 of spacings, like 0.1h");
  return value;
}

/// Both know their spacings, from each other or from the user.
void settle_spacings(const CompareOptions& options, program::ComparedStates& a, program::ComparedStates& b) {
  if (options.spacing) {
    std::size_t bodies = std::max<std::size_t>(b.bodies(0).size(), 1);
    for (const std::uint32_t body : a.particles(a.frames().front()).bodies)
      bodies = std::max<std::size_t>(bodies, body + 1);
    a.set_spacing(bodies, *options.spacing);
  } else if (a.bodies(0).empty()) {
    a.take_bodies(b);
  }
  if (a.bodies(0).empty())
    throw ConfigError("--spacing", "is needed, as neither " + a.path().string() + " nor " +
                                       b.path().string() + " tells the distance of particles at rest");
}

Comparison compare(const CompareOptions& options, program::ComparedStates& a, program::ComparedStates& b) {
  if (a.is_run() != b.is_run()) {
    const auto& run = a.is_run() ? a : b;
    const auto& state = a.is_run() ? b : a;
    throw IoError({state.path().string(), 0, 0, "",
                   "is one state and " + run.path().string() +
                       " a run of many frames; compare it with a file of the run's particles/"});
  }
  Comparison comparison;
  std::ranges::set_difference(a.frames(), b.frames(), std::back_inserter(comparison.only_a));
  std::ranges::set_difference(b.frames(), a.frames(), std::back_inserter(comparison.only_b));
  std::vector<int> both;
  std::ranges::set_intersection(a.frames(), b.frames(), std::back_inserter(both));
  if (both.empty())
    throw IoError({b.path().string(), 0, 0, "", "has no frame of the number of one in " + a.path().string()});
  comparison.other_bodies = program::told_of_other_bodies(a, b, both.front());
  settle_spacings(options, a, b);
  const int threads = program::resolve_threads(options.threads);
  for (const int frame : both) {
    comparison.frames.push_back(program::compare_frame(a, b, frame, threads));
    if (comparison.frames.back().surface) ++comparison.surfaces;
  }
  return comparison;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

void write_csv(const std::string& file, const Comparison& comparison, const program::ComparedStates& a) {
  std::string text =
      "frame,time_a [s],time_b [s],same_bits,particles,only_a,only_b,rms [h],largest [h],particle,body,"
      "height [m],kinetic_energy [J],surface_same_bits,surface_rms [h],surface_largest [h]\n";
  for (const program::FrameDifference& frame : comparison.frames) {
    std::string name = a.body_name(frame.body, frame.frame);
    std::ranges::replace(name, ',', ' ');
    std::ranges::replace(name, '"', ' ');
    text += std::to_string(frame.frame) + ',' + number(frame.time_a) + ',' + number(frame.time_b) + ',' +
            (frame.same_bits ? "1" : "0") + ',' + std::to_string(frame.particles) + ',' +
            std::to_string(frame.only_a) + ',' + std::to_string(frame.only_b) + ',' + number(frame.rms) +
            ',' + number(frame.largest) + ',' + std::to_string(frame.particle) + ',' + name + ',' +
            number(frame.height) + ',' + (frame.kinetic_energy ? number(*frame.kinetic_energy) : "") + ',';
    if (frame.surface)
      text += std::string(frame.surface->same_bits ? "1" : "0") + ',' + number(frame.surface->rms) + ',' +
              number(frame.surface->largest) + '\n';
    else
      text += ",,\n";
  }
  write_whole(file, text);
}

nlohmann::ordered_json to_json(const program::FrameDifference& frame, const program::ComparedStates& a) {
  nlohmann::ordered_json json = {{"frame", frame.frame},
                                 {"time_a", frame.time_a},
                                 {"time_b", frame.time_b},
                                 {"same_bits", frame.same_bits},
                                 {"particles", frame.particles},
                                 {"only_a", frame.only_a},
                                 {"only_b", frame.only_b},
                                 {"rms", frame.rms},
                                 {"largest", frame.largest},
                                 {"particle", frame.particle},
                                 {"body", a.body_name(frame.body, frame.frame)},
                                 {"height", frame.height}};
  if (frame.kinetic_energy) json["kinetic_energy"] = *frame.kinetic_energy;
  if (frame.surface)
    json["surface"] = {{"same_bits", frame.surface->same_bits},
                       {"rms", frame.surface->rms},
                       {"largest", frame.surface->largest}};
  return json;
}

void print_json(const Comparison& comparison, const program::ComparedStates& a,
                const program::ComparedStates& b, bool same) {
  nlohmann::ordered_json frames = nlohmann::ordered_json::array();
  for (const program::FrameDifference& frame : comparison.frames) frames.push_back(to_json(frame, a));
  const program::FrameDifference* const first = comparison.first_that_differs();
  const nlohmann::ordered_json json = {
      {"a", a.path().string()},
      {"b", b.path().string()},
      {"same", same},
      {"same_bits", comparison.same_bits()},
      {"first_frame_that_differs", first ? nlohmann::ordered_json(first->frame) : nlohmann::ordered_json()},
      {"frames_only_in_a", comparison.only_a},
      {"frames_only_in_b", comparison.only_b},
      {"frames", frames}};
  std::printf("%s\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
}

void print_frame(const program::FrameDifference& frame, const program::ComparedStates& a) {
  std::printf("%6d %10.5g ", frame.frame, frame.time_a);
  if (!frame.differs()) {
    std::printf("same bits\n");
    return;
  }
  std::printf("%10.3g %10.3g %10llu %-12s %12.3g ", frame.rms, frame.largest,
              static_cast<unsigned long long>(frame.particle), a.body_name(frame.body, frame.frame).c_str(),
              frame.height);
  if (frame.kinetic_energy)
    std::printf("%12.3g ", *frame.kinetic_energy);
  else
    std::printf("%12s ", "-");
  if (!frame.surface)
    std::printf("%12s", "-");
  else if (frame.surface->same_bits)
    std::printf("%12s", "same bits");
  else
    std::printf("%12.3g", frame.surface->largest);
  if (frame.only_a + frame.only_b > 0)
    std::printf("  %zu particles only in A, %zu only in B", frame.only_a, frame.only_b);
  if (frame.time_a != frame.time_b) std::printf("  at %.9g s in B", frame.time_b);
  std::printf("\n");
}

void print_table(const Comparison& comparison, const program::ComparedStates& a) {
  const auto count = [](std::size_t n) { return std::to_string(n) + (n == 1 ? " frame" : " frames"); };
  if (comparison.same_bits()) {
    std::printf("same bits: %s", count(comparison.frames.size()).c_str());
    std::printf(comparison.surfaces > 0 ? ", %zu surfaces\n" : "\n", comparison.surfaces);
    return;
  }
  std::printf("%6s %10s %10s %10s %10s %-12s %12s %12s %12s\n", "frame", "time [s]", "rms [h]", "largest [h]",
              "particle", "body", "height [m]", "kinetic [J]", "surface [h]");
  for (const program::FrameDifference& frame : comparison.frames) print_frame(frame, a);
  if (!comparison.only_a.empty()) std::printf("only in A: %s\n", count(comparison.only_a.size()).c_str());
  if (!comparison.only_b.empty()) std::printf("only in B: %s\n", count(comparison.only_b.size()).c_str());
  if (const auto* first = comparison.first_that_differs()) {
    const program::FrameDifference& worst = comparison.worst();
    std::printf("first frame that differs: %d\nlargest distance: %.3g h in frame %d, particle %llu of %s\n",
                first->frame, worst.largest, worst.frame, static_cast<unsigned long long>(worst.particle),
                a.body_name(worst.body, worst.frame).c_str());
  }
}

void check_picture(const std::string& file) {
  if (file.empty()) return;
  if (std::filesystem::path(file).extension() != ".png")
    throw ConfigError("--picture", "'" + file + "' is not allowed: a file that ends in .png");
  program::check_writable(file);
}

/// Of the frame where particles are farthest apart.
void take_picture(const CompareOptions& options, const Comparison& comparison,
                  const program::ComparedStates& a, const program::ComparedStates& b) {
  const program::FrameDifference& worst = comparison.worst();
  render::write_png(options.picture,
                    program::difference_picture(a, b, worst, program::resolve_threads(options.threads)));
  std::fprintf(stderr, "%s: frame %d of B, from grey (as in A) to red (%.3g h from there)\n",
               options.picture.c_str(), worst.frame, worst.largest);
}

void run(const CompareOptions& options) {
  const std::optional<double> tolerance = tolerance_of(options.tolerance);
  check_picture(options.picture);
  if (!options.csv.empty()) program::check_writable(options.csv);
  program::ComparedStates a(options.a), b(options.b);
  program::InputFiles inputs;
  for (const auto* states : {&a, &b})
    for (const auto& file : states->files()) inputs.add(file);
  if (!options.csv.empty()) inputs.refuse(options.csv, "--csv");
  if (!options.picture.empty()) inputs.refuse(options.picture, "--picture");
  const auto replace = options.overwrite ? program::Replace::overwrite : program::Replace::no;
  program::refuse_to_replace(options.csv, "--csv", replace, [](std::string_view beginning) {
    return beginning.starts_with("frame,time_a [s],time_b [s],same_bits,");
  });
  program::refuse_to_replace(options.picture, "--picture", replace);
  const Comparison comparison = compare(options, a, b);
  print_warning(comparison.other_bodies);
  const bool same_frames = comparison.only_a.empty() && comparison.only_b.empty();
  const bool near =
      tolerance && std::ranges::none_of(comparison.frames, [&](const program::FrameDifference& frame) {
        return frame.is_beyond(*tolerance);
      });
  const bool same = comparison.same_bits() || (near && same_frames);
  if (!options.csv.empty()) write_csv(options.csv, comparison, a);
  if (options.json)
    print_json(comparison, a, b, same);
  else
    print_table(comparison, a);
  if (!options.picture.empty()) take_picture(options, comparison, a, b);
  if (same) return;
  throw program::RunFailure(options.a + " and " + options.b + " differ" +
                            (near        ? ": one has frames that the other lacks"
                             : tolerance ? " by more than " + number(*tolerance) + " spacings"
                                         : ""));
}

}  // namespace

void add_compare_command(CLI::App& app) {
  const auto options = std::make_shared<CompareOptions>();
  CLI::App* command = app.add_subcommand("compare", "Tell how two runs or states differ, frame by frame");
  command
      ->add_option("A", options->a, "The --out folder of a run, a checkpoint, or a frame of particles (.ply)")
      ->required();
  command->add_option("B", options->b, "What to compare it with, of the same kind")->required();
  command
      ->add_option("--tolerance", options->tolerance,
                   "Differences up to so many spacings, of particles and of surfaces, count as none: 0.1h. "
                   "Left out: only the same bits do")
      ->option_text("NUMBERh");
  command
      ->add_option("--spacing", options->spacing, "Spacing of particles [m], where neither A nor B tells it")
      ->check(CLI::PositiveNumber);
  command->add_option("--csv", options->csv, "Write a row for each frame to this CSV file");
  command->add_option("--picture", options->picture,
                      "Write a picture (PNG) of the frame where they differ most: B's particles, from grey "
                      "where A has them to red where they are farthest from there");
  command->add_flag("--overwrite", options->overwrite, "Replace files of --csv and --picture that are there");
  command->add_flag("--json", options->json, "Print JSON in place of a table");
  program::add_threads_option(*command, options->threads);
  command->footer(
      "Distances are between particles of the same id, in spacings h of their body: root mean square, "
      "largest,\n"
      "and the particle where it is largest. Surfaces: the largest distance from a vertex of either to the\n"
      "nearest vertex of the other. Height and kinetic energy: those of B less those of A.\n"
      "Exit codes: 0 same bits or within --tolerance, 1 they differ, 2 the input is wrong.");
  command->callback([options] { run(*options); });
}

}  // namespace mallow::cli

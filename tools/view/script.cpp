#include "view/script.h"

#include <epoxy/gl.h>
// After the loader.
#include <GLFW/glfw3.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>

#include "mallow/errors.h"

namespace mallow::view {
namespace {

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

int key_of(const std::string& name) {
  static const std::map<std::string, int> k_names = {
      {"space", GLFW_KEY_SPACE},    {"backspace", GLFW_KEY_BACKSPACE}, {"tab", GLFW_KEY_TAB},
      {"escape", GLFW_KEY_ESCAPE},  {"home", GLFW_KEY_HOME},           {".", GLFW_KEY_PERIOD},
      {"[", GLFW_KEY_LEFT_BRACKET}, {"]", GLFW_KEY_RIGHT_BRACKET},     {"=", GLFW_KEY_EQUAL}};
  if (const auto found = k_names.find(name); found != k_names.end()) return found->second;
  if (name.size() == 1 && name[0] >= 'a' && name[0] <= 'z') return GLFW_KEY_A + (name[0] - 'a');
  if (name.size() == 1 && name[0] >= '0' && name[0] <= '9') return GLFW_KEY_0 + (name[0] - '0');
  throw ConfigError("script", "there is no key '" + name + "'");
}

std::uint64_t pictures_of(const FilmRecorder* film) {
  return film ? static_cast<std::uint64_t>(film->frames()) : 0;
}

/// In the middle of what is drawn of bodies [m].
Vec3 center_of(const Frame& frame) {
  const std::vector<Vec3>& points = frame.positions.empty() ? frame.mesh.vertices : frame.positions;
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : points) sum += x;
  return points.empty() ? sum : Vec3(sum / static_cast<float>(points.size()));
}

}  // namespace

Script::Script(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw IoError({file.string(), 0, 0, "", "cannot be read"});
  for (std::string line; std::getline(in, line);)
    if (!line.empty() && line[0] != '#') lines_.push_back(line);
}

bool Script::advance(Viewer& viewer) {
  if (!waiting_.empty() && !is_done(viewer)) return true;
  waiting_.clear();
  if (lines_.empty()) return false;
  std::istringstream in(lines_.front());
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  lines_.pop_front();
  started_ = wall_seconds();
  begin(viewer, std::move(words));
  return true;
}

void Script::begin(Viewer& viewer, std::vector<std::string> words) {
  const std::string what = words.at(0);
  words.resize(3);
  const auto number = [&](std::size_t k) { return words[k].empty() ? 0.0f : std::stof(words[k]); };
  Window& window = viewer.window();
  if (what == "frames" || what == "pictures" || what == "ready" || what == "sweep" || what == "thumbnails" ||
      what == "joined" || what == "filmed" || what == "settled" || what == "said") {
    waiting_ = what;
    said_ = words[1];
    settles_with_.reset();
    const auto count = static_cast<std::uint64_t>(what == "said" ? 0.0f : number(1));
    goal_ = count + (what == "frames"   ? static_cast<std::uint64_t>(viewer.frame().stats.frame)
                     : what == "filmed" ? 0
                                        : viewer.pictures());
    swept_section_ = swept_field_ = 0;
    swept_place_ = 0;
  } else if (what == "screenshot") {
    render::write_png(words[1], read_window(window.width(), window.height()));
  } else if (what == "scene") {
    render::write_png(words[1], viewer.scene_picture());
  } else if (what == "key") {
    window.send_key(key_of(words[1]), false);
  } else if (what == "move") {
    const Viewer::Area seen = viewer.area();
    window.send_move(static_cast<float>(seen.left) + number(1) * static_cast<float>(seen.width),
                     static_cast<float>(seen.top) + number(2) * static_cast<float>(seen.height));
  } else if (what == "press" || what == "release") {
    window.send_button(static_cast<int>(number(1)), what == "press", false);
  } else if (what == "wheel") {
    window.send_wheel(number(1));
  } else {
    begin_other(viewer, words);
  }
}

void Script::begin_other(Viewer& viewer, const std::vector<std::string>& words) {
  const std::string& what = words[0];
  Window& window = viewer.window();
  if (what == "resize") {
    window.resize(std::stoi(words[1]), std::stoi(words[2]));
  } else if (what == "minimise") {
    window.minimise();
  } else if (what == "restore") {
    window.restore();
  } else if (what == "close") {
    window.close();
  } else if (what == "open") {
    viewer.open(words[1]);
  } else if (what == "set") {
    for (const SettingsSection& section : viewer.settings()->sections())
      for (const scene_file::BoundField& field : section.fields)
        if (section.path + "." + field.name == words[1]) {
          SettingsModel::set_share(field, std::stod(words[2]));
          if (auto command = viewer.settings()->command(section, field)) viewer.send(std::move(command));
        }
  } else if (what == "measure") {
    const auto [wall, processor] = viewer.measure_drawing(std::stoi(words[1]));
    std::printf("measure %zu triangles %d x %d %.2f ms %.2f processor_ms %s\n", viewer.triangles(),
                window.width(), window.height(), 1e3 * wall, 1e3 * processor, window.renderer().c_str());
  } else if (what == "rebuild") {
    viewer.state().rebuild = true;
  } else if (what == "rung") {
    viewer.send([rung = std::stoi(words[1])](Session& session) { session.set_rung(rung); });
  } else if (what == "preset") {
    if (auto command = viewer.settings()->take_preset(0, words[1])) viewer.send(std::move(command));
  } else if (what == "message") {
    std::printf("shown %s\n", message_shown(viewer.frame(), viewer.state(), wall_seconds()).c_str());
  } else if (what == "bars") {
    std::printf("bars end %.0f of %d high %d plots %d\n", static_cast<double>(viewer.state().time_bar_end),
                window.width(), viewer.state().time_height, viewer.state().plots);
  } else if (what == "copied") {
    std::printf("copied %s\n", window.copied().c_str());
  } else if (what == "hand") {
    may_wait_ = true;
  } else if (what == "film") {
    const FilmRecorder* const film = viewer.film();
    std::printf("film pictures %d first %d last %d of %d\n", film ? film->frames() : 0,
                film ? film->first() : 0, film ? film->last() : 0, viewer.frame().stats.frame);
  } else if (what == "mark") {
    Marks& marks = viewer.state().marks;
    bool& one = words[1] == "pins" ? marks.pins : words[1] == "region" ? marks.region : marks.contacts;
    one = !one;
    viewer.send([marks](Session& session) { session.show_marks(marks); });
  } else if (what == "marks") {
    const PlacedMarks& marks = viewer.frame().marks;
    std::printf("marks pins %zu region %zu contacts %zu\n", marks.pins.size(), marks.region.size(),
                marks.contacts.size());
  } else if (what == "center") {
    const Vec3 center = center_of(viewer.frame());
    std::printf("center %.6g %.6g %.6g\n", static_cast<double>(center.x()), static_cast<double>(center.y()),
                static_cast<double>(center.z()));
  } else if (what == "status") {
    const Frame& frame = viewer.frame();
    std::printf("status time %.9g frame %d steps %lld paused %d failed %d rung %d size %d %d message %s\n",
                frame.stats.time, frame.stats.frame, static_cast<long long>(frame.stats.steps),
                frame.paused ? 1 : 0, frame.failed ? 1 : 0, frame.stats.rung, window.width(), window.height(),
                frame.message.c_str());
  } else {
    throw ConfigError("script", "there is no command '" + what + "'");
  }
  std::fflush(stdout);
}

bool Script::is_done(Viewer& viewer) {
  const Frame& frame = viewer.frame();
  if (waiting_ == "ready") return !frame.building && frame.number > 0 && viewer.triangles() > 0;
  if (waiting_ == "frames") return frame.failed || static_cast<std::uint64_t>(frame.stats.frame) >= goal_;
  if (waiting_ == "filmed") return frame.failed || pictures_of(viewer.film()) >= goal_;
  if (waiting_ == "pictures") return viewer.pictures() >= goal_;
  if (waiting_ == "settled") return is_settled(viewer);
  if (waiting_ == "said") {
    const std::string shown = message_shown(frame, viewer.state(), wall_seconds());
    if (shown.find(said_) == shown.npos) return false;
    std::printf("shown %s\n", shown.c_str());
    std::fflush(stdout);
    return true;
  }
  if (waiting_ == "joined") return !viewer.joins_films();
  if (waiting_ == "thumbnails") return viewer.gallery().missing() == 0;
  sweep_next(viewer);
  return swept_section_ >= viewer.settings()->sections().size();
}

/// A command to the session comes behind those that two pictures sent, and names the frame that shows what
/// they did.
bool Script::is_settled(Viewer& viewer) {
  if (viewer.pictures() < goal_ + 2) return false;
  if (!settles_with_) {
    settles_with_ = std::make_shared<std::atomic<std::uint64_t>>(0);
    viewer.send([number = settles_with_](Session& session) { *number = session.next_frame(); });
  }
  return *settles_with_ > 0 && viewer.frame().number >= *settles_with_;
}

/// One place of one slider: low, middle, high, and back to what it was.
void Script::sweep_next(Viewer& viewer) {
  SettingsModel& settings = *viewer.settings();
  if (viewer.pictures() < goal_) return;
  goal_ = viewer.pictures() + 1;
  while (swept_section_ < settings.sections().size()) {
    const SettingsSection& section = settings.sections()[swept_section_];
    if (swept_field_ >= section.fields.size()) {
      ++swept_section_;
      swept_field_ = 0;
      continue;
    }
    const scene_file::BoundField& field = section.fields[swept_field_];
    if (swept_place_ == 0) {
      put_back_ = std::visit(
          [](auto* target) -> std::function<void()> {
            return [target, value = *target] { *target = value; };
          },
          field.target);
    }
    bool moved = true;
    if (swept_place_ < 3) {
      moved = SettingsModel::set_share(field, 0.5 * swept_place_);
    } else {
      put_back_();
    }
    if (moved)
      if (auto command = settings.command(section, field)) viewer.send(std::move(command));
    if (moved && swept_place_ == 0) std::printf("sweep %s.%s\n", section.path.c_str(), field.name);
    if (!moved || ++swept_place_ > 3) {
      swept_place_ = 0;
      ++swept_field_;
    }
    if (moved) return;
  }
}

}  // namespace mallow::view

#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "mallow/scene.h"
#include "scene/bound_field.h"
#include "view/frame.h"
#include "view/session.h"

namespace mallow::view {

/// Settings that stand together: those of the solver, of a material and so on.
struct SettingsSection {
  enum class Kind { solver, material, surface, run, render, body, collider, emitter, pin, sink };
  Kind kind;
  std::size_t index;  ///< of a list
  std::string path;   ///< "solver", "material[0]"
  std::string title;
  scene_file::BoundFields fields;
};

/// Every setting of a scene, as the field tables have them, and what becomes of one that is changed while the
/// scene runs. Belongs to the window's thread; the session has a scene of its own.
class SettingsModel {
 public:
  /// overrides: that the scene was read with, as `--set` has them.
  explicit SettingsModel(const Scene& scene, std::vector<std::string> overrides = {});
  SettingsModel(const SettingsModel&) = delete;
  SettingsModel& operator=(const SettingsModel&) = delete;

  const std::vector<SettingsSection>& sections() const { return sections_; }
  const Scene& scene() const { return scene_; }
  /// When a change acts.
  enum class Acts { at_once, when_built_anew, in_pictures_of_runs };
  static Acts acts(const SettingsSection& section, const scene_file::BoundField& field);
  /// What the session is to do after a field of a section was changed; empty where that waits.
  std::function<void(Session&)> command(const SettingsSection& section, const scene_file::BoundField& field);
  bool waits_for_rebuild() const { return built_ != waiting_; }
  /// The scene as it is set now, for the session to build.
  const Scene& to_rebuild() {
    sent_ = waiting_;
    return scene_;
  }
  /// The session has built what was last asked for.
  void was_rebuilt() { built_ = sent_; }
  /// What changed by itself: at a setting that was refused, in a state that was gone back to.
  void take(const Frame& frame);
  /// A material of data/materials in place of one of the scene: it keeps its name.
  std::function<void(Session&)> take_preset(std::size_t material, const std::string& preset);

  /// Sets a number to a share of its slider's way; false where it has none.
  static bool set_share(const scene_file::BoundField& field, double share);
  /// `mallow run SCENE --set ...`, with what differs from the scene's file, and behind # what it lacks.
  /// run: the folder of the run that the scene was, which goes on; empty: it begins at its start.
  /// without: what else of the window's scene a command line does not say, as "what the mouse did".
  std::string command_line(const std::string& run = {}, std::vector<std::string> without = {}) const;

 private:
  std::string key_of_file(const std::string& key) const;

  Scene original_, scene_;
  std::vector<SettingsSection> sections_;  ///< refers to scene_
  std::vector<std::string> overrides_;
  // Changes that wait for a new scene: all so far, those that it was asked for with, and that it has.
  int waiting_ = 0, sent_ = 0, built_ = 0;
  int settings_number_ = -1;
};

}  // namespace mallow::view

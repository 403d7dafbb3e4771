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
  explicit SettingsModel(const Scene& scene);
  SettingsModel(const SettingsModel&) = delete;
  SettingsModel& operator=(const SettingsModel&) = delete;

  const std::vector<SettingsSection>& sections() const { return sections_; }
  const Scene& scene() const { return scene_; }
  /// Whether a change acts at once; else it waits until the scene is built anew.
  static bool acts_at_once(const SettingsSection& section, const scene_file::BoundField& field);
  /// What the session is to do after a field of a section was changed; empty where that waits.
  std::function<void(Session&)> command(const SettingsSection& section, const scene_file::BoundField& field);
  bool waits_for_rebuild() const { return waits_; }
  /// The scene was built with all of it.
  void was_rebuilt() { waits_ = false; }
  /// What changed by itself: at a setting that was refused, in a state that was gone back to.
  void take(const Frame& frame);
  /// A material of data/materials in place of one of the scene: it keeps its name.
  std::function<void(Session&)> take_preset(std::size_t material, const std::string& preset);

  /// Sets a number to a share of its slider's way; false where it has none.
  static bool set_share(const scene_file::BoundField& field, double share);
  /// `mallow run SCENE --set ...`, with what differs from the scene's file.
  std::string command_line() const;

 private:
  Scene original_, scene_;
  std::vector<SettingsSection> sections_;  ///< refers to scene_
  bool waits_ = false;
  int settings_number_ = -1;
};

}  // namespace mallow::view

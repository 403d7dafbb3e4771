#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mallow/appearance.h"
#include "mallow/body.h"
#include "mallow/collider.h"
#include "mallow/mesh.h"
#include "mallow/report.h"
#include "mallow/scene.h"
#include "render/renderer.h"
#include "view/marks.h"

namespace mallow::view {

/// What particles are coloured by.
enum class Shown : std::uint8_t { appearance, density, speed, strain, temperature, alpha, body, thread };
/// "speed" and the like, by number.
inline constexpr std::array<const char*, 8> k_shown_names = {"appearance",  "density", "speed", "strain",
                                                             "temperature", "alpha",   "body",  "thread"};
/// With their units, for the legend.
inline constexpr std::array<const char*, 8> k_shown_units = {"", "kg/m³", "m/s", "", "K", "", "", ""};
/// Whether values are numbers of something, each with a colour of its own; below 0 is grey.
constexpr bool are_numbers(Shown shown) {
  return shown == Shown::body || shown == Shown::thread;
}

/// Which of the two is drawn.
enum class Drawn : std::uint8_t { surface, particles };

/// One moment of the last ten seconds.
struct Sample {
  double wall = 0;      ///< [s]
  double time = 0;      ///< simulated [s]
  float kinetic = 0;    ///< [J]
  float potential = 0;  ///< −Σ m g·x, above what is lowest in the plot [J]
  float momentum = 0;   ///< of all bodies, its size [N s]
};

/// How the stepping thread fares.
struct FrameStats {
  double time = 0;               ///< simulated [s]
  std::int64_t steps = 0;        ///< taken in all
  int frame = 0;                 ///< frames of the scene that are finished
  double steps_per_second = 0;   ///< of wall time, in the last second
  double frames_per_second = 0;  ///< of the scene, the same
  double pace = 0;  ///< simulated time by the time that a film would take; 1: as fast as the film
  StepReport last;
  PhaseTimes phases{};         ///< of a step, in the mean of the last second [s]
  double surface_seconds = 0;  ///< to draw the surface, the same [s]
  double save_seconds = 0;     ///< to save a state to go back to [s]
  std::size_t particles = 0, bodies = 0, awake = 0;
  int threads = 0, most_threads = 0;          ///< that the simulation has, and may have
  std::size_t moments = 0, moment_bytes = 0;  ///< to go back to
  double oldest = 0, newest = 0;              ///< of them [s]
  int rung = 0;                               ///< see frame_governor.h
  std::string given_up;                       ///< what the rung means here
  std::uint64_t state_hash = 0;               ///< filled where asked for
};

/// All that the window shows of a moment.
struct Frame {
  std::uint64_t number = 0;  ///< counts what is published, from 1
  bool has_scene = false;
  int scene = 0;                      ///< counts scenes that were built; colliders and camera belong to it
  render::Camera camera;              ///< as `mallow render` looks at the scene
  Aabb bounds{{0, 0, 0}, {1, 1, 1}};  ///< what is to be seen of it [m]
  bool building = false;              ///< the scene is being built, and nothing else counts
  bool paused = false;
  bool finished = false;        ///< a frame of the scene ended here, of which a film waits for a picture
  Mesh mesh;                    ///< surface and skins; material ids are slots of bodies
  bool has_skins = false;       ///< which may be open: their insides are seen
  std::vector<Vec3> positions;  ///< of particles [m], where they are drawn
  std::vector<std::uint32_t> bodies;  ///< slot of the body of each
  std::vector<float> values;          ///< what is shown of each, empty for appearances
  std::vector<float> radii;           ///< of each body, by slot [m]
  Shown shown = Shown::appearance;    ///< what `values` are
  std::array<float, 2> value_range{0, 1};
  std::vector<Appearance> palette;            ///< by slot of body
  std::vector<Collider> colliders;            ///< that are seen, where they are
  std::vector<std::uint32_t> collider_slots;  ///< of each, which tells whether its form is known
  std::optional<std::array<Vec3, 2>> grab;    ///< from what is held to where it is pulled [m]
  PlacedMarks marks;
  int camera_number = 0;   ///< counts when the scene was told to be looked at from elsewhere
  int message_number = 0;  ///< counts messages
  std::string message;     ///< why it stands still, with advice; or what a verb could not do
  bool failed = false;     ///< the message is an error, and the scene stands at its last good state
  FrameStats stats;
  bool touched = false;             ///< the mouse has changed what no setting tells
  bool waits = false;               ///< some of `materials` waits for the scene to be built anew
  int settings_number = 0;          ///< counts when settings became others by themselves
  SolverConfig solver;              ///< as set, without what the rung makes of it
  std::vector<Material> materials;  ///< the same, of the scene's
  std::vector<Sample> samples;      ///< of the last ten seconds
};

}  // namespace mallow::view

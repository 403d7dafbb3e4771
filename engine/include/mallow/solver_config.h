#pragma once

#include <memory>
#include <optional>

#include "mallow/executor.h"
#include "mallow/instruction_level.h"
#include "mallow/schedule.h"
#include "mallow/vec3.h"

namespace mallow {

/// Which reading of the paper's SPH sums is run.
enum class Formulation {
  conservative,  ///< spiky pressure gradient, pairwise pressure and viscosity: momentum is kept (Mueller
                 ///< 2003)
  printed,       ///< [TK] eq. 1 and 2 to the letter: poly6 everywhere, p_j alone, v_j alone
};

/// How bodies that do not merge keep out of each other.
enum class BodyContact {
  constraint,  ///< velocities at which particles of two bodies would come nearer than a spacing end at that
               ///< distance, with friction: bodies touch, stack and slide
  pressure,    ///< they are parts of one fluid to each other, whose pressure and viscosity act between them:
               ///< the paper's rule
};

/// How sums of SPH and of the volume iterations round.
enum class Arithmetic {
  exact,   ///< as IEEE 754 says: the same bits on every machine
  native,  ///< with what the machine has to be faster
};

/// What holds for a whole simulation. Copied when given to a Simulation.
struct SolverConfig {
  /// Δt0 [s], > 0: the upper bound of a step, and what elasticity, the update rule and contact measure time
  /// by. Left out: follows from spacing and gravity, see default_time_step(). [TK eq. 12]
  std::optional<float> time_step = {};
  /// Steps are this share of time_step at most, in [0.01, 4]; the material stays what it is. That is how a
  /// scene is turned between speed and accuracy: the elastic pull per second is that of time_step, and
  /// reference shapes are checked at the same times. Above 1, (1 − alpha) time_step_factor² time_step /
  /// elastic_time_step is bounded, see Material::elastic_time_step.
  float time_step_factor = 1.0f;
  /// Radius of the SPH kernels, σ [m], > 0. Left out: 2.1 times the largest spacing of the bodies that there
  /// are when the simulation is prepared for the first time, see default_support_radius(). [TK eq. 3]
  std::optional<float> support_radius = {};
  /// Acceleration on every particle [m/s²], finite.
  Vec3 gravity{0.0f, 0.0f, -0.3f};
  /// Time between the checks that update reference shapes, m_u [s], > 0: a check is at the first step that
  /// starts at or after a multiple of it. Left out: 60 time_step, unless update_interval says it. [TK 3.2]
  std::optional<float> update_period = {};
  /// The same in steps, as the paper has it, >= 1; where time_step_factor is not 1, so many times time_step.
  /// Only one of the two may be given.
  std::optional<int> update_interval = {};
  Formulation formulation = Formulation::conservative;
  /// Also bound the step by the speed of sound and by viscous diffusion.
  bool acoustic_limit = true;
  /// Bodies that merge (Body::merges) are parts of one whatever it says. [model 2, section 4 C]
  BodyContact contact = BodyContact::constraint;
  /// Distance from a collider at which a particle touches it [m], >= 0; left out: half the spacing of its
  /// body.
  std::optional<float> contact_offset = {};
  /// To what is not purely elastic, colliders are filled with matter like it: they count in its density, and
  /// its pressure ends at no wall. Without, a fluid between walls ends a seventh too dense, and what floats
  /// in it sinks too deep. A surface is taken to be flat over a support radius. Not with
  /// Formulation::printed. [Koschier & Bender 2017]
  bool wall_pressure = true;
  /// Iterations a step that keep matter from being pressed together, at most, in [0, 50]; 0: pressure alone
  /// does it, and nothing where alpha is 0. They change velocities so that no density rises above that at
  /// rest, in elastic bodies and fluids alike, and act beside pressure, which lets fluids rest: a
  /// pressure_coefficient of 0 turns that off, and its limit on steps. One keeps the worst density of a hard
  /// impact within 0.29 of that at rest, three within 0.19. Densities have Wendland's kernel then, so that
  /// what flows keeps its particles apart. Bodies nearly as stiff as their step
  /// can carry get less of it. Left out: default_volume_iterations(), 2 while there is a body whose material
  /// has plastic_yield, and else none. [model 2, section 2; Bender & Koschier 2015]
  std::optional<int> volume_iterations = {};
  /// Iterations of a step end where the mean of all compressions is at most this, in [0, 1]; 0: all are
  /// taken. 0.001 keeps impacts within a twelfth.
  float volume_tolerance = 0.0f;
  /// A body sleeps whose particles have been slower than this in the mean for sleep_time, with all that it
  /// touches: no phase runs for it until something wakes it [m/s], >= 0; 0: none ever sleeps.
  /// Left out: 0.005 spacings in a time_step. Only where bodies are kept apart by constraint.
  std::optional<float> sleep_speed = {};
  /// [s], > 0. Left out: 60 time_step.
  std::optional<float> sleep_time = {};
  /// Of the air, where materials give heat to it, over time [K].
  Schedule air_temperature = 293.15f;
  /// Newton iterations for a region's rotation in a step, at most, in [0, 8]; each starts where the last
  /// step ended. With 8, what has not converged is solved exactly, so that every rotation is right to single
  /// precision. With fewer it goes on in the next step: where a region turned by θ rad since the last step, 1
  /// leaves about θ³/20 rad (5e-5 of a turn of 0.1; up to θ³ in a region pressed flat), and 2 leave nothing
  /// below 0.3 rad that single precision could show. Linear momentum is kept whatever it is; of its spin an
  /// elastic cube that turns by 0.16 rad a step loses 7e-4 in 600 steps with 1. Singular and mirrored regions
  /// are always solved exactly; 0 solves all so, in double: slow, a reference. [model 2; Kugelstadt et al.
  /// 2018]
  int rotation_iterations = 8;
  /// Neighbour lists reach this share of the support radius farther than needed, in [0, 1], and are kept
  /// until some particle has moved half of that, seen from the mean motion of all: a body that flies or rests
  /// keeps its lists, at the price of longer ones. 0: they are found anew in every step. Results differ by
  /// the order of sums only.
  float neighbor_slack = 0.0f;
  /// native: sums of SPH and of the volume iterations by fused multiply-adds, distances in accelerations
  /// right to 12 bits, or 14 with AVX-512. That is faster and moves as well, but not the same to the bit on
  /// another kind of machine or at another instruction_level; on any number of threads it is. At
  /// InstructionLevel::baseline, and on machines other than x86-64, it is exact.
  Arithmetic arithmetic = Arithmetic::exact;
  /// Threads of every phase, in [0, 1024]; 0 takes all that the executor has. Results do not depend on it.
  int threads = 0;
  /// Whose threads run the loops: team_executor() where it is null, openmp_executor(), or an application's
  /// own. Results do not depend on it.
  std::shared_ptr<Executor> executor = nullptr;
  /// Instructions that lanes use, one of those this machine has; left out: its best. Results do not depend
  /// on it; it is there to show that, and to time what older machines would do.
  std::optional<InstructionLevel> instruction_level = {};
  /// Memory that neighbour lists may take [GiB], > 0. prepare() refuses radii that would ask for more, before
  /// anything is allocated.
  float memory_limit = 16.0f;
};

}  // namespace mallow

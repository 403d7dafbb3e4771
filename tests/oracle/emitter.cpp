// Section 6 of the second chapter: layers of a strand, held until they have passed the nozzle.
#include <Eigen/Geometry>
#include <cmath>

#include "oracle/oracle.h"

namespace mallow::oracle {
namespace {

Matrix rotation_of(const Pose& pose) {
  return Eigen::Quaterniond(pose.rotation).normalized().toRotationMatrix();
}

/// That are put behind it at once.
constexpr std::size_t k_batch = 8;

}  // namespace

void Oracle::add_emitter(const Emitter& emitter, const std::vector<Vec>& section, double turn,
                         const Material& material) {
  strands_.push_back({.emitter = emitter, .section = section, .turn = turn, .group = add_group(material)});
  Strand& strand = strands_.back();
  const double radius = material.region_radius.value_or(*config_.support_radius);
  strand.least_held = 2 * static_cast<std::size_t>(std::ceil(radius / double{emitter.spacing})) + 1;
  groups_[strand.group].spacing = emitter.spacing;
  set_mass_and_rest_density(groups_[strand.group], *config_.support_radius);
  add_layers(strand, strand.least_held + k_batch, Vec::Zero());
}

// x̄ of a layer is that of the last one, a spacing back along the flow.
void Oracle::add_layers(Strand& strand, std::size_t count, const Vec& velocity) {
  const Emitter& emitter = strand.emitter;
  const Matrix rotation = rotation_of(emitter.pose);
  for (std::size_t k = 0; k < count; ++k, ++strand.layers) {
    std::vector<std::size_t> layer;
    const double height =
        strand.offset - double{emitter.spacing} * (static_cast<double>(strand.layers) + 0.5);
    const Eigen::AngleAxisd turn(strand.turn * static_cast<double>(strand.layers), Vec::UnitZ());
    for (const Vec& point : strand.section) {
      const Vec x = emitter.pose.translation + rotation * (turn * point + Vec(0, 0, height));
      Particle p{.group = strand.group, .id = born_++, .x = x, .v = velocity, .pinned = true, .reference = x};
      p.temperature = groups_[strand.group].material.temperature.value_or(0.0f);
      if (!strand.held.empty()) {
        const Particle& beside = particles_[strand.held.back().front()];
        p.reference = beside.reference + (x - beside.x);
      }
      layer.push_back(particles_.size());
      particles_.push_back(p);
    }
    strand.held.push_back(layer);
  }
  list_regions(strand.group);
}

// Before a step: what has passed the nozzle is free, and enough stays held for new layers to rest beside.
void Oracle::flow_out() {
  for (Strand& strand : strands_) {
    const Emitter& emitter = strand.emitter;
    const double h = emitter.spacing;
    while (!strand.held.empty()) {
      const auto number = static_cast<double>(strand.layers - strand.held.size());
      if (strand.offset - h * (number + 0.5) < 0) break;
      for (const std::size_t id : strand.held.front()) particles_[id].pinned = false;
      strand.held.erase(strand.held.begin());
    }
    if (strand.held.size() <= strand.least_held)
      add_layers(strand, k_batch, velocity_of(strand, alpha_at(emitter.speed, time_)));
  }
}

Vec Oracle::velocity_of(const Strand& strand, double speed) const {
  const bool flows = time_ >= strand.emitter.start.value_or(0);
  return strand.emitter.velocity.cast<double>() +
         (flows ? speed : 0.0) * rotation_of(strand.emitter.pose) * Vec::UnitZ();
}

// What is held moves with the speed of the middle of a step.
void Oracle::drive(double dt) {
  for (Strand& strand : strands_) {
    const double speed = alpha_at(strand.emitter.speed, time_ + dt / 2);
    const Vec velocity = velocity_of(strand, speed);
    for (const std::vector<std::size_t>& layer : strand.held)
      for (const std::size_t id : layer) particles_[id].pin_velocity = velocity;
    if (time_ >= strand.emitter.start.value_or(0)) strand.offset += dt * speed;
    strand.emitter.pose.translation += dt * strand.emitter.velocity.cast<double>();
  }
}

}  // namespace mallow::oracle

#include "scene/scene_fields.h"

#include <limits>

namespace mallow::scene_file {
namespace {

constexpr double k_largest_int = std::numeric_limits<int>::max();
constexpr Range k_count = between(1, k_most_particles);

FieldTable joined(FieldTable first, const FieldTable& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

FieldTable fields(Sampling& sampling) {
  return {
      {"spacing", &sampling.spacing, k_positive, "m",
       "distance of neighbouring particles, h; give this or count", "from count"},
      {"count", &sampling.count, k_count, "",
       "wanted number of particles, met within 1%; give this or spacing", "from spacing"},
      {"jitter", &sampling.jitter, between(0, 0.45), "h",
       "random displacement of every particle along each axis, at most"},
  };
}

FieldTable fields(Placement& placement) {
  return {
      {"rotate", &placement.rotate, k_finite, "degrees", "turn about x, then y, then z"},
      {"size", &placement.size, k_positive, "m", "longest side of the bounding box", "as the shape is"},
      {"center", &placement.center, k_finite, "m", "middle of the bounding box", "where the shape is"},
  };
}

}  // namespace

FieldTable fields(SolverConfig& config) {
  return {
      {"time_step", &config.time_step, k_positive, "s", "upper bound of a step, Δt0",
       "from spacing and gravity"},
      {"time_step_factor", &config.time_step_factor, between(0.01, 4), "",
       "steps are this share of time_step, and the material stays what it is"},
      {"support_radius", &config.support_radius, k_positive, "m", "radius of the SPH kernels, σ", k_required},
      {"gravity", &config.gravity, k_finite, "m/s²", "acceleration of every particle"},
      {"update_period", &config.update_period, k_positive, "s",
       "time between the checks that update reference shapes, m_u; give this or update_interval",
       "60 time_step"},
      {"update_interval", &config.update_interval, between(1, k_largest_int), "steps",
       "the same in steps; give this or update_period", "from update_period"},
      {"formulation", &config.formulation, k_any, "",
       "SPH sums that keep momentum, or the paper's to the letter"},
      {"acoustic_limit", &config.acoustic_limit, k_any, "",
       "also bound the step by the speed of sound and by viscous diffusion"},
      {"contact_offset", &config.contact_offset, k_not_negative, "m",
       "distance from a collider at which a particle touches it", "half the spacing"},
      {"rotation_iterations", &config.rotation_iterations, between(0, 8), "",
       "most iterations for a region's rotation in a step; it stops when converged; 0 is exact and slow"},
      {"neighbor_slack", &config.neighbor_slack, between(0, 1), "σ",
       "extra reach of neighbour lists, which are kept until a particle has moved half of it"},
      {"instruction_level", &config.instruction_level, k_any, "",
       "instructions that kernels use; the motion is the same", "the best this machine has"},
      {"memory_limit", &config.memory_limit, k_positive, "GiB",
       "radii whose neighbour lists would need more are refused"},
  };
}

FieldTable fields(SceneMaterial& material) {
  Material& m = material.material;
  return {
      {"name", &material.name, k_any, "", "what bodies call it", k_required},
      {"alpha", &m.alpha, between(0, 1), "", "elastic solid (0) to fluid (1), or keyframes of it over time"},
      {"update_threshold", &m.update_threshold, k_not_negative, "m/s²",
       "mean external acceleration that updates the reference shape, at alpha 0, γ_u", "40 times gravity"},
      {"pressure_coefficient", &m.pressure_coefficient, k_not_negative, "m²/s²",
       "pressure by excess density, k", "as a step can carry"},
      {"viscosity", &m.viscosity, k_not_negative, "Pa s", "viscosity coefficient, μ",
       "as looks the same at any size"},
      {"elastic_time_step", &m.elastic_time_step, k_positive, "s", "Δt_SM, shorter is stiffer",
       "solver.time_step"},
      {"particle_mass", &m.particle_mass, k_positive, "kg", "mass of a particle, m",
       "from rest_density, or 1"},
      {"rest_density", &m.rest_density, k_positive, "kg/m³", "density at rest, ρ0", "from particle_mass"},
      {"cohesion", &m.cohesion, between(0, 1), "", "share of a negative pressure that acts"},
      {"region_radius", &m.region_radius, k_positive, "m", "radius of the shape matching regions",
       "solver.support_radius"},
      {"region_stride", &m.region_stride, between(1, k_largest_int), "particles",
       "one region for this many particles; more is faster and coarser"},
      {"color", &material.color, between(0, 1), "", "red, green and blue in pictures, linear",
       "one of a palette"},
      {"finish", &material.finish, k_any, "", "in pictures: translucent and glossy, or opaque and dull"},
  };
}

FieldTable fields(SceneBody& body) {
  return {
      {"material", &body.material, k_any, "", "name of its [[material]]", k_required},
      {"group", &body.group, k_any, "", "bodies of one group are one piece, with one reference shape",
       "a piece of its own"},
      {"merges", &body.merges, k_any, "",
       "acts on others of its material that merge as on itself: two puddles become one"},
      {"velocity", &body.velocity, k_finite, "m/s", "of every particle at the start"},
  };
}

FieldTable fields(Lattice& lattice) {
  return {
      {"count", &lattice.count, k_count, "", "cells along x, y and z, a particle each", k_required},
      {"spacing", &lattice.spacing, k_positive, "m", "side of a cell, h", k_required},
      {"corner", &lattice.corner, k_finite, "m", "lowest corner, half a cell from the first particle"},
      {"jitter", &lattice.jitter, between(0, 0.45), "h", "random displacement of every particle, per axis"},
  };
}

FieldTable fields(SphereSource& source) {
  return joined({{"center", &source.center, k_finite, "m", "middle of the ball"},
                 {"radius", &source.radius, k_positive, "m", "of the ball", k_required}},
                fields(source.sampling));
}

FieldTable fields(MeshSource& source) {
  return joined({{"file", &source.file, k_any, "", "closed mesh, OBJ, PLY, STL or OFF, relative to the scene",
                  k_required}},
                joined(fields(source.sampling), fields(source.placement)));
}

FieldTable fields(PointsSource& source) {
  return {
      {"file", &source.file, k_any, "",
       "points x,y,z and optionally vx,vy,vz, PLY or CSV with a header, relative to the scene", k_required},
      {"spacing", &source.spacing, k_positive, "m", "distance of neighbouring particles, h", k_required},
  };
}

FieldTable fields(ImplicitSource& source) {
  return joined({{"shape", &source.shape, k_any, "", "name of a built-in shape: moai", k_required}},
                joined(fields(source.sampling), fields(source.placement)));
}

FieldTable fields(SceneCollider& collider) {
  return {
      {"translate", &collider.translate, k_finite, "m", "where the origin of its shape is at the start"},
      {"rotate", &collider.rotate, k_finite, "degrees", "turn of its shape about x, then y, then z"},
      {"velocity", &collider.velocity, k_finite, "m/s", "the obstacle moves with it"},
      {"angular_velocity", &collider.angular_velocity, k_finite, "rad/s",
       "the obstacle turns with it about the origin of its shape"},
      {"restitution", &collider.restitution, between(0, 1), "",
       "share of the normal velocity that bounces back, e"},
      {"friction", &collider.friction, k_not_negative, "", "Coulomb's μ_f"},
      {"visible", &collider.visible, k_any, "", "it is seen in pictures; false: it acts all the same"},
  };
}

FieldTable fields(Primitive& primitive) {
  FieldTable table;
  std::visit(
      [&]<class Shape>(Shape& shape) {
        ShapeTraits<Shape>::visit_members(shape, [&](auto& member, const ShapeMember& about) {
          const Range range = about.values == ShapeMember::Values::positive ? k_positive : k_finite;
          table.push_back(
              {about.key, &member, range, about.unit, about.doc, about.required ? k_required : ""});
        });
      },
      primitive);
  return table;
}

FieldTable fields(ScenePin& pin) {
  return {{"velocity", &pin.velocity, k_finite, "m/s",
           "of the particles that are in the box at the start, for the whole run"}};
}

FieldTable fields(Aabb& box) {
  return {
      {"min", &box.min, k_finite, "m", "lowest corner", k_required},
      {"max", &box.max, k_finite, "m", "highest corner", k_required},
  };
}

FieldTable fields(SurfaceConfig& config) {
  return {
      {"voxels_per_spacing", &config.voxels_per_spacing, between(0.5, 16), "",
       "voxels along one spacing of the particles, if voxel_size and voxels are left out"},
      {"voxel_size", &config.voxel_size, k_positive, "m", "side of a voxel", "from voxels_per_spacing"},
      {"voxels", &config.voxels, between(8, 1024), "",
       "voxels along the longest side of the box around the particles, if voxel_size is left out",
       "from voxels_per_spacing"},
      {"kernel_radius", &config.kernel_radius, between(1, 4), "h", "radius in which particles are blended"},
      {"particle_radius", &config.particle_radius, between(0.1, 1), "h",
       "distance of the surface from the outermost particles"},
      {"kind", &config.kind, k_any, "", "how the surface is drawn around the particles"},
      {"joined", &config.joined, k_any, "", "one surface around all bodies"},
      {"adaptivity", &config.adaptivity, between(0, 1), "voxels",
       "how far merging vertices on even parts may move the surface"},
      {"smoothing", &config.smoothing, between(0, 100), "",
       "rounds that smooth the mesh and keep its volume"},
      {"memory_limit", &config.memory_limit, k_positive, "GiB", "a surface that would need more is refused"},
  };
}

FieldTable fields(RunConfig& config) {
  return {
      {"frames", &config.frames, between(0, k_largest_int), "", "frames that are written"},
      {"frame_time", &config.frame_time, k_positive, "s", "simulated time from one frame to the next",
       "solver.time_step"},
  };
}

FieldTable fields(RenderConfig& config) {
  return {
      {"width", &config.width, between(16, 8192), "pixels", "of a picture"},
      {"height", &config.height, between(16, 8192), "pixels", "of a picture"},
      {"samples", &config.samples, between(1, 256), "", "rays per pixel"},
      {"eye", &config.eye, k_finite, "m", "where the camera is", "chosen to show the scene"},
      {"target", &config.target, k_finite, "m", "what it looks at", "chosen to show the scene"},
      {"field_of_view", &config.field_of_view, between(1, 120), "degrees", "vertical"},
      {"frames_per_second", &config.frames_per_second, between(1, 120), "", "of the film"},
  };
}

const std::vector<Kind<BodySource>>& source_kinds() {
  static const std::vector<Kind<BodySource>> kinds{{"box", Lattice{}},
                                                   {"sphere", SphereSource{}},
                                                   {"mesh", MeshSource{}},
                                                   {"points", PointsSource{}},
                                                   {"implicit", ImplicitSource{}}};
  return kinds;
}

const std::vector<Kind<Primitive>>& primitive_kinds() {
  static const std::vector<Kind<Primitive>> kinds = []<class... Shapes>(const std::variant<Shapes...>&) {
    return std::vector<Kind<Primitive>>{{ShapeTraits<Shapes>::k_key, Shapes{}}...};
  }(Primitive{});
  return kinds;
}

}  // namespace mallow::scene_file

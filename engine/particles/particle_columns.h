#pragma once

#include "config/field_tables.h"
#include "particles/particle_store.h"

namespace mallow {

/// What a saved state says of a column of particles.
struct SavedColumn {
  const char* chunk;           ///< its name
  bool may_be_absent = false;  ///< empty where it is the same for all particles
  Range range = k_finite;
};

/// Calls visit(saved, column) with all that a particle takes along when its row changes. What is added here
/// is inserted, erased, sorted, counted, saved and restored.
template <class Store, class Visit>
void for_each_column(Store& store, const Visit& visit) {
  visit(SavedColumn{"ids"}, store.id);
  visit(SavedColumn{"positions"}, store.position);
  visit(SavedColumn{"velocities"}, store.velocity);
  visit(SavedColumn{"pinned", true}, store.pin);
  visit(SavedColumn{"alphas", true, range_of(&Material::alpha)}, store.alpha);
  visit(SavedColumn{"stiffnesses", true, k_stiffness_factor}, store.stiffness);
  visit(SavedColumn{"plastic_yields", true, range_of(&Material::plastic_yield)}, store.plastic_yield);
  visit(SavedColumn{"temperatures", true, range_of(&Material::temperature)}, store.temperature);
  visit(SavedColumn{"temperature_rests", true}, store.temperature_rest);
}

}  // namespace mallow

#pragma once

#include <nlohmann/json_fwd.hpp>

#include "mallow/collider.h"

namespace mallow::program {

/// Adds what a collider got in a step to what it has got.
void add(const ColliderLoad& load, ColliderLoad& sum);
/// Its impulse [N s] and its torque [N m s].
nlohmann::ordered_json to_json(const ColliderLoad& load);
/// The reverse. Throws nlohmann's exceptions.
ColliderLoad load_from_json(const nlohmann::ordered_json& json);
/// x, y and z.
nlohmann::ordered_json to_json(const Eigen::Vector3d& vector);

}  // namespace mallow::program

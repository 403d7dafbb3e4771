#include "program/loads.h"

#include <nlohmann/json.hpp>

namespace mallow::program {
namespace {

Eigen::Vector3d vector_from_json(const nlohmann::ordered_json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

}  // namespace

void add(const ColliderLoad& load, ColliderLoad& sum) {
  sum.impulse += load.impulse;
  sum.torque += load.torque;
}

nlohmann::ordered_json to_json(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

nlohmann::ordered_json to_json(const ColliderLoad& load) {
  return {{"impulse", to_json(load.impulse)}, {"torque", to_json(load.torque)}};
}

ColliderLoad load_from_json(const nlohmann::ordered_json& json) {
  return {.impulse = vector_from_json(json.at("impulse")), .torque = vector_from_json(json.at("torque"))};
}

}  // namespace mallow::program

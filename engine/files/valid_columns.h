#pragma once

#include "mallow/files.h"

namespace mallow {

/// Throw ConfigError that names the field, before a file of it is begun: columns of a wrong length, corners
/// beyond the vertices.
void require_valid(const Mesh& mesh);
void require_valid(const ParticleFrame& frame);

/// Throws ConfigError that names the first vertex with a number that is not finite, for formats that could
/// not say it.
void require_finite(const Mesh& mesh);

}  // namespace mallow

#include "files/byte_reader.h"
#include "files/valid_columns.h"
#include "mallow/files.h"
#include "mallow/level_set.h"

namespace mallow {

void write_particles_vdb(const std::filesystem::path& file, const ParticleFrame& frame, float voxel_size,
                         int threads) {
  require_valid(frame);
  const std::string bytes = points_vdb(frame.positions, frame.velocities, frame.bodies, voxel_size, threads);
  require_readable_size(file, bytes.size());
  write_whole(file, bytes);
}

}  // namespace mallow

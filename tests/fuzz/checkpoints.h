#pragma once

#include <filesystem>

/// Checkpoints as libFuzzer can change them. As a file is nearly all checksum, two things are tried: files
/// that are damaged, and right files around saved states that no simulation wrote.
namespace mallow::fuzz {

/// Reads a checkpoint file. Throws mallow::Error.
void read_as_checkpoint(const std::filesystem::path& file);
/// Takes a file for the chunks of a saved state in their order, each 4 bytes of size and as many more; the
/// last may be cut, and what is behind the last known one is passed over. Writes them as a checkpoint, reads
/// that, restores it and takes three steps. Throws mallow::Error, std::logic_error where what is read is not
/// what was written, or a step leaves numbers that are not finite.
void read_as_saved_state(const std::filesystem::path& file);

/// Writes seeds of both formats to FOLDER/checkpoint and FOLDER/saved_state. They are made anew, as the
/// layout may change with every build.
void write_checkpoint_seeds(const std::filesystem::path& folder);

}  // namespace mallow::fuzz

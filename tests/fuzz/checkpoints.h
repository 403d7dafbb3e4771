#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mallow/saved_state.h"

/// Checkpoints as libFuzzer can change them. As a file is nearly all checksum, two things are tried: files
/// that are damaged, and right files around saved states that no simulation wrote.
namespace mallow::fuzz {

/// Chunks of a state in the order in which they are saved: 4 bytes of size, then as many; the last may be
/// cut.
std::string plain(const SavedState& state);
/// The state whose chunks these are; what is behind the last known chunk is passed over.
SavedState from_plain(std::string_view bytes);

/// Reads a checkpoint file. Throws mallow::Error.
void read_as_checkpoint(const std::filesystem::path& file);
/// Writes what from_plain() makes of a file as a checkpoint, reads that, restores it and takes three steps.
/// Throws mallow::Error, std::logic_error where what is read is not what was written, or a step leaves
/// numbers that are not finite.
void read_as_saved_state(const std::filesystem::path& file);

/// States of small simulations that differ in what they hold: of one elastic body, of a fluid with kept
/// lists, of several groups with obstacles and pins. They are made anew, as the layout may change with every
/// build.
std::vector<SavedState> states();
/// Writes seeds of both formats to FOLDER/checkpoint and FOLDER/saved_state.
void write_checkpoint_seeds(const std::filesystem::path& folder);

}  // namespace mallow::fuzz

#include <cstdio>
#include <exception>

#include "fuzz/checkpoints.h"

/// fuzz_write_seeds FOLDER: seeds of the formats whose seeds are made, not kept.
int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    mallow::fuzz::write_checkpoint_seeds(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fuzz_write_seeds: %s\n", error.what());
    return 1;
  }
}

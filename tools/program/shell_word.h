#pragma once

#include <string>

namespace mallow::program {

/// A text as a word of a command line that is pasted into a shell: in quotes where it needs them.
std::string shell_word(const std::string& text);

}  // namespace mallow::program

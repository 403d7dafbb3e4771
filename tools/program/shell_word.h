#pragma once

#include <string>
#include <vector>

namespace mallow::program {

/// A text as a word of a command line that is pasted into a shell: in quotes where it needs them.
std::string shell_word(const std::string& text);
/// A command line that a shell takes apart into these words. Those that begin with "--" are options.
std::string shell_line(const std::vector<std::string>& words);

}  // namespace mallow::program

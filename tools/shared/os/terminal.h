#pragma once
// Terminals behind the standard streams.

namespace ngs::os {

constexpr int kStdout = 1, kStderr = 2;  // descriptors

bool is_terminal(int descriptor);
/// Columns of the terminal; 0: none, or unknown.
int terminal_width(int descriptor);

}  // namespace ngs::os

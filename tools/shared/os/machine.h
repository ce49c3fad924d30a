#pragma once
// Processor, memory and environment of this process.
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace ngs::os {

/// Processors that this process may use, at least 1.
int processor_count();
/// Runs `work` in a thread; in a browser, which has one, before it returns, and the thread is none.
std::thread in_background(const std::function<void()>& work);
/// Sets a variable of the environment, of child processes too; an existing one only with `replace`.
void set_variable(const char* name, const char* value, bool replace);
/// Keeps the memory of images and lists that are freed after every view: the system need not clear its pages again.
void keep_freed_memory();
void release_freed_memory();
/// The file of this program; empty, with errno set: unknown.
std::string path_of_this_program();
/// The command that opens an address in the user's browser.
std::vector<std::string> browser_command(const std::string& url);

// Terminals behind the standard streams.
constexpr int kStdout = 1, kStderr = 2;  // descriptors

bool is_terminal(int descriptor);
/// Columns of the terminal; 0: none, or unknown.
int terminal_width(int descriptor);

}  // namespace ngs::os

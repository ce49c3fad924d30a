#pragma once
// The exit codes of every tool. 2 to 6 and 8 are ErrorCode (core/error.h).
namespace ngs::cli {

inline constexpr int kDone = 0;
inline constexpr int kCheckFailed = 1;    // done, but a requested check failed
inline constexpr int kBudgetHit = 7;      // a usable partial result was written
inline constexpr int kBug = 70;           // an exception that is not an Error
inline constexpr int kInterrupted = 130;  // SIGINT, SIGQUIT
inline constexpr int kTerminated = 143;   // SIGTERM, SIGUSR1, SIGHUP

inline constexpr const char* kExitCodeHelp =
    "0 done, 1 a requested check failed, 2 usage, 3 input unreadable or invalid, 4 inputs contradict each other, "
    "5 nothing found, 6 numerical failure, 7 budget hit (partial result), 8 environment (cannot write, no memory, "
    "no such device), 70 bug, 130/143 signal";

}  // namespace ngs::cli

#pragma once
// The clock of wall_seconds() (core/monitor.h), so that tests of time limits move time instead of sleeping.

namespace ngs {

/// Seconds since a fixed point, monotonic, thread-safe. Replace it only while no other thread runs.
extern double (*wall_clock)();

}  // namespace ngs

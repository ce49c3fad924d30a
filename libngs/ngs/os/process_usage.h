#pragma once
// What this process has used so far.

namespace ngs::os {

double cpu_seconds();  // of all threads
double peak_rss_mib();

}  // namespace ngs::os

#pragma once
// Windows: the event by which another program requests a program of these to stop.
#include <string>

namespace ngs::os {

inline std::wstring stop_event_of(unsigned long process) { return L"Local\\ngs-stop-" + std::to_wstring(process); }

}  // namespace ngs::os

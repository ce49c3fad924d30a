#pragma once
// Windows: reasons as the numbers of errno, which messages are made of; UTF-16 at the border to the system.
#include <string>

namespace ngs::os {

/// The errno that is nearest to GetLastError().
int last_errno();
std::wstring wide(const std::string& utf8);

}  // namespace ngs::os

#pragma once
// What the studio in a browser does not read or write, as no library for it is compiled.
#include <string>

#include "ngs/core/error.h"

namespace ngs::io {

[[noreturn]] inline void refuse_in_browser(const std::string& object, const std::string& what) {
  throw Error(ErrorCode::kEnvironment, object + ": " + what + ", which is not read or written in a browser",
              "convert it to .ply with ngs-extract, or use the tools of ngs");
}

}  // namespace ngs::io

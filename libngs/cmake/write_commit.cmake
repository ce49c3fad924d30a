# Writes OUT, a source file that says VERSION and the commit that is checked out in SOURCE; only where that changed.
# Without a checkout (a tarball) it is VERSION alone.
set(commit "")
if(EXISTS ${SOURCE}/.git)
  execute_process(COMMAND git -C ${SOURCE} rev-parse --short=7 HEAD
    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
endif()
if(commit AND NOT failed)
  string(PREPEND commit "+g")
endif()
file(CONFIGURE OUTPUT ${OUT} CONTENT [[
#include "shared/cli/version.h"
const char* ngs::cli::version_with_commit() { return "@VERSION@@commit@"; }
]] @ONLY)

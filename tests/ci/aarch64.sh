#!/usr/bin/env bash
# Builds ngs for aarch64 on Debian, and runs the test suites under qemu-user: into build-aarch64/.
#   tests/ci/aarch64.sh [SUITE...]            SUITE: unit grad property stability golden contract; default: all.
#                                              Reports and skips steps whose programs are missing.
#   NGS_AARCH64_ROOT=DIR                       folder of the unpacked arm64 packages; default: build-aarch64.root
#   NGS_SUITE_MINUTES=15                       time limit per suite; emulation is 10 to 30 times slower than a processor, and
#                                              contract takes more than an hour
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
if [ $# -gt 0 ]; then suites=("$@"); else suites=(unit grad property stability golden contract); fi
cd "$top"
if ! command -v aarch64-linux-gnu-g++ > /dev/null; then
  say "skipped: no aarch64-linux-gnu-g++ (Debian: apt-get install g++-aarch64-linux-gnu)"
  exit 77
fi
export NGS_AARCH64_ROOT=${NGS_AARCH64_ROOT:-$PWD/build-aarch64.root}

# If the kernel cannot start aarch64 programs, replaces the tools by scripts that run them with qemu-aarch64 during the
# suites. The programs become NAME.aarch64 in the same folder, so that a tool still finds the others and its codecs.
tools_by_qemu() {
  local tool
  for tool in "$PWD"/build-aarch64/bin/ngs*; do
    mv "$tool" "$tool.aarch64"
    # shellcheck disable=SC2016  # $0 and $@ are the script's
    printf '#!/bin/sh\nexec qemu-aarch64 -L %q -0 "$0" %q "$@"\n' "$NGS_AARCH64_ROOT" "$tool.aarch64" > "$tool"
    chmod +x "$tool"
  done
}
tools_as_linked() {
  local program
  for program in build-aarch64/bin/ngs*.aarch64; do
    if [ -e "$program" ]; then mv "$program" "${program%.aarch64}"; fi
  done
}

tools_as_linked  # restore tools after a killed run
"$top/tests/ci/aarch64-root.sh" "$NGS_AARCH64_ROOT"
cmake --preset aarch64
cmake --build --preset aarch64 --target tools "${suites[@]/#/test_}"

if ! command -v qemu-aarch64 > /dev/null; then
  say "skipped: the suites, no qemu-aarch64 (Debian: apt-get install qemu-user)"
  exit 77
fi
export QEMU_LD_PREFIX=$NGS_AARCH64_ROOT GOMP_SPINCOUNT=0
if ! build-aarch64/bin/ngs-scene --version > /dev/null 2>&1; then
  trap tools_as_linked EXIT
  tools_by_qemu
fi
failed=0
for suite in "${suites[@]}"; do
  code=0
  timeout "$((60 * ${NGS_SUITE_MINUTES:-15}))" qemu-aarch64 "build-aarch64/bin/test_$suite" --no-intro=true || code=$?
  case $code in
    0) say "passed: $suite" ;;
    124) say "stopped: $suite, after ${NGS_SUITE_MINUTES:-15} minutes" ;;
    *) failed=1; say "failed: $suite, exit code $code" ;;
  esac
done
exit "$failed"

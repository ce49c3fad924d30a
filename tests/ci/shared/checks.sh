# shellcheck shell=bash
# For scripts of tests/ci that print a line per check. Uses say of pipelines/common.sh; `log` of the caller is the file
# that holds the output of the last check.
# shellcheck disable=SC2034,SC2154  # variables of the caller

skip() { say "SKIP $*"; exit 77; }

failed=0
check() {  # NAME COMMAND...: prints the command's output if it fails
  local name=$1
  shift
  if "$@" > "$log" 2>&1; then say "ok   $name"; else failed=1; say "FAIL $name"; tail -n 20 "$log" >&2; fi
}

# make_root SUITE ROOT: a bare system of this release, made by debootstrap unless it is there. Its log is ROOT.log.
make_root() {
  if [ -f "$2/.ngs-whole" ]; then return; fi
  command -v debootstrap > /dev/null || skip "no debootstrap (Debian: debootstrap)"
  mkdir -p "$2"
  rm -rf "${2:?}"/*
  debootstrap --variant=minbase "$1" "$2" "${NGS_DEBIAN_MIRROR:-http://deb.debian.org/debian}" > "$2.log" 2>&1 ||
    skip "debootstrap failed, see $2.log"
  touch "$2/.ngs-whole"
}

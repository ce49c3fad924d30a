# shellcheck shell=bash
# Reads the options of ../bundle.sh and windows.sh. Sets work (downloads and builds), out (where the results are written),
# setup (empty: do not install packages), variant (-cuda: with CUDA, bundle.sh only).
# shellcheck disable=SC2034,SC2154  # variables of the caller
work=$top/build-bundle out='' setup=1 variant=''
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage_of "$0"; exit 0 ;;
    -o | --output) need "$@"; out=$2; shift 2 ;;
    --no-setup) setup=''; shift ;;
    --cuda) variant=-cuda; shift ;;
    *) fail 2 "unknown word '$1'" "see $0 --help" ;;
  esac
done
out=${out:-$work}

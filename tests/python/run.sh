#!/usr/bin/env bash
# Tests the Python module with the built tools, and a wheel of a small bundle: equal bytes, installation without network,
# programs in PATH, removal.
#
#   tests/python/run.sh OUT_DIR        tools: $NGS_BIN, else build/bin
#
# Exit code 77 if python3 or its module venv is absent.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

out=$1 bin=$(find_bin)
skip() { say "SKIP $*"; exit 77; }
command -v python3 > /dev/null || skip "python3 is absent"
rm -rf "$out"
mkdir -p "$out/site" "$out/bundle/bin" "$out/bundle/share/ngs" "$out/bundle/licences" "$out"/wheels/{first,second}
out=$(cd "$out" && pwd)
export PYTHONDONTWRITEBYTECODE=1 SOURCE_DATE_EPOCH=1700000000

cp -R "$pipelines/python/ngs" "$out/site/"
ln -s "$bin" "$out/site/ngs/bin"
python3 "$top/tests/python/module_test.py" "$out/site" -v

# shellcheck disable=SC2016  # expanded by the program
printf '#!/bin/sh\necho "${0##*/}: $*"\n' > "$out/bundle/bin/ngs"
chmod +x "$out/bundle/bin/ngs"
ln -s ngs "$out/bundle/bin/ngs-joint"
echo '{}' > "$out/bundle/share/ngs/a.json"
echo licence > "$out/bundle/licences/ngs"
for wheel in first second; do
  python3 "$pipelines/bundle/wheel.py" "$out/bundle" "$pipelines/python" 1.2.3 linux_x86_64 "$out/wheels/$wheel" > /dev/null
done
wheel=ngs_tools-1.2.3-py3-none-linux_x86_64.whl
cmp "$out"/wheels/{first,second}/$wheel

python3 -m venv "$out/venv" > "$out/venv.log" 2>&1 || skip "python3 -m venv failed, see $out/venv.log (Debian: python3-venv)"
files() { find "$out/venv" | LC_ALL=C sort; }
files > "$out/before"
case $(uname -m) in x86_64) ;; *) skip "the wheel is for x86_64" ;; esac
"$out/venv/bin/pip" install -q --no-index --no-compile --disable-pip-version-check "$out/wheels/first/$wheel"
found=$("$out/venv/bin/ngs-joint" a 'b c'; "$out/venv/bin/ngs" cut)
[ "$found" = $'ngs: ngs-joint a b c\nngs: cut' ] || fail 1 "the installed programs printed: $found"
"$out/venv/bin/python" -c 'import ngs; ngs.run, ngs.read_ply, ngs.Error'
"$out/venv/bin/pip" uninstall -q -y --disable-pip-version-check ngs-tools
files | diff "$out/before" - || fail 1 "files are left after pip uninstall"
say "ok: module and wheel"

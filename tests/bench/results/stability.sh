# stability: the worst rounding errors of every kernel over hard inputs
# shellcheck shell=bash disable=SC2154
question_stability() {
  title 'Errors against long double in units of eps · condition · |value|'
  without_options
  label kernel kernel
  column cases '' cases mean 0
  column 'of them exact' '' exact mean 0
  column 'worst ratio of the others' '' worst_ratio mean 2g
  column 'beyond their budgets' '' failed mean 0
  column 'textbook forms' '' textbook mean 0
  column 'of them wrong' '' textbook_wrong mean 0
  column 'worst ratio of the others' '' textbook_ratio mean 2g
  if [ ! -f "$work/stability.json" ]; then
    rm -rf "$work/part"
    NGS_BIN=$bin "$top/tests/bench/stability.sh" "$work/part" >&2
    mv "$work/part/stability.json" "$work/"
  fi
  line rows stability "$work/stability.json"
}

# goals: targets, and whether the other results reach them
# shellcheck shell=bash disable=SC2154
question_goals() {
  title 'Aims against the other results'
  label goal goal
  label aim aim
  label measured measured
  label met met
  local key
  for key in commit machine defaults; do line meta "$key" "$(head_of captures "$key")"; done
  line meta command 'tests/bench/results.sh goals'
  goal 'B-IoU 0.005 of ngs above flash, bird, mean of the splits' '>=' 0.06 \
    "$(difference captures biou_005 $'set=bird\tmethod=ngs' $'set=bird\tmethod=flash')"
  goal 'B-IoU 0.02 of ngs on bird, every:4:2: half-way from flash to 1' '>=' 0.965 \
    "$(number captures biou mean method=ngs set=bird run=every:4:2)"
  goal 'B-IoU 0.005 of ngs with floaters' '>=' 0.65 "$(number captures biou_005 mean method=ngs set=floaters)"
  goal 'B-IoU 0.02 of ngs above cob, mean of the recipes' '>=' 0.056 "$(difference recipes biou method=ngs method=cob)"
  goal 'B-IoU 0.005 that standard loses to reference' '<=' 0.003 \
    "$(difference qualities biou_005 method=reference method=standard)"
  goal 'standard on bird, wall s' '<=' 60 "$(number qualities wall_s mean method=standard)"
  goal 'everything on against auto, bird, wall' '>=' 3 \
    "$(quotient effects wall_s $'scene=bird\tmethod=everything on' $'scene=bird\tmethod=auto')"
  goal 'B-IoU 0.005 of ngs above flash in novel views, mean of the recipes and bird' '>=' 0.06 \
    "$(difference removed biou_005 $'score=novel\tmethod=ngs' $'score=novel\tmethod=flash')"
  goal 'the same in removed views, whose photos the splat has seen' '>=' 0.06 \
    "$(difference removed biou_005 $'score=inductive\tmethod=ngs' $'score=inductive\tmethod=flash')"
  goal 'ngs-scene import on museum, wall s' '<=' 15 \
    "$(number museum wall_s median 'tool=ngs-scene import' objects=1)"
  goal 'ngs-variance on museum, wall s' '<=' 5 "$(number museum wall_s median tool=ngs-variance objects=1)"
  goal 'draft on museum, wall s' '<=' 12 "$(number museum wall_s median 'tool=ngs-joint --quality draft' objects=1)"
  goal 'standard on museum, wall s' '<=' 75 "$(number museum wall_s median tool=ngs-joint objects=1)"
  goal 'draft of nine objects of museum, wall s' '<=' 36 \
    "$(number museum wall_s median 'tool=ngs-joint --quality draft' objects=9)"
  goal 'cases of stability beyond their budgets' '<=' 0 "$(number stability failed most)"
}

# goal SENTENCE '>='|'<=' AIM MEASURED: prints the row.
goal() {
  [ -n "$4" ] || fail 5 "$1: not measured"
  awk -v goal="$1" -v how="$2" -v aim="$3" -v measured="$4" 'BEGIN {
    met = how == ">=" ? measured >= aim : measured <= aim
    bound = how == ">=" ? "at least" : "at most"
    printf "row\tgoal=%s\taim=%s %s\tmeasured=%.4g\tmet=%s\n", goal, bound, aim, measured, met ? "yes" : "**no**"
  }'
}

head_of() { sed -n "s/^  \"$2\": \"\(.*\)\",\$/\1/p" "$results/$1.json"; }  # QUESTION KEY
number() { tables value "$results/$1.json" "${@:2}"; }           # QUESTION KEY SHOW KEY=VALUE...

# difference|quotient QUESTION KEY THESE THOSE (conditions separated by tabs): mean under THESE minus mean under THOSE;
# median under THESE divided by median under THOSE.
difference() { compared mean 'a - b' "$@"; }
quotient() { compared median 'a / b' "$@"; }
compared() {
  local these those
  IFS=$'\t' read -ra these <<< "$5"
  IFS=$'\t' read -ra those <<< "$6"
  awk -v a="$(number "$3" "$4" "$1" "${these[@]}")" -v b="$(number "$3" "$4" "$1" "${those[@]}")" \
    "BEGIN { printf \"%.10g\", $2 }"
}

# removed: views without photo, views unknown to the splat too, and views with only the mask held out
# shellcheck shell=bash disable=SC2154
question_removed() {
  title 'B-IoU 0.005, every:4:2, the recipes below and bird'
  label method method
  local recipe method runs=()
  for recipe in $recipes bird; do column "novel: $recipe" '' biou_005 mean 4 views="novel, $recipe"; done
  column 'mean novel' '' biou_005 mean 4 score=novel
  column 'mean removed' '' biou_005 mean 4 score=inductive
  column 'mean with photos' '' biou_005 mean 4 score=transductive
  for method in flash cob bce ngs; do
    if wanted "$method"; then runs+=(--run "$method=--method $method"); fi
  done
  # shellcheck disable=SC2086
  NGS_BIN=$bin "$top/tests/bench/removed-views.sh" -o "$work/scenes" --novel "${runs[@]}" $recipes "$(capture bird)" > "$work/lines"
  awk -F '\t' -v OFS='\t' '$2 != "mean" {
    print "row", "method=" $3, "views=" $5 ", " $1, "score=" $5, "run=" $2 " " $4, "biou_005=" $8
  }' "$work/lines"
}

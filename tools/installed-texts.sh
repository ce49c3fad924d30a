#!/usr/bin/env bash
# Writes pages for man, and completions for bash, zsh and fish, from what the tools say of their options:
#   tools/installed-texts.sh BIN_DIR OUT_DIR        OUT_DIR/man/man1/TOOL.1, OUT_DIR/bash/TOOL, OUT_DIR/zsh/_ngs,
#                                                   OUT_DIR/fish/TOOL.fish
# shellcheck disable=SC2016  # what is written is for other shells to expand
set -euo pipefail
unset CDPATH
shopt -s extglob
bin=$1 out=$2
export COLUMNS=78 LC_ALL=C.UTF-8

rm -rf "$out"
mkdir -p "$out/man/man1" "$out/bash" "$out/zsh" "$out/fish"
tools=()
for file in "$bin"/ngs "$bin"/ngs-*; do
  name=${file##*/}
  case $name in ngs-probe | *.*) ;; *) tools+=("$name") ;; esac
done

# What the tools say, asked once: of a tool its commands, a line each (an empty one for what runs without a command),
# and their words; of "TOOL COMMAND" the help, all flags, and "--flag) words".
declare -A commands named help flags values
flags_in() {  # flags_in HELP SCHEMA
  {
    sed -n '/^inputs and outputs/,/^$/p' <<< "$1" | grep -oE '^ +(-[a-z], )?--[a-z0-9-]+(, --[a-z0-9-]+)*' |
      grep -oE -- '--[a-z0-9-]+' || true
    sed -n '/^flags of all tools/,/^$/p' <<< "$1" | grep -oE -- '--[a-z0-9-]+'
    awk '
      /^    "[a-z0-9_]+": \{/ { name = $1; gsub(/[":]/, "", name); gsub(/_/, "-", name); print "--" name }
      /^      "type": "boolean"/ { print "--no-" name }' <<< "$2"
  } | sort -u | tr '\n' ' '
}
values_in() {  # values_in SCHEMA
  awk '
    /^    "[a-z0-9_]+": \{/ { name = $1; gsub(/[":]/, "", name); gsub(/_/, "-", name) }
    /^      "enum": \[/ { inside = 1; words = ""; next }
    inside && /\]/ { inside = 0; printf "--%s) ngs_words=\"%s\" ;; ", name, substr(words, 2); next }
    inside { gsub(/[" ,]/, ""); words = words " " $0 }' <<< "$1"
  echo '--device) ngs_words="auto cpu cuda" ;; --log-level) ngs_words="error warning info" ;; --log-format) ngs_words="text json" ;;'
}
for tool in "${tools[@]}"; do
  commands[$tool]=$("$bin/$tool" --print-commands; echo .)  # what $() would remove at the end stays
  commands[$tool]=${commands[$tool]%$'\n.'}
  words=${commands[$tool]//$'\n'/ } words=${words# }
  named[$tool]=${words% }
  while read -r command; do
    help[$tool $command]=$("$bin/$tool" ${command:+"$command"} --help all)
    schema=$("$bin/$tool" ${command:+"$command"} --print-schema)
    flags[$tool $command]=$(flags_in "${help[$tool $command]}" "$schema")
    values[$tool $command]=$(values_in "$schema")
  done <<< "${commands[$tool]}"
done

# about TOOL COMMAND: "what it is", from the first line of the help.
about() { "$bin/$1" ${2:+"$2"} -h | sed '/^$/,$d' | tr -s '\n ' '  ' | sed 's/^[^:]*: *//; s/\.* *$//'; }

roff() { sed -e 's/\\/\\e/g' -e 's/-/\\-/g' -e "s/^[.']/\\\\\&&/"; }
page() {  # page TOOL
  local tool=$1 command version summary
  version=$("$bin/$tool" --version --json | sed -n 's/.*"version": "\(.*\)".*/\1/p')
  summary=$(about "$tool" "${commands[$tool]%%$'\n'*}")
  printf '.TH %s 1 "" "ngs %s" "ngs"\n.SH NAME\n%s \\- %s\n' "${tool^^}" "$version" \
    "$(roff <<< "$tool")" "$(roff <<< "$summary")"
  while read -r command; do
    printf '.SH %s\n.nf\n' "$(title="${command:-description}"; echo "${title^^}")"
    roff <<< "${help[$tool $command]}"
    printf '.fi\n'
  done <<< "${commands[$tool]}"
  printf '.SH SEE ALSO\n'
  printf '%s\n' "${tools[@]}" | grep -vx "$tool" | roff | sed 's/.*/.BR & (1),/; $s/,$//'
}

# fish TOOL: a line per option. Where no words are named fish completes paths.
fish() {
  local tool=$1 command named_words when flag
  declare -A words
  echo "# Completion of $tool, written from its options."
  if [ -n "${named[$tool]}" ]; then
    printf "complete -c %s -n 'not __fish_seen_subcommand_from %s'%s -a '%s'\n" "$tool" "${named[$tool]}" \
      "$(grep -q '^$' <<< "${commands[$tool]}" || echo ' -f')" "${named[$tool]}"
  fi
  while read -r command; do
    if [ -n "$command" ]; then when=" -n '__fish_seen_subcommand_from $command'"
    elif [ -n "${named[$tool]}" ]; then when=" -n 'not __fish_seen_subcommand_from ${named[$tool]}'"
    else when=''; fi
    words=()
    while IFS='|' read -r flag named_words; do words[$flag]=$named_words; done < <(
      sed -n 's/^\(--[^)]*\)) ngs_words="\(.*\)"$/\1|\2/p' <<< "${values[$tool $command]// ;;*( )/$'\n'}")
    for flag in ${flags[$tool $command]}; do
      printf 'complete -c %s%s -l %s%s\n' "$tool" "$when" "${flag#--}" "${words[$flag]:+ -x -a '${words[$flag]}'}"
    done
  done <<< "${commands[$tool]}"
}

# table NAME TOOL...: what bash and zsh ask. NAME TOOL COMMAND BEFORE CURRENT PLACE sets ngs_words; empty: a path is expected.
table() {
  local name=$1 tool command
  shift
  echo "$name() {"
  echo '  ngs_words='
  for tool in "$@"; do
    echo "  if [ \"\$1\" = $tool ]; then"
    echo '    case $2 in'
    while read -r command; do
      # without a command it takes what any other word in its place may be
      printf '      %s)\n        case $3 in %s *) case $4 in -*) ngs_words="%s" ;; esac ;; esac ;;\n' "${command:-*}" \
        "${values[$tool $command]}" "${flags[$tool $command]}"
    done <<< "${commands[$tool]}" | { first=; while IFS= read -r line; do  # the pattern that takes all goes last
        if [ "$line" = '      *)' ]; then IFS= read -r next; first=$line$'\n'$next; else printf '%s\n' "$line"; fi
      done; if [ -n "$first" ]; then printf '%s\n' "$first"; fi; }
    echo '    esac'
    if [ -n "${named[$tool]}" ]; then
      echo "    if [ \"\$5\" = 1 ] && [ -z \"\$ngs_words\" ]; then ngs_words=\"${named[$tool]}\"; fi"
    fi
    echo '  fi'
  done
  echo '}'
}

for tool in "${tools[@]}"; do
  function=_${tool//-/_}
  page "$tool" > "$out/man/man1/$tool.1"
  {
    echo "# Completion of $tool, written from its options."
    table "${function}_words" "$tool"
    cat << END
$function() {
  local ngs_words current=\${COMP_WORDS[COMP_CWORD]} before=\${COMP_WORDS[COMP_CWORD-1]}
  ${function}_words $tool "\${COMP_WORDS[1]:-}" "\$before" "\$current" "\$COMP_CWORD"
  mapfile -t COMPREPLY < <(compgen -W "\$ngs_words" -- "\$current")
}
complete -o default -F $function $tool
END
  } > "$out/bash/$tool"
  fish "$tool" > "$out/fish/$tool.fish"
done
{
  echo "#compdef ${tools[*]}"
  table _ngs_words "${tools[@]}"
  cat << 'END'
local ngs_words
_ngs_words "$service" "${words[2]}" "${words[CURRENT-1]}" "${words[CURRENT]}" "$((CURRENT - 1))"
if [ -n "$ngs_words" ]; then compadd -- ${=ngs_words}; else _files; fi
END
} > "$out/zsh/_ngs"

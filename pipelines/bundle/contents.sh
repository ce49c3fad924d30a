# shellcheck shell=bash
# Pages, licences and the list of contents of an archive, for ../bundle.sh and windows.sh. Variables of the caller: top,
# pipelines, and work, whose sources/ libraries.sh has filled.

# Times in an archive: that of the commit.
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -C "$top" log -1 --format=%ct 2> /dev/null || stat -c %Y "$top/CHANGELOG.md")}
export SOURCE_DATE_EPOCH

# add_contents STAGE VERSION COMPONENTS...: into the folder of an archive.
add_contents() {
  local stage=$1 version=$2 page component words package
  local components=("${@:3}")
  local doc=$stage/share/doc/ngs
  for page in $(cd "$top" && ls -d README.md BENCHMARKS.md docs/*.md docs/images docs/decisions tools/*.md tools/*/*.md \
    pipelines/README.md data-schema/*.md); do
    mkdir -p "$doc/$(dirname "$page")"
    cp -R "$top/$page" "$doc/$page"
  done
  mkdir -p "$stage/licences"
  cp "$top/LICENSE" "$stage/licences/ngs"
  while read -r component words; do
    package=${words##* }
    case $package in
      cuda) cp "$work/sources/$component/licence" "$stage/licences/$component" ;;
      source) cp "$work/sources/$component/tree/debian/copyright" "$stage/licences/$component" ;;
      *) cp "/usr/share/doc/$package/copyright" "$stage/licences/$component" ;;
    esac
  done < <(cat "${components[@]}" | grep -v '^#')
  python3 "$pipelines/bundle/sbom.py" "$work/sources" "$version" "${components[@]}" > "$stage/sbom.spdx.json"
}

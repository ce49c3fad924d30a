#!/usr/bin/env bash
# Compatibility checks with other programs, which open, filter, render and edit the tools' files. One line per check: ok, FAIL,
# or SKIP with the missing program.
#
#   tests/clients/run.sh [OUT_DIR] [--quick] [--only REGEX]
#
#   --quick  only checks without network, larger scenes and browser; the ctest test `clients`
#
# npm programs are installed from package-lock.json into OUT_DIR (default: build/clients). Tools: $NGS_BIN, else build/bin.
# Exit code 1 if a check failed, 77 if all were skipped.
set -uo pipefail
unset CDPATH
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
bin=${NGS_BIN:-$root/build/bin}
out=$root/build/clients quick='' only=.
while [ $# -gt 0 ]; do
  case $1 in
    --quick) quick=1; shift ;;
    --only) only=$2; shift 2 ;;
    *) out=$1; shift ;;
  esac
done
mkdir -p "$out"
out=$(cd "$out" && pwd)
export NGS_BIN=$bin XDG_RUNTIME_DIR=/tmp QT_QPA_PLATFORM=offscreen VK_ICD_FILENAMES=/usr/lib/chromium/vk_swiftshader_icd.json
modules=$out/node_modules
transform=$modules/.bin/splat-transform

passed=0 failed=0 skipped=0
ok() { printf 'ok   %s: %s\n' "$check" "$*"; passed=$((passed + 1)); }
bad() { printf 'FAIL %s: %s\n' "$check" "$*"; failed=$((failed + 1)); }
skip() { printf 'SKIP %s: %s\n' "$check" "$*"; skipped=$((skipped + 1)); }
# require PROGRAM PACKAGE: prints SKIP and returns false if the program is absent.
require() { command -v "$1" > /dev/null && return; skip "$1 is absent, Debian package $2"; return 1; }
ply() { node "$here/ply.mjs" "$@"; }
tool() { "$bin/$1" "${@:2}" -w -q > /dev/null; }
# expect WHAT FOUND WANTED
expect() { if [ "$2" = "$3" ]; then ok "$1: $2"; else bad "$1: $2, expected $3"; fi; }

npm_install() {
  require npm npm || return 1
  if [ -x "$transform" ] && cmp -s "$here/package-lock.json" "$out/package-lock.json"; then return; fi
  [ -z "$quick" ] || { skip "the npm programs are not installed, tests/ci/clients.sh installs them"; return 1; }
  cp "$here/package.json" "$here/package-lock.json" "$out/"
  (cd "$out" && timeout 600 npm ci --legacy-peer-deps --no-audit --no-fund > npm.log 2>&1) ||
    { rm -f "$out/package-lock.json"; skip "npm ci failed, see $out/npm.log"; return 1; }
}

# A synthetic capture with exact ground truth, segmented once; input of all checks below.
make_run() {
  if [ -f "$out/run/report.html" ]; then return; fi
  tool ngs-synth two-spheres -o "$out/scene" --view-count 8 --width-px 96 --height-px 72 --fit-steps 120 --fit-max-gaussians 1500 \
    --mask-noise jitter:1 &&
    SAMPLE_FLAGS='--rows 16 --cols 16' "$root/pipelines/ngs-gs.sh" "$out/scene" "$out/run" --hold-out every:4:2 --quality draft -q &&
    tool ngs-extract "$out/run/labelled.ply" --labelled "$out/decided.ply" --supersplat "$out/edit_me.ply"
}

check_transform() {
  npm_install || return
  "$transform" -q -w "$out/decided.ply" -V ngs_label,gte,0.5 "$out/cut.ply" 2> /dev/null
  expect "Gaussians after -V ngs_label,gte,0.5, as in object.ply" "$(ply count "$out/cut.ply")" "$(ply count "$out/run/object.ply")"
  expect "columns with equal bytes" "$(ply same "$out/run/object.ply" "$out/cut.ply" 2>&1)" 26
  local model
  for model in run/object run/background run/boundary run/labelled decided edit_me; do
    "$transform" -q -w "$out/$model.ply" "$out/round.ply" 2> /dev/null
    expect "columns kept after reading and writing ${model#run/}.ply" "$(ply same "$out/$model.ply" "$out/round.ply" 2>&1)" \
      "$(grep -a -c '^property' "$out/$model.ply")"
  done
}

check_supersplat() {
  npm_install || return
  expect "edit_me.ply has a column state of bytes" "$(grep -a -c '^property uchar state$' "$out/edit_me.ply")" 1
  expect "rows selected in edit_me.ply" "$(ply equal-to "$out/edit_me.ply" state 1)" "$(ply count "$out/run/object.ply")"
  # Like an export of the editor: reordered (Morton), without ngs columns, with half of the object deleted.
  local middle method left
  middle=$(ply median "$out/run/object.ply" f_dc_0)
  "$transform" -q -w "$out/run/object.ply" -V "f_dc_0,gte,$middle" -m "$out/edited.ply" 2> /dev/null
  left=$(ply count "$out/edited.ply")
  tool ngs-extract "$out/run/labelled.ply" --import "$out/edited.ply" --labelled "$out/corrected.ply" --object-ply "$out/kept.ply"
  expect "--import of $left of $(ply count "$out/run/object.ply") rows, reordered, without our columns: object" "$(ply count "$out/kept.ply")" "$left"
  for method in flash bce ng-gs; do  # without contours these methods keep the number of rows
    tool ngs-joint "$out/run/scene.json" "$out/corrected.ply" --method $method --quality draft --effect contours=off -o "$out/next.ply"
    expect "--method $method keeps the rows fixed by hand" "$(ply fixed "$out/corrected.ply" "$out/next.ply" 2>&1)" \
      "$(ply equal-to "$out/corrected.ply" ngs_fixed 1)"
  done
}

# within WHAT A B LIMITS...: compares two models; the limits are the quantisation errors of the format.
within() {
  local differences
  if differences=$(node "$here/formats.mjs" "${@:2}" 2>&1); then ok "$1: $differences"; else bad "$1: $differences; limits ${*:4}"; fi
}

# Other splat formats: our files read by splat-transform, and its files read by ngs. Limits: position, ln scale, opacity, f_dc,
# f_rest, axes. splat-transform does not rotate an .spz to y up, so -r does.
check_formats() {
  npm_install || return
  local folder=$out/formats format turn
  rm -rf "$folder"
  mkdir -p "$folder"
  for format in spz sog splat compressed.ply glb; do
    local model=$folder/ours.$format
    tool ngs-extract "$out/run/labelled.ply" --object-ply "$model"
    if [ $format = glb ]; then
      "$transform" -q -w "$out/run/object.ply" "$folder/theirs.glb" 2> /dev/null
      within 'our .glb and that of splat-transform' "$folder/theirs.glb" "$model" 0 1e-6 1e-6 0 0 1e-5
      continue
    fi
    turn=()
    [ $format = spz ] && turn=(-r 180,0,0)
    "$transform" -q -w "$model" "${turn[@]}" "$folder/ours-$format.ply" 2> /dev/null
    within "our .$format read by splat-transform, and the PLY" "$out/run/object.ply" "$folder/ours-$format.ply" \
      $(limits_of $format)
    "$transform" -q -w -g cpu "$out/run/object.ply" "${turn[@]}" "$folder/theirs.$format" 2> /dev/null
    "$transform" -q -w "$folder/theirs.$format" "${turn[@]}" "$folder/theirs-$format.ply" 2> /dev/null
    tool ngs-extract "$folder/theirs.$format" --keep-sphere 0,0,0,1e9 --object-ply "$folder/theirs-$format-ours.ply"
    within "the .$format of splat-transform, read by ngs and by splat-transform" "$folder/theirs-$format.ply" \
      "$folder/theirs-$format-ours.ply" 1e-6 1e-5 2e-6 1e-5 1e-6 "$([ $format = splat ] && echo 0.02 || echo 1e-5)"
  done
  tool ngs-extract "$out/run/labelled.ply" --object-ply "$folder/ours.usda"
  within 'our .usda read by the parser of three, and the PLY' "$out/run/object.ply" "$folder/ours.usda" 1e-6 1e-6 1e-6 1e-6 1e-6 1e-5 \
    "$modules"
  check_ksplat "$folder"
}

# .ksplat, which splat-transform only reads: written by the viewer that defines it, read by both, at each compression level.
check_ksplat() {
  local level
  for level in 0 1 2; do
    local model=$1/level-$level.ksplat
    node "$here/ksplat.mjs" "$out/run/object.ply" "$model" "$level" "$modules" > /dev/null 2>&1
    "$transform" -q -w "$model" "$1/level-$level-theirs.ply" 2> /dev/null
    tool ngs-extract "$model" --keep-sphere 0,0,0,1e9 --object-ply "$1/level-$level-ours.ply"
    within "mkkellogg's .ksplat of compression $level, read by ngs and by splat-transform" \
      "$1/level-$level-theirs.ply" "$1/level-$level-ours.ply" 1e-6 1e-5 2e-6 1e-5 1e-6 1e-5
    within "mkkellogg's .ksplat of compression $level, read by ngs, and the PLY" "$out/run/object.ply" "$1/level-$level-ours.ply" 1e-4 1e-3 0.00394 4 0.0157 0.001
  done
}

# Half a step of every attribute (docs/formats.md); for codebooks a step of 1/255 of the range. The axes of an ellipsoid
# rotate by at most twice the error of its quaternion, which may affect three components.
limits_of() {
  case $1 in
    spz) echo 7.7e-6 0.0313 0.00197 0.0131 0.0040 0.01 ;;
    sog) echo 1e-4 0.05 0.00197 0.03 0.02 0.03 ;;
    splat) echo 0 1e-6 0.00197 4 0 0.03 ;;  # .splat clamps colours to 0..1
    compressed.ply) echo 0.01 0.01 0.00197 0.01 0.0157 0.01 ;;
  esac
}

check_render() {
  npm_install || return
  require dwebp webp && require oiiotool openimageio-tools || return
  [ -f "$VK_ICD_FILENAMES" ] || { skip "no Vulkan driver without a GPU, Debian package chromium"; return; }
  # splat-transform subtracts e^-4.5 from every footprint, so that it ends at 3 sigma; the reference does not. Both variants are
  # compared: with that constant set to 0, and unchanged.
  local package=$modules/@playcanvas/splat-transform recipe
  sed 's/^const GAUSSIAN_FLOOR = .*/const GAUSSIAN_FLOOR = 0;/' "$package/dist/cli.mjs" > "$package/dist/cli-reference.mjs"
  sed 's/cli.mjs/cli-reference.mjs/' "$package/bin/cli.mjs" > "$package/bin/cli-reference.mjs"
  for recipe in two-spheres torus-box leaves; do
    local folder=$out/render/$recipe
    if [ ! -f "$folder/object.ply" ]; then
      mkdir -p "$folder"
      tool ngs-synth "$recipe" -o "$folder/scene" --view-count 6 --width-px 320 --height-px 240 --fit-steps 300 --fit-max-gaussians 4000
      tool ngs-scene import "$folder/scene" --ply "$folder/scene/point_cloud.ply" --images "$folder/scene/images" \
        --masks "$folder/scene/masks" --no-align-views -o "$folder/scene.json"
      tool ngs-variance "$folder/scene.json" -o "$folder/boundary.ply"
      tool ngs-extract "$folder/boundary.ply" --object-ply "$folder/object.ply"
    fi
    node "$here/cameras.mjs" "$folder/scene.json" 6 "$folder/own"
    tool ngs-render "$folder/own.scene.json" "$folder/scene/point_cloud.ply" --layers color -o "$folder/ngs"
    tool ngs-render "$folder/own.scene.json" "$folder/object.ply" --layers alpha -o "$folder/ngs-alpha"
    pictures cli-reference "$folder/scene/point_cloud.ply" whole
    pictures cli-reference "$folder/object.ply" object
    pictures cli "$folder/scene/point_cloud.ply" whole
    local worst least
    worst=$(worst_psnr cli-reference)
    tool ngs-eval "$folder/ngs-alpha" "$folder/cli-reference-object" -o "$folder/silhouettes.json"
    least=$(tr -d ' \n' < "$folder/silhouettes.json" | sed 's/.*"views"//' | grep -o '"iou":[0-9.]*' | cut -d: -f2 | sort -n | head -1)
    local result="$recipe, 6 views: PSNR at least $worst dB (unchanged constant: $(worst_psnr cli)), silhouette IoU at least $least"
    if awk -v p="$worst" -v i="$least" 'BEGIN { exit !(p >= 40 && i >= 0.99) }'; then ok "$result"; else bad "$result"; fi
  done
}

# pictures PROGRAM MODEL NAME: six views rendered by splat-transform, RGBA over black, as PNG; for `object` only alpha.
pictures() {
  local to=$folder/$1-$3 view channels=R,G,B
  [ "$3" = object ] && channels=A
  rm -rf "$to"
  mkdir -p "$to"
  node "$package/bin/$1.mjs" -q -w "$2" "$to/x.webp" --camera-track "$folder/own.track.json" --resolution 320x240 \
    --background 0,0,0,0 > "$folder/$1-$3.log" 2>&1
  for view in 0000 0001 0002 0003 0004 0005; do
    dwebp -quiet "$to/x.$view.webp" -o "$to/rgba.png"
    oiiotool "$to/rgba.png" --ch $channels -o "$to/$view.png"
    rm "$to/x.$view.webp" "$to/rgba.png"
  done
}

worst_psnr() {
  local view
  for view in 0000 0001 0002 0003 0004 0005; do
    idiff -a "$folder/$1-whole/$view.png" "$folder/ngs/$view.png" | sed -n 's/.*Peak SNR = //p'
  done | sort -n | head -1
}

check_viewers() {
  npm_install || return
  require chromium chromium || return
  local models=() model line
  for model in object background labelled; do models+=("$out/run/$model.ply=$(ply count "$out/run/$model.ply")"); done
  models+=("$out/edit_me.ply=$(ply count "$out/edit_me.ply"),$(ply count "$out/run/object.ply")")
  mkdir -p "$out/screenshots"
  while read -r line; do
    case $line in ok*) ok "${line#ok}" ;; *) bad "${line#FAIL}" ;; esac
  done < <(timeout 900 node "$here/view.mjs" "$modules" "$out/screenshots" "$out/run/scene.json" 0 "${models[@]}" 2>&1)
  ok "screenshots are in $out/screenshots"
}

check_colmap_text() {
  require colmap colmap && require node nodejs || return
  local model=$out/colmap
  rm -rf "$model"
  mkdir -p "$model/bin" "$model/txt"
  { colmap model_converter --input_path "$out/scene/sparse/0" --output_path "$model/bin" --output_type BIN &&
    colmap model_converter --input_path "$model/bin" --output_path "$model/txt" --output_type TXT; } > "$model/log" 2>&1 ||
    { bad "model_converter failed, see $model/log"; return; }
  tool ngs-scene import "$model/bin" --ply "$out/scene/point_cloud.ply" --images "$out/scene/images" --masks "$out/scene/masks" \
    --no-align-views -o "$model/scene.json"
  local worst
  if worst=$(node "$here/colmap-text.mjs" "$model/txt" "$model/scene.json" 1e-12 2>&1); then ok "binary model read by ngs, and model_converter's text: $worst"
  else bad "binary model read by ngs, and model_converter's text: $worst"; fi
}

check_colmap_masks() {
  require colmap colmap && require python3 python3 && require oiiotool openimageio-tools || return
  local folder=$out/colmap-masks
  rm -rf "$folder"
  mkdir -p "$folder"
  tool ngs-render "$out/run/scene.json" "$out/run/labelled.ply" --scale 0 --names image -o "$folder/masks"
  local way mask
  for mask in "$folder"/masks/*; do oiiotool "$mask" --ch 0 -o "$folder/masks/$(basename "$mask" .png).pgm"; done
  for way in all masked; do
    colmap feature_extractor --database_path "$folder/$way.db" --image_path "$out/scene/images" --SiftExtraction.use_gpu 0 \
      --SiftExtraction.peak_threshold 0.002 $([ $way = masked ] && printf -- '--ImageReader.mask_path %s' "$folder/masks") > "$folder/$way.log" 2>&1
  done
  local before after
  before=$(python3 "$here/features.py" "$folder/all.db" "$folder/masks") after=$(python3 "$here/features.py" "$folder/masked.db" "$folder/masks")
  local result="COLMAP features on the object and outside: $before; with the masks of ngs-render --names image: $after"
  if [ "${after#* }" -eq 0 ] && [ "${after% *}" -gt 0 ] && [ "${before#* }" -gt 0 ]; then ok "$result"; else bad "$result"; fi
}

# Only photos and masks as input: COLMAP computes the poses, ngs does the rest. For comparison the same with exact poses.
check_colmap_loop() {
  require colmap colmap || return
  local folder=$out/colmap-loop
  rm -rf "$folder"
  mkdir -p "$folder/sparse"
  echo '{"scene": "torus-box", "views": 36, "width_px": 480, "height_px": 360, "principal_shift": 0, "gloss": 0}' > "$folder/recipe.json"
  tool ngs-synth "$folder/recipe.json" --no-fit -o "$folder/scene"
  { colmap feature_extractor --database_path "$folder/colmap.db" --image_path "$folder/scene/images" --ImageReader.single_camera 1 \
      --ImageReader.camera_model PINHOLE --SiftExtraction.use_gpu 0 --SiftExtraction.peak_threshold 0.001 &&
    colmap exhaustive_matcher --database_path "$folder/colmap.db" --SiftMatching.use_gpu 0 &&
    colmap mapper --database_path "$folder/colmap.db" --image_path "$folder/scene/images" --output_path "$folder/sparse" \
      --Mapper.init_min_num_inliers 40; } > "$folder/log" 2>&1 || { bad "COLMAP found no poses, see $folder/log"; return; }
  local found exact registered
  registered=$(colmap model_analyzer --path "$folder/sparse/0" 2>&1 | sed -n 's/.*Registered images: //p')
  found=$(cut_from "$folder/sparse/0" points3D.bin) exact=$(cut_from "$folder/scene/sparse/0" points3D.txt)
  local result="poses of $registered of 36 photos; held-out views, IoU and boundary IoU 0.02: $found (exact poses: $exact)"
  if awk -v f="$found" 'BEGIN { split(f, v, " "); exit !(v[1] >= 0.97 && v[2] >= 0.93) }'; then ok "$result"; else bad "$result"; fi
}

# cut_from SPARSE POINTS: IoU and boundary IoU of the complete chain, from poses to masks.
cut_from() {
  local to
  to=$(mktemp -d "$folder/cut.XXXXXX")
  tool ngs-scene import "$1" --images "$folder/scene/images" -o "$to/photos.json" &&
    tool ngs-fit "$to/photos.json" --points "$1/$2" --steps 1500 --max-gaussians 8000 --sh-degree 1 -o "$to/model.ply" &&
    tool ngs-scene import "$1" --ply "$to/model.ply" --images "$folder/scene/images" --masks "$folder/scene/masks" \
      --hold-out every:4:2 -o "$to/scene.json" &&
    tool ngs-variance "$to/scene.json" -o "$to/boundary.ply" &&
    tool ngs-joint "$to/scene.json" "$to/boundary.ply" --quality draft -o "$to/labelled.ply" &&
    tool ngs-render "$to/scene.json" "$to/labelled.ply" --views held-out --layers mask --scale 0 -o "$to/masks" &&
    tool ngs-eval "$to/masks" "$folder/scene/masks_gt" -o "$to/metrics.json" &&
    tr -d ' \n' < "$to/metrics.json" | grep -o '"mean":{[^}]*' | sed 's/.*"iou":\([0-9.]*\).*"biou":\([0-9.]*\).*/\1 \2/'
}

check_exr() {
  require oiiotool openimageio-tools && require exrheader openexr || return
  tool ngs-render "$out/run/scene.json" "$out/run/labelled.ply" --layers color,mask,alpha,depth,labels --format exr -o "$out/exr"
  local file wrong=0 files=0
  for file in "$out"/exr/*.exr; do
    files=$((files + 1))
    oiiotool --stats "$file" | grep -E 'NanCount|InfCount' | grep -q '[1-9]' && wrong=$((wrong + 1))
    exrheader "$file" | grep -q 'ngs:schema' && exrheader "$file" | grep -q 'ngs.mask, 32-bit' || wrong=$((wrong + 1))
  done
  expect "files (of $files) with NaN or infinity, or without ngs:schema and ngs.mask as float" "$wrong" 0
  idiff -q "$out/exr/0000.exr" "$out/exr/0000.exr" && ok "idiff reads them" || bad "idiff does not read them"
}

check_meshes() {
  local kind files=()
  for kind in glb obj ply stl; do tool ngs-mesh "$out/run/object.ply" -o "$out/mesh.$kind" --faces 2000 --resolution 48; done
  for kind in khr unreal godot; do
    tool ngs-mesh "$out/run/object.ply" -o "$out/mesh-$kind.glb" --faces 2000 --resolution 48 --collider box --collider-names "$kind"
  done
  if require assimp assimp-utils; then
    for kind in glb obj ply stl; do
      expect "faces of mesh.$kind in assimp" "$(assimp info "$out/mesh.$kind" | awk '/^Faces:/ { print $2 }')" 2000
    done
  fi
  npm_install || return
  for kind in mesh:2000 mesh-khr:2000 mesh-unreal:2012 mesh-godot:2012; do  # a box has 12 faces, which khr does not show
    expect "gltf-validator and GLTFLoader" "$(node "$here/meshes.mjs" "$modules" "$out/${kind%:*}.glb")" \
      "${kind%:*}.glb: 0 errors, ${kind#*:} faces"
  done
}

check_cloudcompare() {
  require CloudCompare cloudcompare || return
  # Its command line only reads properties with "scal" in their names: the label is renamed, and follows the three scales.
  LC_ALL=C sed 's/^property float ngs_label$/property float scalar_label/' "$out/decided.ply" > "$out/cc.ply"
  (cd "$out" && CloudCompare -SILENT -NO_TIMESTAMP -AUTO_SAVE OFF -O cc.ply -SET_ACTIVE_SF 3 -FILTER_SF 0.5 1.5 -C_EXPORT_FMT PLY \
    -SAVE_CLOUDS FILE cc-object.ply) > "$out/cc.log" 2>&1
  expect "points with scalar_label 1" "$(ply count "$out/cc-object.ply" 2>&1 | tail -1)" "$(ply count "$out/run/object.ply")"
}

make_run || { echo "FAIL: the test scene could not be made"; exit 1; }
checks="transform formats supersplat colmap_text colmap_masks exr meshes cloudcompare"
[ -n "$quick" ] || checks+=" render viewers colmap_loop"
for check in $checks; do
  if [[ $check =~ $only ]]; then "check_$check"; fi
done
echo "$passed checks passed, $failed failed, $skipped skipped"
if [ "$failed" -gt 0 ]; then exit 1; fi
if [ "$passed" -eq 0 ]; then exit 77; fi

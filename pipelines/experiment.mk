# The chain of ngs-gs.sh as a dependency graph. A second call runs only what changed.
#
#   make -f pipelines/experiment.mk SCENE=scenes/bird MASKS=scenes/bird/masks_sam out/object.ply
#   make -f pipelines/experiment.mk SCENE=... OUT=other GT=... HOLD_OUT=every:4:2 other/metrics.json
#
# Inputs: SCENE (read by ngs-scene import), MODEL MASKS GT HOLD_OUT IMAGE_SCALE METHOD QUALITY DEVICE ARTIFACTS (the options
# of ngs-gs.sh), and *_FLAGS (further options of each tool). COMMON_FLAGS apply to every tool. UNKEYED_FLAGS do as well, but
# cannot change results (-j 4 -q) and trigger no rerun. A tool runs again if an earlier artifact is newer, or if its options,
# a file named in them, a file in SCENE, MODEL, MASKS or GT (name, size, time) or its binary changed. OUT must not contain
# spaces (a limit of make); other paths may.
SHELL := bash
.SHELLFLAGS := -o pipefail -c
.DELETE_ON_ERROR:
.NOTPARALLEL:
HERE := $(dir $(lastword $(MAKEFILE_LIST)))
OUT ?= out
SCENE ?= $(error SCENE is not set)
ARTIFACTS ?= needed
export SCENE MODEL MASKS GT HOLD_OUT IMAGE_SCALE METHOD QUALITY DEVICE ARTIFACTS COMMON_FLAGS
export SCENE_FLAGS VARIANCE_FLAGS SAMPLE_FLAGS RBF_FLAGS JOINT_FLAGS EXTRACT_FLAGS RENDER_FLAGS EVAL_FLAGS REPORT_FLAGS
BIN := $(shell . '$(HERE)common.sh'; find_bin)
export PATH := $(if $(BIN),$(BIN):)$(PATH)

# Empty if the chain may write to OUT.
REFUSED := $(shell . '$(HERE)common.sh'; \
  (refuse_out '$(OUT)' '$(SCENE)' '$(SCENE)'/{images,masks,masks_sam,masks_gt,gt} '$(MODEL)' '$(MASKS)' '$(GT)') || echo refused)
$(if $(REFUSED),$(error $(OUT) is refused))

S := $(OUT)/.state
ALL = $(COMMON_FLAGS) $(UNKEYED_FLAGS) -w --report $(OUT)/reports
ON := $(if $(DEVICE),--device $(DEVICE))
OURS := $(filter ngs ng-gs,$(METHOD) $(if $(METHOD),,ngs))
FIELD := $(if $(filter all,$(ARTIFACTS))$(filter ng-gs,$(METHOD))$(findstring ng-gs,$(JOINT_FLAGS))$(findstring nerf=on,$(JOINT_FLAGS))$(findstring all=on,$(JOINT_FLAGS)),$(OUT)/field.ply)
# After exit code 7 (budget reached) the chain continues with the partial result.
BUDGET := || [ $$? -eq 7 ]

.PHONY: all FORCE
all: $(OUT)/report.html
	@[ ! -e $(S)/check_failed ] || { echo "a bound of --fail-below was not met" >&2; exit 1; }
$(S):
	@mkdir -p $@ $(OUT)/reports

# Further dependencies of each tool, besides earlier artifacts; rewritten only on change.
INPUTS_scene := SCENE MODEL MASKS GT HOLD_OUT IMAGE_SCALE
INPUTS_variance := DEVICE
INPUTS_rbf := DEVICE
INPUTS_joint := METHOD QUALITY DEVICE
INPUTS_render := DEVICE HOLD_OUT
$(S)/%.flags: FORCE | $(S)
	@. '$(HERE)common.sh'; inputs_of ngs-$* $(INPUTS_$*) > $@.new; if cmp -s $@.new $@; then rm $@.new; else mv $@.new $@; fi

$(OUT)/scene.json: $(S)/scene.flags
	ngs-scene import "$$SCENE" $${MODEL:+--model "$$MODEL"} $${MASKS:+--masks "$$MASKS"} $${GT:+--truth "$$GT"} \
	  $${HOLD_OUT:+--hold-out "$$HOLD_OUT"} $${IMAGE_SCALE:+--image-scale $$IMAGE_SCALE} -o $@ $(SCENE_FLAGS) $(ALL)/ngs-scene.json
$(OUT)/boundary.ply: $(OUT)/scene.json $(S)/variance.flags
	ngs-variance $< -o $@ $(VARIANCE_FLAGS) $(ON) $(ALL)/ngs-variance.json
$(OUT)/queries.ply: $(OUT)/boundary.ply $(S)/sample.flags
	ngs-sample $(OUT)/scene.json $< -o $@ $(SAMPLE_FLAGS) $(ALL)/ngs-sample.json
$(OUT)/field.ply: $(OUT)/queries.ply $(S)/rbf.flags
	ngs-rbf $(OUT)/boundary.ply $< -o $@ $(RBF_FLAGS) $(ON) $(ALL)/ngs-rbf.json
$(OUT)/labelled.ply: $(OUT)/boundary.ply $(FIELD) $(S)/joint.flags
	rm -f $(OUT)/trace.jsonl
	ngs-joint $(OUT)/scene.json $< $(FIELD:%=--field %) -o $@ $(if $(OURS),$(ON) --trace $(OUT)/trace.jsonl) \
	  $(if $(METHOD),--method $(METHOD)) $(if $(QUALITY),--quality $(QUALITY)) $(JOINT_FLAGS) $(ALL)/ngs-joint.json $(BUDGET)
$(OUT)/object.ply $(OUT)/background.ply &: $(OUT)/labelled.ply $(S)/extract.flags
	rm -rf $(OUT)/objects
	ngs-extract $< --scene $(OUT)/scene.json --object-ply $(OUT)/object.ply --objects $(OUT)/objects \
	  --background-ply $(OUT)/background.ply --background-filled $(OUT)/background-filled.ply $(EXTRACT_FLAGS) $(ALL)/ngs-extract.json
$(S)/rendered: $(OUT)/labelled.ply $(S)/render.flags $(if $(wildcard $(OUT)/masks),,FORCE)
	rm -rf $(OUT)/masks $(S)/masks
	ngs-render $(OUT)/scene.json $< --views $(if $(HOLD_OUT),held-out,all) --layers mask --scale 0 --format png -o $(S)/masks \
	  $(RENDER_FLAGS) $(ON) $(ALL)/ngs-render.json
	cp -r $(S)/masks $(OUT)/masks
	@touch $@
$(S)/scored: $(S)/rendered $(OUT)/object.ply $(S)/eval.flags $(if $(wildcard $(OUT)/metrics.json $(S)/unscored),,FORCE)
	rm -f $(S)/check_failed $(S)/unscored $(OUT)/metrics.json $(OUT)/metrics_input.json
	ngs-eval $(OUT)/scene.json $(OUT)/scene.json --allow-empty -q -o $(OUT)/metrics_input.json $(EVAL_FLAGS) \
	  $(ALL)/ngs-eval-input.json || [ $$? -eq 1 ]
	rm -rf $(S)/alone
	[ -d $(OUT)/objects ] || ! { [ "$(HOLD_OUT)" ] || grep -qs '^  "truth"' $(OUT)/scene.json; } || ngs-render $(OUT)/scene.json \
	  $(OUT)/object.ply --views $(if $(HOLD_OUT),held-out,all) --layers alpha --scale 0 --format png -o $(S)/alone $(RENDER_FLAGS) \
	  $(ON) $(ALL)/ngs-render-alone.json
	ngs-eval $(OUT)/masks $(OUT)/scene.json $$([ ! -d $(S)/alone ] || echo --alone $(S)/alone) --allow-empty -o $(OUT)/metrics.json \
	  $(EVAL_FLAGS) $(ALL)/ngs-eval.json || \
	  { [ $$? -eq 1 ] && touch $(S)/check_failed; }
	@[ -e $(OUT)/metrics.json ] || touch $(S)/unscored; touch $@
$(OUT)/metrics.json: $(S)/scored
	@[ -e $@ ] || { echo "nothing was scored: give GT or HOLD_OUT" >&2; exit 5; }
$(OUT)/report.html: $(OUT)/object.ply $(OUT)/background.ply $(S)/scored $(S)/report.flags
	ngs-report $(OUT) -o $@ $(REPORT_FLAGS) $(ALL)/ngs-report.json

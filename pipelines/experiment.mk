# Dependency graph of one scene: photos, poses and masks -> cut-out object. Rebuilds only what changed:
#
#   make -f pipelines/experiment.mk SCENE=scenes/bird MASKS=scenes/bird/masks_sam out/object.ply
#   make -f pipelines/experiment.mk SCENE=... OUT=other GT=... HOLD_OUT=every:4:2 other/metrics.json
#
# SCENE MODEL MASKS GT HOLD_OUT IMAGE_SCALE METHOD QUALITY DEVICE and *_FLAGS are the inputs; their defaults follow.
# A stage runs again if an earlier stage rewrote its artifact, or if its options, input files (names, sizes, times) or
# binary changed. OUT must not contain spaces (a limit of make); other paths may, if passed through the environment.
# pipelines/ngs-gs.sh handles both.
SHELL := bash
.SHELLFLAGS := -o pipefail -c
.DELETE_ON_ERROR:
.NOTPARALLEL:

OUT ?= out
SCENE ?=
MODEL ?=
MASKS ?=
GT ?=
HOLD_OUT ?=
IMAGE_SCALE ?= 0
METHOD ?=
ARTIFACTS ?= needed
QUALITY ?=
DEVICE ?=
SCENE_FLAGS ?=
VARIANCE_FLAGS ?=
SAMPLE_FLAGS ?=
RBF_FLAGS ?=
JOINT_FLAGS ?=
EXTRACT_FLAGS ?=
RENDER_FLAGS ?=
EVAL_FLAGS ?=
REPORT_FLAGS ?=
# Flags of every tool: those that may change results, and those that cannot (-j 4 -q) and trigger no rerun.
COMMON_FLAGS ?=
UNKEYED_FLAGS ?=
export ARTIFACTS OUT SCENE MODEL MASKS GT HOLD_OUT IMAGE_SCALE METHOD QUALITY DEVICE
export SCENE_FLAGS VARIANCE_FLAGS SAMPLE_FLAGS RBF_FLAGS JOINT_FLAGS EXTRACT_FLAGS RENDER_FLAGS EVAL_FLAGS REPORT_FLAGS
export COMMON_FLAGS UNKEYED_FLAGS

NGS_STAGE ?= $(dir $(lastword $(MAKEFILE_LIST)))stage.sh
export NGS_STAGE
STAGE := bash "$$NGS_STAGE"
# field.ply if a stage reads it or ARTIFACTS is all. $(shell) sees only environment variables, so pass them on.
FIELD := $(shell ARTIFACTS=$(ARTIFACTS) METHOD='$(METHOD)' JOINT_FLAGS="$$JOINT_FLAGS $(if $(findstring command,$(origin JOINT_FLAGS)),$(JOINT_FLAGS))" OUT=. bash "$(NGS_STAGE)" field)

.PHONY: all FORCE
all: $(OUT)/report.html

$(OUT)/.state:
	@mkdir -p $@

# Further dependencies of a stage, besides earlier artifacts; rewritten only on change.
$(OUT)/.state/%.key: FORCE | $(OUT)/.state
	@$(STAGE) key $*

$(OUT)/scene.json: $(OUT)/.state/scene.key
	$(STAGE) scene
$(OUT)/boundary.ply: $(OUT)/scene.json $(OUT)/.state/variance.key
	$(STAGE) variance
$(OUT)/queries.ply: $(OUT)/boundary.ply $(OUT)/.state/sample.key
	$(STAGE) sample
$(OUT)/field.ply: $(OUT)/queries.ply $(OUT)/.state/rbf.key
	$(STAGE) rbf
$(OUT)/labelled.ply: $(OUT)/boundary.ply $(addprefix $(OUT)/,$(FIELD)) $(OUT)/.state/joint.key
	$(STAGE) joint
$(OUT)/object.ply $(OUT)/background.ply &: $(OUT)/labelled.ply $(OUT)/.state/extract.key
	$(STAGE) extract
$(OUT)/.state/render.done: $(OUT)/labelled.ply $(OUT)/.state/render.key
	$(STAGE) render
	@touch $@
$(OUT)/.state/eval.done: $(OUT)/.state/render.done $(OUT)/.state/eval.key
	$(STAGE) eval
	@touch $@
$(OUT)/metrics.json: $(OUT)/.state/eval.done
	@$(STAGE) scored
$(OUT)/report.html: $(OUT)/object.ply $(OUT)/background.ply $(OUT)/.state/eval.done $(OUT)/.state/report.key
	$(STAGE) report

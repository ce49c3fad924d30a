# One scene from photos, poses and masks to a cut-out object, as one dependency graph. Rebuilds only what changed:
#
#   make -f pipelines/experiment.mk SCENE=scenes/bird MASKS=scenes/bird/masks_sam out/object.ply
#   make -f pipelines/experiment.mk SCENE=... OUT=other GT=... HOLD_OUT=every:4:2 other/metrics.json
#
# SCENE MODEL MASKS GT HOLD_OUT IMAGE_SCALE METHOD QUALITY DEVICE and *_FLAGS are the inputs; their defaults follow.
# A stage runs again when an earlier stage wrote its artifact anew, when its own options, input files (names,
# sizes, times) or its binary changed. OUT must not contain spaces (make cannot have them in a target); the
# other paths may, if they come through the environment. pipelines/ngs-gs.sh takes care of both.
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
# Of every tool: those that may change a result, and those that cannot (-j 4 -q), which rerun nothing.
COMMON_FLAGS ?=
UNKEYED_FLAGS ?=
export ARTIFACTS OUT SCENE MODEL MASKS GT HOLD_OUT IMAGE_SCALE METHOD QUALITY DEVICE
export SCENE_FLAGS VARIANCE_FLAGS SAMPLE_FLAGS RBF_FLAGS JOINT_FLAGS EXTRACT_FLAGS RENDER_FLAGS EVAL_FLAGS REPORT_FLAGS
export COMMON_FLAGS UNKEYED_FLAGS

NGS_STAGE ?= $(dir $(lastword $(MAKEFILE_LIST)))stage.sh
export NGS_STAGE
STAGE := bash "$$NGS_STAGE"
# field.ply where a stage reads it, or where ARTIFACTS is all. A shell of make knows only what came by the environment.
FIELD := $(shell ARTIFACTS=$(ARTIFACTS) METHOD='$(METHOD)' JOINT_FLAGS="$$JOINT_FLAGS $(if $(findstring command,$(origin JOINT_FLAGS)),$(JOINT_FLAGS))" OUT=. bash "$(NGS_STAGE)" field)

.PHONY: all FORCE
all: $(OUT)/report.html

$(OUT)/.state:
	@mkdir -p $@

# What a stage depends on beside the artifacts before it; written anew only where it differs.
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

# Accuracy against time: sweeps every knob on one scene; writes one page, and the points as JSON and CSV.
#
#   make -f pipelines/work-precision.mk SCENE=scenes/bird MASKS=scenes/bird/masks_sam GT=scenes/bird/masks_gt HOLD_OUT=every:4:2
#   make -f pipelines/work-precision.mk SCENE=... POINTS='method@flash quality@standard steps@16' REPEATS=5
#
# A point is KNOB@VALUE; the knobs are defined below. Each point runs REPEATS times, for min, median and max. One-off steps
# per scene (import, evidence) are timed separately from steps per object (ngs-joint). A failing point stays on the page with
# its exit code. OUT/points/KNOB@VALUE/REPEAT/ are the runs; delete one and call again to repeat it. An OUT with points of
# another scene, masks, hold-out or STEPS is an error, since one page would mix them. Times are comparable only on an idle
# machine: never use make -j. If ngs_numerical was built (with the tests), a further plot shows the numerical errors of
# float, cut-offs and truncated neighbours.
SHELL := bash
.DEFAULT_GOAL := all
.NOTPARALLEL:
HERE := $(dir $(lastword $(MAKEFILE_LIST)))
SCENE ?= $(error SCENE is not set)
OUT ?= out/work-precision
MASKS ?= $(SCENE)/masks
GT ?= $(SCENE)/masks_gt
HOLD_OUT ?= every:4:2
IMAGE_SCALE ?= 0
REPEATS ?= 3
# Steps of all points that sweep a part of the joint stage.
STEPS ?= 160

POINTS ?= method@flash method@sa3d method@bce method@cob \
  quality@draft quality@standard quality@high effects@auto effects@all-on \
  steps@16 steps@48 steps@160 steps@640 \
  neighbours@1 neighbours@2 neighbours@4 neighbours@8 neighbours@16 neighbours@32 \
  views@4 views@2 views@1 image-scale@0.25 image-scale@0.5 image-scale@1 \
  grid@16x16x4 grid@32x32x4 grid@32x32x8 grid@64x64x8 grid@96x96x8 \
  hash-levels@1 hash-levels@4 hash-levels@8 hash-levels@12 \
  hash-table@10 hash-table@15 hash-table@19 mlp@16 mlp@32 mlp@64 mlp@128

# The joint stage of the paper without other stages, for the knobs of the joint stage.
joint := --effect joint=on --effect nerf=on --effect contours=off --effect floaters=off
flags_method = --method $(1)
flags_quality = --quality $(1)
flags_effects = $(if $(filter all-on,$(1)),--effect all=on)
flags_steps = $(joint) --steps $(1)
flags_neighbours = $(joint) --steps $(STEPS) --neighbours $(1)
# One in VALUE views has a mask.
flags_views = $(joint) --steps $(STEPS)
# Relative to the photos; scene and evidence use it too.
flags_image-scale = $(joint) --steps $(STEPS)
flags_grid = $(joint) --steps $(STEPS) $(join --rows= --cols= --depth-samples=,$(subst x, ,$(1)))
flags_hash-levels = $(joint) --steps $(STEPS) --hash-levels $(1)
flags_hash-table = $(joint) --steps $(STEPS) --hash-log2-table $(1)
flags_mlp = $(joint) --steps $(STEPS) --mlp-hidden $(1)

knob = $(firstword $(subst @, ,$(1)))
setting = $(word 2,$(subst @, ,$(1)))
runs := $(foreach repeat,$(shell seq $(REPEATS)),$(POINTS:%=%/$(repeat)))
export SCENE OUT MASKS GT HOLD_OUT IMAGE_SCALE STEPS
point := bash '$(HERE)work-point.sh'

.PHONY: all settings
all: $(OUT)/report.html
settings:
	@$(point) settings

# Points with a separate scene; all others share one.
once_of = $(if $(filter views image-scale,$(call knob,$(1))),$(1),scene)
$(OUT)/once/%/boundary.ply: | settings
	@$(point) once '$*'
define run_rule
$(OUT)/points/$(1)/done: $(OUT)/once/$(call once_of,$(firstword $(subst /, ,$(1))))/boundary.ply
	@$(point) run '$(1)' '$$<' $(call flags_$(call knob,$(firstword $(subst /, ,$(1)))),$(call setting,$(firstword $(subst /, ,$(1)))))
endef
$(foreach run,$(runs),$(eval $(call run_rule,$(run))))

$(OUT)/report.html: $(runs:%=$(OUT)/points/%/done)
	@$(point) page

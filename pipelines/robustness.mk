# Robustness against mask errors: adds errors of known size to a scene's true masks, runs every method with the same masks,
# and compares the scores in test views on one page.
#
#   make -f pipelines/robustness.mk SCENE=scenes/bird TRUTH=scenes/bird/masks_gt ARGS='--hold-out every:4:2'
#   make -f pipelines/robustness.mk ... OUT=out/robust DAMAGES='exact erode' METHODS='flash ngs' SEED=3
#
# DAMAGES are exact, erode and dilate (3 px, with 2 px of jitter), missing (20 % of the views), wrong (10 % of them get
# another view's mask) and blob (ellipses cut off or added in half of the views); METHODS are those of ngs-joint. Use
# absolute paths or paths from here. OUT/masks-DAMAGE/ are the masks, OUT/DAMAGE@METHOD/ the runs.
SHELL := bash
.DEFAULT_GOAL := all
HERE := $(dir $(lastword $(MAKEFILE_LIST)))
SCENE ?= $(error SCENE is not set)
TRUTH ?= $(error TRUTH is not set)
OUT ?= out/robustness
ARGS ?=
SEED ?= 0
DAMAGES ?= exact erode dilate missing wrong blob
METHODS ?= flash bce cob ngs

damage_exact := --missing 0
damage_erode := --mask-noise erode:3,jitter:2
damage_dilate := --mask-noise dilate:3,jitter:2
damage_missing := --missing 0.2
damage_wrong := --wrong 0.1
damage_blob := --mask-noise blob:0.5

VARIANTS := $(foreach damage,$(DAMAGES),$(METHODS:%=$(damage)@%))
include $(HERE)variants.mk

damage = $(firstword $(subst @, ,$(1)))
method = $(word 2,$(subst @, ,$(1)))
$(OUT)/masks-%: FORCE
	@$(call degrade,$@,$(TRUTH),$(damage_$*) --seed $(SEED))
variant-%: $(DAMAGES:%=$(OUT)/masks-%)
	$(call variant,$*,--masks '$(OUT)/masks-$(call damage,$*)' --gt '$(TRUTH)' --method $(call method,$*))

# The paper's ablation and its sweep of tau on one scene: each part of the method switched off by itself, compared on one page.
#
#   make -f pipelines/ablation.mk SCENE=scenes/bird ARGS='--masks scenes/bird/masks_sam --hold-out every:4:2'
#   make -f pipelines/ablation.mk SCENE=... OUT=out/ablation EFFECTS='nerf cont smooth' TAUS='0.4 0.6 0.8' ARGS=...
#
# ARGS are options of ngs-gs.sh, the same for all variants; use absolute paths or paths from here. EFFECTS are the names
# that `ngs-joint --explain` lists. OUT/VARIANT/ are the runs, OUT/report.html and OUT/summary.json compare them. A variant
# that fails is said and left out. A second call does only what changed.
SHELL := bash
.DEFAULT_GOAL := all
HERE := $(dir $(lastword $(MAKEFILE_LIST)))
SCENE ?= $(error SCENE is not set)
OUT ?= out/ablation
ARGS ?=
EFFECTS ?= nerf boundary box rbf hash film align variance density mask cont smooth photometric geometry floaters view-trust edges
TAUS ?= 0.2 0.4 0.8

VARIANTS := full $(EFFECTS:%=without-%) $(TAUS:%=tau-%)
include $(HERE)variants.mk

variant-full:
	$(call variant,full,)
variant-without-%:
	$(call variant,without-$*,--effect $*=off)
variant-tau-%:
	VARIANCE_FLAGS="$$VARIANCE_FLAGS --tau $*" $(call variant,tau-$*,)

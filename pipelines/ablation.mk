# Ablation of the paper on one scene: each part of the method switched off alone (the paper removes them one after the
# other), sweeps of tau, sigma and K, and degraded masks; one page compares scores and times.
#
#   make -f pipelines/ablation.mk SCENE=scenes/bird ARGS='--masks scenes/bird/masks_sam --hold-out every:4:2'
#   make -f pipelines/ablation.mk SCENE=... OUT=out/ablation EFFECTS='nerf cont smooth' TAUS= SIGMAS= KS= DAMAGES= ARGS=...
#   make -f pipelines/ablation.mk SCENE=... BASE= ARGS=...          ablation of the default method instead
#
# ARGS are options of ngs-gs.sh, the same for all variants; use absolute paths or paths from here. EFFECTS are the names that
# `ngs-joint --explain` lists; the paper's columns Bd Sp RBF MRHE NeRF L_align L_smth are boundary box rbf hash nerf align
# smooth. BASE are options of all variants: the joint stage of the paper, without the additions of this project. SIGMAS are
# in units of the boundary's spacing. DAMAGES need MASKS, the folder of masks to degrade: erode dilate blob (see
# robustness.mk for more). OUT/VARIANT/ are the runs, OUT/report.html and OUT/summary.json compare them. A failing variant is
# reported and left out. A second call runs only variants whose options or inputs changed.
SHELL := bash
.DEFAULT_GOAL := all
HERE := $(dir $(lastword $(MAKEFILE_LIST)))
SCENE ?= $(error SCENE is not set)
OUT ?= out/ablation
ARGS ?=
MASKS ?=
SEED ?= 0
BASE ?= --method ng-gs
EFFECTS ?= boundary box rbf hash nerf align smooth film variance density mask cont photometric geometry mask-geometry
TAUS ?= 0.2 0.4 0.8
SIGMAS ?= 0.5 2 4
KS ?= 1 4 16
DAMAGES ?= $(if $(MASKS),erode dilate blob)

damage_erode := erode:3
damage_dilate := dilate:3
damage_blob := blob:0.5

VARIANTS := full $(EFFECTS:%=without-%) $(TAUS:%=tau-%) $(SIGMAS:%=sigma-%) $(KS:%=K-%) $(DAMAGES:%=masks-%)
include $(HERE)variants.mk

variant-full:
	$(call variant,full,$(BASE))
variant-without-%:
	$(call variant,without-$*,$(BASE) --effect $*=off)
variant-tau-%:
	export VARIANCE_FLAGS="$$VARIANCE_FLAGS --tau $*"; $(call variant,tau-$*,$(BASE))
variant-sigma-%:
	export RBF_FLAGS="$$RBF_FLAGS --width-factor $*"; $(call variant,sigma-$*,$(BASE) --width-factor $*)
variant-K-%:
	export RBF_FLAGS="$$RBF_FLAGS --neighbours $*"; $(call variant,K-$*,$(BASE) --neighbours $*)
$(OUT)/damaged-%: FORCE
	@$(call degrade,$@,$(MASKS),--mask-noise $(damage_$*) --seed $(SEED))
variant-masks-%: $(OUT)/damaged-%
	$(call variant,masks-$*,$(BASE) --masks '$(OUT)/damaged-$*')

# What accuracy costs in time: methods and qualities on one scene, compared on one page with a plot of both.
#
#   make -f pipelines/work-precision.mk SCENE=scenes/bird ARGS='--masks scenes/bird/masks_sam --hold-out every:4:2'
#   make -f pipelines/work-precision.mk SCENE=... OUT=out/wp POINTS='flash paper@draft paper@high' ARGS=...
#
# POINTS are METHOD or METHOD@QUALITY, as ngs-joint knows them. ARGS, OUT and the rest are as in ablation.mk. Times are only
# comparable where the runs had the machine to themselves: never call it with make -j.
SHELL := bash
.DEFAULT_GOAL := all
HERE := $(dir $(lastword $(MAKEFILE_LIST)))
SCENE ?= $(error SCENE is not set)
OUT ?= out/work-precision
ARGS ?=
POINTS ?= flash sa3d cob bce paper@draft paper@standard

VARIANTS := $(POINTS)
include $(HERE)variants.mk

quality = $(word 2,$(subst @, ,$(1)))
variant-%:
	$(call variant,$*,--method $(firstword $(subst @, ,$*)) $(if $(call quality,$*),--quality $(call quality,$*)))

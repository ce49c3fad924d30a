# The objects of one scene optimised in runs of their own, on this machine or as the tasks of a Slurm array, and joined into one
# labelled model. Objects whose boundary sets meet stay in one run; a run changes the Gaussians of its own objects only.
#
#   make -f pipelines/apart.mk -j 4 SCENE_JSON=out/scene.json BOUNDARY=out/boundary.ply OUT=out/labelled.ply
#   make -f pipelines/apart.mk submit SCENE_JSON=... BOUNDARY=... OUT=... SBATCH='--mem 8G --cpus-per-task 8'
#
# SHARDS is at most, and by default, the number of groups of objects that do not meet (ngs-joint --dry-run lists them).
# JOINT_FLAGS are options of the runs (--quality, --method ...). `submit` queues the array and the join behind it and returns when
# joined. A second call makes only the parts that are not there, or that were made of another SCENE_JSON or BOUNDARY or with other
# JOINT_FLAGS. A budget that was hit leaves a usable part.
THIS := $(abspath $(lastword $(MAKEFILE_LIST)))
TOOL_NAME := ngs-joint
PART := ply
BOUNDARY ?= $(error BOUNDARY is not set)
JOINT_FLAGS ?=
PART_FLAGS = $(SCENE_JSON) $(BOUNDARY) $(JOINT_FLAGS)
JOIN_FLAGS =
SETTINGS = BOUNDARY=$(BOUNDARY) JOINT_FLAGS='$(JOINT_FLAGS)'
include $(dir $(THIS))shards.mk

ifndef SHARDS
SHARDS := $(shell $(TOOL) $(SCENE_JSON) $(BOUNDARY) -o $(OUT).plan --dry-run -w -q | sed -n 's/^ *"groups": \([0-9]*\),$$/\1/p')
endif
ifeq ($(SHARDS),)
$(error no groups of objects were found in $(BOUNDARY))
endif

$(OUT): $(PARTS)
	$(TOOL) merge $(BOUNDARY) $(PARTS) -w -q -o $@ --report $@.json

$(OUT).parts/%-of-$(SHARDS).$(PART): $(SCENE_JSON) $(BOUNDARY) $(OUT).part.flags
	@mkdir -p $(@D)
	$(TOOL) $(SCENE_JSON) $(BOUNDARY) --apart $*/$(SHARDS) $(JOINT_FLAGS) -w -q -o $@ --report $@.json || [ $$? -eq 7 ]

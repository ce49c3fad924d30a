# The boundary set of one large scene from shards of its views, on this machine or as the tasks of a Slurm array. Sums of
# evidence are exact, so the merged file has the bytes that one run of ngs-variance over all views writes.
#
#   make -f pipelines/sharded.mk -j 8 SCENE_JSON=out/scene.json OUT=out/boundary.ply SHARDS=8
#   make -f pipelines/sharded.mk submit SCENE_JSON=... OUT=... SHARDS=200 SBATCH='--mem 8G --cpus-per-task 8'
#
# `submit` queues the array and the merge behind it and returns when merged. A second call makes only the shards that are not
# there, or that were made of another SCENE_JSON or with other RASTER_FLAGS. RASTER_FLAGS are options of the shards (--compat,
# --antialias), VARIANCE_FLAGS of the merge (--tau ...).
THIS := $(abspath $(lastword $(MAKEFILE_LIST)))
TOOL_NAME := ngs-variance
PART := evidence
SHARDS ?= 8
RASTER_FLAGS ?=
VARIANCE_FLAGS ?=
PART_FLAGS = $(SCENE_JSON) $(RASTER_FLAGS)
JOIN_FLAGS = $(VARIANCE_FLAGS)
SETTINGS = RASTER_FLAGS='$(RASTER_FLAGS)' VARIANCE_FLAGS='$(VARIANCE_FLAGS)'
include $(dir $(THIS))shards.mk

$(OUT): $(PARTS) $(OUT).join.flags
	$(TOOL) merge $(PARTS) $(VARIANCE_FLAGS) -w -q -o $@ --report $@.json

$(OUT).parts/%-of-$(SHARDS).$(PART): $(SCENE_JSON) $(OUT).part.flags
	@mkdir -p $(@D)
	$(TOOL) $(SCENE_JSON) --views $*/$(SHARDS) $(RASTER_FLAGS) -w -q --partial $@ --report $@.json

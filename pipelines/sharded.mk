# The boundary set of one large scene from shards of its views, on this machine or as the tasks of a Slurm array. Sums of
# evidence are exact, so the merged file equals that of one run of ngs-variance over all views, byte for byte.
#
#   make -f pipelines/sharded.mk -j 8 SCENE_JSON=out/scene.json OUT=out/boundary.ply SHARDS=8
#   make -f pipelines/sharded.mk submit SCENE_JSON=... OUT=... SHARDS=200 SBATCH='--mem 8G --cpus-per-task 8'
#
# `submit` queues the array and the merge, and returns after the merge. A second call makes only missing shards, and shards
# made from another SCENE_JSON or with other RASTER_FLAGS. RASTER_FLAGS are options of the shards (--compat,
# --antialias), VARIANCE_FLAGS of the merge (--tau ...).
SHELL := bash
.DELETE_ON_ERROR:
.SECONDARY:
.DEFAULT_GOAL := $(OUT)
SCENE_JSON ?= $(error SCENE_JSON is not set)
OUT ?= $(error OUT is not set)
SHARDS ?= 8
RASTER_FLAGS ?=
VARIANCE_FLAGS ?=
SBATCH ?=

THIS := $(abspath $(lastword $(MAKEFILE_LIST)))
TOOL := $(shell . '$(dir $(THIS))common.sh'; bin=$$(find_bin); printf %s "$${bin:+$$bin/}ngs-variance")
PARTS = $(shell printf '$(OUT).parts/%s-of-$(SHARDS).evidence ' $$(seq 0 $$(($(SHARDS) - 1))))
AGAIN = make -f $(THIS) SCENE_JSON=$(SCENE_JSON) OUT=$(OUT) SHARDS=$(SHARDS) \
  RASTER_FLAGS='$(RASTER_FLAGS)' VARIANCE_FLAGS='$(VARIANCE_FLAGS)'

$(OUT): $(PARTS) $(OUT).join.flags
	$(TOOL) merge $(PARTS) $(VARIANCE_FLAGS) -w -q -o $@ --report $@.json

$(OUT).parts/%-of-$(SHARDS).evidence: $(SCENE_JSON) $(OUT).part.flags
	@mkdir -p $(@D)
	$(TOOL) $(SCENE_JSON) --shard $*/$(SHARDS) $(RASTER_FLAGS) -w -q --partial $@ --report $@.json

.PHONY: submit FORCE
# Settings of parts and merge, rewritten only on change, so that parts with different settings are never merged.
export PART_FLAGS = $(SCENE_JSON) $(RASTER_FLAGS)
export JOIN_FLAGS = $(VARIANCE_FLAGS)
flags_file = @mkdir -p $(@D); printf '%s\n' "$$$(1)" > $@.new-$$$$; if cmp -s $@.new-$$$$ $@; then rm $@.new-$$$$; else mv $@.new-$$$$ $@; fi
$(OUT).part.flags: FORCE
	$(call flags_file,PART_FLAGS)
$(OUT).join.flags: FORCE
	$(call flags_file,JOIN_FLAGS)

submit: $(OUT).part.flags
	@mkdir -p $(OUT).parts; \
	array=$$(sbatch --parsable --requeue $(SBATCH) --array=0-$$(($(SHARDS) - 1)) -J ngs-part -o $(OUT).parts/%a.log \
	  --wrap "$(AGAIN) $(OUT).parts/\$$SLURM_ARRAY_TASK_ID-of-$(SHARDS).evidence"); \
	sbatch --parsable --requeue $(SBATCH) --dependency=afterok:$$array --kill-on-invalid-dep=yes --wait -J ngs-join \
	  -o $(OUT).parts/join.log --wrap "$(AGAIN) $(OUT)"

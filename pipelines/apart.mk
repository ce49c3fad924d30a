# The objects of one scene optimised in runs of their own, on this machine or as the tasks of a Slurm array, and joined into one
# labelled model. Objects whose boundary sets meet stay in one run; a run changes the Gaussians of its own objects only.
#
#   make -f pipelines/apart.mk -j 4 SCENE_JSON=out/scene.json BOUNDARY=out/boundary.ply OUT=out/labelled.ply
#   make -f pipelines/apart.mk submit SCENE_JSON=... BOUNDARY=... OUT=... SBATCH='--mem 8G --cpus-per-task 8'
#
# SHARDS is at most, and by default, the number of groups of objects that do not meet (ngs-joint --dry-run lists them).
# JOINT_FLAGS are options of the runs (--quality, --method ...). `submit` queues the array and the join behind it and returns when
# joined. A second call makes only the parts that are not there. A budget that was hit leaves a usable part.
SHELL := bash
.DELETE_ON_ERROR:
.SECONDARY:
.DEFAULT_GOAL := $(OUT)
THIS := $(abspath $(lastword $(MAKEFILE_LIST)))
SCENE_JSON ?= $(error SCENE_JSON is not set)
BOUNDARY ?= $(error BOUNDARY is not set)
OUT ?= $(error OUT is not set)
JOINT_FLAGS ?=
SBATCH ?=

TOOL := $(shell . '$(dir $(THIS))common.sh'; bin=$$(find_bin); printf %s "$${bin:+$$bin/}ngs-joint")
ifndef SHARDS
SHARDS := $(shell $(TOOL) $(SCENE_JSON) $(BOUNDARY) -o $(OUT).plan --dry-run -w -q | sed -n 's/^ *"groups": \([0-9]*\),$$/\1/p')
endif
ifeq ($(SHARDS),)
$(error no groups of objects were found in $(BOUNDARY))
endif
PARTS := $(shell printf '$(OUT).parts/%s-of-$(SHARDS).ply ' $$(seq 0 $$(($(SHARDS) - 1))))
AGAIN := make -f $(THIS) SCENE_JSON=$(SCENE_JSON) BOUNDARY=$(BOUNDARY) OUT=$(OUT) SHARDS=$(SHARDS) JOINT_FLAGS='$(JOINT_FLAGS)'

$(OUT): $(PARTS)
	$(TOOL) merge $(BOUNDARY) $(PARTS) -w -q -o $@ --report $@.json

$(OUT).parts/%-of-$(SHARDS).ply: $(SCENE_JSON) $(BOUNDARY)
	@mkdir -p $(@D)
	$(TOOL) $(SCENE_JSON) $(BOUNDARY) --apart $*/$(SHARDS) $(JOINT_FLAGS) -w -q -o $@ --report $@.json || [ $$? -eq 7 ]

.PHONY: submit
submit:
	@mkdir -p $(OUT).parts; \
	array=$$(sbatch --parsable --requeue $(SBATCH) --array=0-$$(($(SHARDS) - 1)) -J ngs-apart -o $(OUT).parts/%a.log \
	  --wrap "$(AGAIN) $(OUT).parts/\$$SLURM_ARRAY_TASK_ID-of-$(SHARDS).ply"); \
	sbatch --parsable --requeue $(SBATCH) --dependency=afterok:$$array --kill-on-invalid-dep=yes --wait -J ngs-join \
	  -o $(OUT).parts/join.log --wrap "$(AGAIN) $(OUT)"

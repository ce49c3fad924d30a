# What sharded.mk and apart.mk share: parts that the tasks of a Slurm array make, and the job behind the array that joins them.
# Included after THIS (the makefile itself), TOOL_NAME, PART (the end of a part's name), SETTINGS (its own variables, for calls of
# itself on nodes), PART_FLAGS and JOIN_FLAGS (options of the parts and of the join) are set; SHARDS may be set later. `submit`
# queues array and join and returns when joined.
SHELL := bash
.DELETE_ON_ERROR:
.SECONDARY:
.DEFAULT_GOAL := $(OUT)
SCENE_JSON ?= $(error SCENE_JSON is not set)
OUT ?= $(error OUT is not set)
SBATCH ?=

TOOL := $(shell . '$(dir $(THIS))common.sh'; bin=$$(find_bin); printf %s "$${bin:+$$bin/}$(TOOL_NAME)")
PARTS = $(shell printf '$(OUT).parts/%s-of-$(SHARDS).$(PART) ' $$(seq 0 $$(($(SHARDS) - 1))))
AGAIN = make -f $(THIS) SCENE_JSON=$(SCENE_JSON) OUT=$(OUT) SHARDS=$(SHARDS) $(SETTINGS)

.PHONY: submit FORCE
# What parts and join were made with, written anew only where it differs: parts of two settings are never joined.
export PART_FLAGS JOIN_FLAGS
flags_file = @mkdir -p $(@D); printf '%s\n' "$$$(1)" > $@.new-$$$$; if cmp -s $@.new-$$$$ $@; then rm $@.new-$$$$; else mv $@.new-$$$$ $@; fi
$(OUT).part.flags: FORCE
	$(call flags_file,PART_FLAGS)
$(OUT).join.flags: FORCE
	$(call flags_file,JOIN_FLAGS)

submit: $(OUT).part.flags
	@mkdir -p $(OUT).parts; \
	array=$$(sbatch --parsable --requeue $(SBATCH) --array=0-$$(($(SHARDS) - 1)) -J ngs-part -o $(OUT).parts/%a.log \
	  --wrap "$(AGAIN) $(OUT).parts/\$$SLURM_ARRAY_TASK_ID-of-$(SHARDS).$(PART)"); \
	sbatch --parsable --requeue $(SBATCH) --dependency=afterok:$$array --kill-on-invalid-dep=yes --wait -J ngs-join \
	  -o $(OUT).parts/join.log --wrap "$(AGAIN) $(OUT)"

# Shared by ablation.mk and robustness.mk: runs VARIANTS one after the other and compares what was finished.
.NOTPARALLEL:
.PHONY: all
# variant NAME OPTIONS: one run; a failure is said and does not end the series.
variant = bash '$(HERE)ngs-gs.sh' '$(SCENE)' '$(OUT)/$(1)' $(ARGS) -q $(2) || echo "variant $(1) failed, left out" >&2

all: $(VARIANTS:%=variant-%)
	@. '$(HERE)common.sh'; finished=(); \
	for name in $(VARIANTS); do \
	  if [ -f '$(OUT)'/$$name/metrics.json ]; then finished+=('$(OUT)'/$$name); fi; \
	done; compare_runs '$(OUT)' "$${finished[@]}"

# Shared by ablation.mk and robustness.mk: runs VARIANTS one after the other and compares the finished runs.
.NOTPARALLEL:
.SECONDARY:
.PHONY: all FORCE
export SCENE
# variant NAME OPTIONS: one run. A failure is reported and does not end the series; older scores of it are not used.
variant = . '$(HERE)common.sh'; once '$(OUT)/$(1)' '$(HERE)ngs-gs.sh' "$$SCENE" '$(OUT)/$(1)' $(ARGS) -q $(2); \
  case $$? in 0 | 1) rm -f '$(OUT)/$(1)/.state/failed' ;; \
    *) echo "variant $(1) failed, left out" >&2; touch '$(OUT)/$(1)/.state/failed' 2> /dev/null || true ;; esac
# degrade FOLDER MASKS FLAGS
degrade = . '$(HERE)common.sh'; degraded_masks '$(2)' '$(1)' $(3)

all: $(VARIANTS:%=variant-%)
	@. '$(HERE)common.sh'; finished=(); \
	for name in $(VARIANTS); do \
	  if [ -f '$(OUT)'/$$name/metrics.json ] && [ ! -f '$(OUT)'/$$name/.state/failed ]; then finished+=('$(OUT)'/$$name); fi; \
	done; compare_runs '$(OUT)' "$${finished[@]}"

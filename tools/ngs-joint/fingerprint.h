#pragma once
// What the state of the steps follows from, as text: a checkpoint serves only a run that has the same.
#include "chain.h"
#include "decide.h"

namespace ngs::joint {

struct StateSource {
  const cli::Run& run;
  const Declared& declared;
  const Paths& paths;
  const Scene& scene;
  const Decisions& decisions;
};

/// What is known of it before the first thing that the clock may decide; "effects" are those decided until now.
Json known_of_state(const StateSource& source);

/// All of it. Of effects their decisions, whoever took them; those on edges, which the steps know nothing of, may differ.
std::string fingerprint(Json known, const StateSource& source, const FloaterPlan& floaters, bool reads_field);

}  // namespace ngs::joint

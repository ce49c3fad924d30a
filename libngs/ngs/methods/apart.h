#pragma once
// Objects optimised in runs of their own, and the results joined.      beyond the paper, which has one object
//
// An object's own Gaussians are its boundary set and what is more than half of it. Objects meet where a Gaussian is
// several objects' own; they, and chains of them, belong in one run. A run apart moves, halves and recolours its
// objects' own Gaussians, and those that are more than kLeastForegroundShare of one of them and not that much of an object of
// another run. It keeps all others as they are (Problem::held): no two runs can change the same one.
#include <string>
#include <vector>

#include "ngs/problem/problem.h"

namespace ngs {



/// Objects that meet, directly or by way of others: lists of indices, ascending, ordered by their first.
std::vector<std::vector<std::size_t>> objects_that_meet(const std::vector<LabelColumns>& objects);

/// [N] 1: not to be touched by a run of the objects in `run`, which hold every object that meets one of them.
std::vector<std::uint8_t> held_rows(const std::vector<LabelColumns>& objects, const std::vector<std::size_t>& run);

/// The result of a run of some of the model's objects.
struct ModelPart {
  std::string name;  // for messages
  const GaussianCloud* cloud;
  const std::vector<std::int64_t>* source_row;  // [rows] row of the model that each descends from
  std::vector<std::size_t> objects;             // of the model
  std::vector<LabelColumns> labels;             // one per object of the part, [rows]
};

/// Every Gaussian as the part that changed it left it, else as the model has it; Gaussians that a part added come
/// last, ordered by the parts' objects, so that the order of `parts` does not matter. Labels of an object are its
/// part's, where another part added rows those of the Gaussian they descend from; an object that is in no part
/// keeps the model's. figures: changed, added. kInconsistent where two parts changed one Gaussian or hold one
/// object, kBadInput where a part is not one of this model.
Solution join_parts(const GaussianCloud& model, const std::vector<LabelColumns>& labels,
                        std::vector<ModelPart> parts);

}  // namespace ngs

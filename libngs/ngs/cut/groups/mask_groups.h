#pragma once
// Which masks of different views show the same object: view consensus.
//
// A view u observes mask m of view v if at least `visible` of m's weight lies in Gaussians that u sees. Then either one
// mask of u contains m (at least `contained` of the weight seen), or the pixels without a mask do, or u splits m. A
// mask that more than `split` of its observers split covers several objects and is dropped: it joins no group, and no
// view counts it as a container. Two masks are one object if, of the views with a container of both, at least
// `consensus` have the same container. Masks are joined in rounds: first pairs with many such views, then with fewer;
// the container of a group in a view is the one that most of its members have.
#include <cstdint>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/cut/groups/view_gaussians.h"
#include "ngs/options/field.h"

namespace ngs {

struct GroupOptions {
  double visible = 0.3;
  double contained = 0.8;
  double consensus = 0.7;
  double split = 0.5;
  int min_observers = 2;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.visible, Field<double>{"visible", "", "Share of a mask that a view must see to be counted", 0.0, 1.0});
    visit(self.contained, Field<double>{"contained", "",
                                        "Share of a mask, as far as a view sees it, that one mask of "
                                        "this view must contain",
                                        0.5, 1.0});
    visit(self.consensus, Field<double>{"consensus", "",
                                        "Share of the views with both masks that must have them in "
                                        "one mask",
                                        0.0, 1.0});
    visit(self.split,
          Field<double>{"split", "", "Drop masks that more than this share of the other views split", 0.0, 1.0});
    visit(self.min_observers, Field<int>{"min_observers", "",
                                         "Least number of views that see both of two masks which "
                                         "are joined",
                                         1, 1000});
  }
};

struct MaskGroups {
  static constexpr std::int32_t kDropped = -1;
  std::vector<std::vector<std::int32_t>> group;  // [views][masks]: 0 .. groups - 1, or kDropped
  std::vector<int> views;                        // [groups] views with a mask of the group
  std::size_t groups() const { return views.size(); }
};

/// The groups of masks whose numbers mean the same in all views: number m is group m - 1.
MaskGroups same_numbers(const std::vector<NumberedMasks>& views);

/// The groups are numbered by their first mask. A mask that no other view observes is a group of its own.
MaskGroups group_masks(const Exec& exec, const GroupOptions& options, const std::vector<ViewGaussians>& views);

}  // namespace ngs

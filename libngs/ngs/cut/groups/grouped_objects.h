#pragma once
// Makes objects from groups of masks: each Gaussian gets the group that contains it in most views.
#include <cstdint>
#include <vector>

#include "ngs/cut/groups/mask_groups.h"

namespace ngs {

/// An object's statistics over views. A view counts if it has at least 1/10 of the object's largest weight in a view.
struct GroupedObject {
  std::int64_t gaussians = 0;
  std::vector<std::size_t> views;  // that show it
  /// Share of these views in which one mask contains it and little else (kMinPurity of the weight).
  double confidence = 0;
  /// The object whose masks contain this one in `part_share` of the views that show it, a fifth or more; 0: none.
  std::uint32_t part_of = 0;
  double part_share = 0;
};
inline constexpr double kMinPurity = 0.8;

/// The objects of a model. Number k of `object` is objects[k - 1]: first the `sure` ones, then the doubtful ones (too
/// few views or Gaussians, or too little confidence), both by their number of Gaussians, largest first.
struct GroupedObjects {
  std::vector<std::uint32_t> object;  // [N] 0: none
  std::vector<GroupedObject> objects;
  std::size_t sure = 0;
};

struct ObjectOptions {
  int min_views = 3;
  int min_gaussians = 5;
  double min_confidence = 0.3;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.min_views, Field<int>{"min_views", "", "Least number of views with a mask of an object", 1, 100000});
    visit(self.min_gaussians, Field<int>{"min_gaussians", "", "Least number of Gaussians of an object", 1, 1000000});
    visit(self.min_confidence,
          Field<double>{"min_confidence", "", "Least share of the views of an object that show it in a mask of its own",
                        0.0, 1.0});
  }
};

/// `gaussians`: number of Gaussians in the model. `groups`: result of group_masks() for the same views.
GroupedObjects objects_of_groups(const Exec& exec, const ObjectOptions& options, std::size_t gaussians,
                                 const std::vector<ViewGaussians>& views, const MaskGroups& groups);

/// The main object in one mask of a view.
struct MaskContent {
  std::uint32_t object = 0;  // with the largest weight in the mask; 0: none
  double share = 0;          // its share of the mask's weight
  bool is_known = false;     // some Gaussian lies in it
};
/// [masks + 1]; the first: outside all masks.
std::vector<MaskContent> mask_contents(const ViewGaussians& view, const GroupedObjects& objects);

}  // namespace ngs

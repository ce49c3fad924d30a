#pragma once
// Removes floor, walls and ceiling from grouped objects.
#include "ngs/cut/groups/grouped_objects.h"

namespace ngs {

/// Removes objects that are a large horizontal or vertical plane with almost nothing of the model on one side.
/// Furniture stays: both sides contain something. Returns the number of sure objects removed. `up`: unit length.
std::size_t remove_room_surfaces(const GaussianCloud& cloud, Vec3<double> up, GroupedObjects& objects);

}  // namespace ngs

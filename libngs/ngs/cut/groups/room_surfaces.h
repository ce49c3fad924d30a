#pragma once
// Floor, walls and ceiling among grouped objects: they belong to no object.
#include "ngs/cut/groups/grouped_objects.h"

namespace ngs {

/// Removes objects that are a large level or upright surface with nearly nothing of the model on one side. Furniture
/// stays: it has something on both sides. Returns the number of sure objects that were removed. `up`: unit length.
std::size_t remove_room_surfaces(const GaussianCloud& cloud, Vec3<double> up, GroupedObjects& objects);

}  // namespace ngs

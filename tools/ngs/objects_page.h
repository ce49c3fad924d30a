#pragma once
// The page of ngs cut --all.
#include <string>

#include "ngs/options/option_set.h"
#include "ngs/scene/scene.h"

namespace ngs::ngs_tool {

/// The room in its objects' colours, a card for each object, worst confidence first, and a table of the doubtful ones.
/// `objects`: objects.json of ngs-group; `masks`: folder of label maps of the scene's views, STEM.png.
std::string objects_page(const Scene& scene, const Json& objects, const std::string& masks);

}  // namespace ngs::ngs_tool

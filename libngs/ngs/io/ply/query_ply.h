#pragma once
// Query points, the artifacts of ngs-sample and ngs-rbf: one PLY row per point.
//
//   float x y z      world, relative to the origin in the header     float u v    px
//   int view slot    see scene/query_field.h                         float depth  world
//   float f_inter_*  uint nn_*  float w_*   after interpolation
//
// The header's comments store, as JSON, the origin, the window and per view its name, box and grid. Only x y z are
// required: a list of points from another program may lack the other columns and the comments; the corresponding
// vectors are then empty. kBadInput if the header has views and a `view` index is out of their range.
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"
#include "ngs/scene/query_field.h"

namespace ngs::io {

QueryField read_query_ply(const std::string& path);
QueryField parse_query_ply(const std::string& name, Bytes bytes);

/// Empty vectors are not written.
void write_query_ply(const std::string& path, const QueryField& field, const std::vector<std::string>& history = {});

}  // namespace ngs::io

#pragma once
// The artifacts of ngs-sample and ngs-rbf: one PLY row per query point.
//
//   float x y z      world, relative to the origin in the header     float u v    px
//   int view slot    see scene/query_field.h                         float depth  world
//   float f_inter_*  uint nn_*  float w_*   once interpolated
//
// The header's comments hold the origin, the window and per view its name, box and grid, as JSON. The reader
// needs only x y z: other columns and the comments may be absent (a list of points from elsewhere), their
// vectors are then empty; `view` indices beyond the views of the header are kBadInput where there are any.
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"
#include "ngs/scene/query_field.h"

namespace ngs::io {

QueryField read_query_ply(const std::string& path);
QueryField parse_query_ply(const std::string& name, Bytes bytes);

/// Vectors that are empty are not written.
void write_query_ply(const std::string& path, const QueryField& field, const std::vector<std::string>& history = {});

}  // namespace ngs::io

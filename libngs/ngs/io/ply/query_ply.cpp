#include "ngs/io/ply/query_ply.h"

#include <limits>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/ply/ply.h"

namespace ngs::io {
namespace {

constexpr std::string_view kFieldComment = "ngs-queries ";
constexpr std::string_view kViewComment = "ngs-view ";
constexpr std::int64_t kMaxInt = std::numeric_limits<int>::max();

nlohmann::ordered_json field_json(const QueryField& field) {
  return {{"origin", field.origin}, {"depth_span", field.depth_span}, {"depth_epsilon", field.depth_epsilon}};
}

nlohmann::ordered_json view_json(const QueryView& view) {
  return {{"name", view.name},
          {"box_px", {view.box.min_x, view.box.min_y, view.box.max_x, view.box.max_y}},
          {"rows", view.rows},
          {"cols", view.cols},
          {"depth_samples", view.depth_samples},
          {"mean_depth", view.mean_depth}};
}

void read_field_comment(const std::string& text, const std::string& where, QueryField& field) {
  const nlohmann::json json = parse_json(text, where);
  const JsonReader reader(json, where);
  const std::vector<double> origin = reader.matrix("origin", 3, 0);
  std::copy(origin.begin(), origin.end(), field.origin.begin());
  field.depth_span = reader.number("depth_span");
  field.depth_epsilon = reader.number("depth_epsilon");
}

QueryView read_view_comment(const std::string& text, const std::string& where) {
  const nlohmann::json json = parse_json(text, where);
  const JsonReader reader(json, where);
  const std::vector<double> box = reader.matrix("box_px", 4, 0);
  QueryView view;
  view.name = reader.text("name");
  view.box = {box[0], box[1], box[2], box[3]};
  view.rows = int(reader.integer("rows", 0, kMaxInt));
  view.cols = int(reader.integer("cols", 0, kMaxInt));
  view.depth_samples = int(reader.integer("depth_samples", 0, kMaxInt));
  view.mean_depth = reader.number("mean_depth");
  return view;
}

/// Reads `count` columns stem_0 ... as one row-major matrix.
template <class T>
std::vector<T> read_matrix(const PlyTable& table, const std::vector<std::string>& names) {
  std::vector<PlyColumn> columns;
  for (const std::string& name : names)
    if (const PlyColumn column = table.column(name)) columns.push_back(column);
  if (columns.size() != names.size()) return {};
  std::vector<T> values(std::size_t(table.rows) * columns.size());
  for (std::size_t i = 0, at = 0; i < std::size_t(table.rows); ++i)
    for (const PlyColumn& column : columns) {
      if constexpr (std::is_same_v<T, float>) {
        values[at++] = column.value_float(std::int64_t(i));
        continue;
      }
      // Float columns of indices are accepted; a value out of range becomes the largest index, which no model has.
      const double v = column.value(std::int64_t(i));
      values[at++] = v >= 0 && v < double(std::numeric_limits<T>::max()) ? T(v) : std::numeric_limits<T>::max();
    }
  return values;
}

std::vector<std::string> numbered_columns(const PlyTable& table, const std::string& stem) {
  std::vector<std::string> names;
  for (std::size_t k = 0; table.find(stem + std::to_string(k)) >= 0; ++k) names.push_back(stem + std::to_string(k));
  return names;
}

void check_views(const std::string& name, const QueryField& field) {
  if (field.views.empty()) return;
  for (std::size_t i = 0; i < field.view.size(); ++i)
    if (std::size_t(field.view[i]) >= field.views.size())
      throw Error(ErrorCode::kBadInput, name + ": row " + std::to_string(i) + " is of view " +
                                            std::to_string(field.view[i]) + ", expected less than " +
                                            std::to_string(field.views.size()));
}

QueryField read(const PlyFile& file) {
  const std::string& name = file.name();
  const PlyElement* vertex = file.find("vertex");
  if (vertex == nullptr) throw Error(ErrorCode::kBadInput, name + ": no element 'vertex', expected query points");
  const PlyTable table = file.table(*vertex);
  for (const char* column : {"x", "y", "z"})
    if (!table.column(column))
      throw Error(ErrorCode::kBadInput, name + ": property '" + column + "' is missing, expected query points",
                  "ngs-sample scene.json boundary.ply -o queries.ply writes them");
  QueryField field;
  for (const std::string& comment : file.comments()) {
    const std::string where = name + ": comment '" + comment.substr(0, 30) + "...'";
    if (comment.starts_with(kFieldComment)) read_field_comment(comment.substr(kFieldComment.size()), where, field);
    if (comment.starts_with(kViewComment))
      field.views.push_back(read_view_comment(comment.substr(kViewComment.size()), where));
  }
  field.position = read_matrix<float>(table, {"x", "y", "z"});
  field.uv = read_matrix<float>(table, {"u", "v"});
  field.view = read_matrix<std::int32_t>(table, {"view"});
  field.slot = read_matrix<std::int32_t>(table, {"slot"});
  field.depth = read_matrix<float>(table, {"depth"});
  const auto features = numbered_columns(table, "f_inter_"), nearest = numbered_columns(table, "nn_");
  field.features = int(features.size());
  field.feature = read_matrix<float>(table, features);
  field.neighbours = int(nearest.size());
  field.neighbour = read_matrix<std::uint32_t>(table, nearest);
  const auto weights = numbered_columns(table, "w_");
  if (weights.size() != nearest.size())
    throw Error(ErrorCode::kBadInput, name + ": " + std::to_string(weights.size()) + " properties w_*, expected " +
                                          std::to_string(nearest.size()) + " as there are nn_*");
  field.weight = read_matrix<float>(table, weights);
  check_views(name, field);
  return field;
}

/// Adds `count` properties of 4-byte values and stores their source.
struct Group {
  const void* data;
  std::size_t count;
};

}  // namespace

QueryField read_query_ply(const std::string& path) { return read(PlyFile::open(path)); }
QueryField parse_query_ply(const std::string& name, Bytes bytes) { return read(PlyFile::parse(name, bytes)); }

void write_query_ply(const std::string& path, const QueryField& field, const std::vector<std::string>& history) {
  PlyElement element;
  element.name = "vertex";
  element.count = field.size();
  std::vector<Group> groups;
  const auto add = [&](const auto& values, PlyType type, const std::vector<std::string>& names) {
    static_assert(sizeof values[0] == 4);
    if (values.empty() && element.count > 0) return;
    NGS_CHECK(values.size() == std::size_t(element.count) * names.size(), "a query column of the wrong length");
    for (const std::string& name : names) element.properties.push_back({.name = name, .type = type});
    groups.push_back({values.data(), names.size()});
  };
  const auto numbered = [](const std::string& stem, int count) {
    std::vector<std::string> names;
    for (int k = 0; k < count; ++k) names.push_back(stem + std::to_string(k));
    return names;
  };
  add(field.position, PlyType::kFloat32, {"x", "y", "z"});
  add(field.uv, PlyType::kFloat32, {"u", "v"});
  add(field.view, PlyType::kInt32, {"view"});
  add(field.slot, PlyType::kInt32, {"slot"});
  add(field.depth, PlyType::kFloat32, {"depth"});
  add(field.feature, PlyType::kFloat32, numbered("f_inter_", field.features));
  add(field.neighbour, PlyType::kUint32, numbered("nn_", field.neighbours));
  add(field.weight, PlyType::kFloat32, numbered("w_", field.neighbours));

  constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;
  std::vector<std::string> comments = {std::string(kFieldComment) + field_json(field).dump(-1, ' ', true, kReplace)};
  for (const QueryView& view : field.views)
    comments.push_back(std::string(kViewComment) + view_json(view).dump(-1, ' ', true, kReplace));
  comments.insert(comments.end(), history.begin(), history.end());

  PlyWriter writer(path, element, comments);
  for (std::size_t i = 0; i < std::size_t(element.count); ++i) {
    std::uint8_t* to = writer.row();
    for (const Group& group : groups) {
      std::memcpy(to, static_cast<const std::uint8_t*>(group.data) + i * group.count * 4, group.count * 4);
      to += group.count * 4;
    }
  }
  writer.commit();
}

}  // namespace ngs::io

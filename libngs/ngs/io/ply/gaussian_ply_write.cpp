#include <algorithm>
#include <nlohmann/json.hpp>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/core/version.h"
#include "ngs/io/ply/gaussian_columns.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/ply/selected_columns.h"
#include "ngs/scene/precision/local_origin.h"

namespace ngs::io {
namespace {

std::vector<std::string> numbered(const std::string& stem, int n) {
  std::vector<std::string> names;
  for (int k = 0; k < n; ++k) names.push_back(stem + std::to_string(k));
  return names;
}

bool same_bits(float a, float b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// A column of the cloud that an edit may overwrite: its place in the cloud and in the input's row.
struct Edited {
  const float* source;  // first value of the column in the input's cloud
  const float* edited;
  std::size_t stride;  // in floats
  double origin;
  std::size_t offset;  // in the row
  PlyType type;
};

/// Copies the input's columns of a row and overwrites the edited ones.
class RowSource {
 public:
  RowSource(const GaussianPly& source, const LabelledWrite& options, std::int64_t rows)
      : source_(source),
        options_(options),
        kept_(source.rows, [this](const std::string& name) { return !is_replaced(name); }) {
    if (options.edited == nullptr) {
      NGS_CHECK(rows == source.cloud.size(), "as many rows as the input unless it is edited");
      return;
    }
    NGS_CHECK(options.edited->sh_degree == source.cloud.sh_degree, "an edit keeps the SH degree");
    NGS_CHECK(options.edited->size() == rows, "labels and edited cloud have one row each");
    NGS_CHECK(
        options.source_row.empty() ? rows == source.cloud.size() : std::int64_t(options.source_row.size()) == rows,
        "source_row has one entry per row");
    list_edits();
  }

  const std::vector<PlyProperty>& properties() const { return kept_.properties(); }
  std::size_t row_bytes() const { return kept_.row_bytes(); }

  std::int64_t source_of(std::int64_t i) const {
    return options_.source_row.empty() ? i : options_.source_row[std::size_t(i)];
  }

  void fill(std::int64_t i, std::uint8_t* to) const {
    const std::int64_t from = source_of(i);
    kept_.copy(source_.rows.row(from), to);
    if (options_.edited == nullptr || !options_.edited->usable[std::size_t(i)]) return;
    for (const Edited& e : edits_) {
      const float value = e.edited[std::size_t(i) * e.stride];
      if (same_bits(value, e.source[std::size_t(from) * e.stride])) continue;
      if (e.type == PlyType::kFloat32)
        ply_store_float(value, to + e.offset);
      else
        ply_store(e.type, e.origin + double(value), to + e.offset);
    }
  }

 private:
  bool is_replaced(const std::string& name) const {
    if (name == kFixedColumn) return !options_.fixed.empty();
    if (name == kFloaterColumn) return !options_.floater.empty();
    if (name == kStateColumn) return !options_.state.empty();
    if (name == kWeightColumn) return true;  // belongs to the input's labels
    return std::any_of(kLabelFields.begin(), kLabelFields.end(), [&](const LabelField& f) {
      return name == f.name || name.starts_with(std::string(f.name) + "_");
    });
  }

  void add_edit(const std::string& column, std::vector<float> GaussianCloud::*values, std::size_t at,
                std::size_t stride, double origin = 0) {
    std::size_t offset = 0;
    for (const PlyProperty& p : properties()) {
      if (p.name == column)
        edits_.push_back({(source_.cloud.*values).data() + at, (options_.edited->*values).data() + at, stride, origin,
                          offset, p.type});
      offset += ply_type_bytes(p.type);
    }
  }

  void list_edits() {
    const std::size_t rest = std::size_t(source_.cloud.rest_count());
    const char* axes[] = {"x", "y", "z"};
    const bool is_relative = origin_in(source_.comments).has_value();
    for (std::size_t a = 0; a < 3; ++a) {
      add_edit(axes[a], &GaussianCloud::position, a, 3, is_relative ? 0 : source_.cloud.origin[a]);
      add_edit("scale_" + std::to_string(a), &GaussianCloud::log_scale, a, 3);
      add_edit("f_dc_" + std::to_string(a), &GaussianCloud::sh_dc, a, 3);
      for (std::size_t k = 0; k < rest; ++k)
        add_edit("f_rest_" + std::to_string(a * rest + k), &GaussianCloud::sh_rest, k * 3 + a, rest * 3);
    }
    for (std::size_t k = 0; k < 4; ++k) add_edit("rot_" + std::to_string(k), &GaussianCloud::rotation, k, 4);
    add_edit("opacity", &GaussianCloud::logit_opacity, 0, 1);
  }

  const GaussianPly& source_;
  const LabelledWrite& options_;
  SelectedColumns kept_;
  std::vector<Edited> edits_;
};

/// The float columns to be added, in file order.
struct Added {
  std::string name;
  const LabelColumn* labels;  // if null:
  std::span<const float> values = {};

  std::size_t size() const { return labels == nullptr ? values.size() : labels->size(); }
  float operator[](std::size_t row) const { return labels == nullptr ? values[row] : (*labels)[row]; }
};

void add_label_set(std::vector<Added>& added, const LabelColumns& set, const std::string& suffix) {
  for (const LabelField& f : kLabelFields) added.push_back({std::string(f.name) + suffix, &(set.*f.column)});
}

std::vector<Added> added_columns(std::span<const LabelSet> objects, const LabelColumns& all) {
  std::vector<Added> added;
  add_label_set(added, all, "");
  if (objects.size() < 2) return added;
  std::vector<std::string> names;
  for (const LabelSet& object : objects) names.push_back(object.object);
  const std::vector<std::string> suffixes = column_suffixes(names);
  for (std::size_t k = 0; k < objects.size(); ++k) add_label_set(added, objects[k].columns, "_" + suffixes[k]);
  return added;
}

std::vector<std::string> labelled_comments(const GaussianPly& source, std::span<const LabelSet> objects,
                                           const LabelledWrite& options) {
  std::vector<std::string> comments;
  for (const std::string& c : source.comments)
    if (!c.starts_with(kObjectsComment) && !(options.rule && c.starts_with(kRuleComment))) comments.push_back(c);
  nlohmann::json names = nlohmann::json::array();
  for (const LabelSet& object : objects) names.push_back(object.object);
  comments.push_back(std::string(kObjectsComment) +
                     names.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace));
  if (options.rule) comments.push_back(rule_comment(*options.rule));
  comments.insert(comments.end(), options.history.begin(), options.history.end());
  return comments;
}

std::int64_t count_kept(std::int64_t rows, const std::vector<std::uint8_t>& keep) {
  NGS_CHECK(keep.empty() || std::int64_t(keep.size()) == rows, "keep has one entry per Gaussian");
  return keep.empty() ? rows : std::count_if(keep.begin(), keep.end(), [](std::uint8_t k) { return k != 0; });
}

/// Columns that the strict profile writes itself, or that describe this tool's labels and an editor's selection.
bool is_own_column(const std::string& name) {
  constexpr std::string_view kOwn[] = {"x", "y", "z", "nx", "ny", "nz", "opacity", kStateColumn};
  if (std::ranges::find(kOwn, name) != std::end(kOwn) || name.starts_with("ngs_")) return true;
  const std::size_t digits = name.find_last_not_of("0123456789") + 1;
  const std::string stem = name.substr(0, digits);
  return digits < name.size() && (stem == "f_dc_" || stem == "f_rest_" || stem == "scale_" || stem == "rot_");
}

SelectedColumns further(const PlyTable& rows) {
  return {rows, [](const std::string& name) { return !is_own_column(name); }};
}

}  // namespace

PlyElement inria_element(std::int64_t count, int sh_degree) {
  PlyElement element;
  element.name = "vertex";
  element.count = count;
  const auto add = [&](std::string name) { element.properties.push_back({.name = std::move(name)}); };
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) add(name);
  for (std::string& name : numbered("f_dc_", 3)) add(std::move(name));
  for (std::string& name : numbered("f_rest_", 3 * sh_rest_count(sh_degree))) add(std::move(name));
  add("opacity");
  for (std::string& name : numbered("scale_", 3)) add(std::move(name));
  for (std::string& name : numbered("rot_", 4)) add(std::move(name));
  return element;
}

void store_inria_row(const GaussianCloud& cloud, const std::array<double, 3>& shift, std::int64_t i, std::uint8_t* to) {
  const std::size_t r = std::size_t(i), rest = std::size_t(cloud.rest_count());
  float row[62];
  float* at = row;
  const bool moved = shift != std::array<double, 3>{};
  for (std::size_t a = 0; a < 3; ++a) {
    const float p = cloud.position[r * 3 + a];
    *at++ = moved ? float(shift[a] + double(p)) : p;
  }
  for (int a = 0; a < 3; ++a) *at++ = 0;
  at = std::copy_n(&cloud.sh_dc[r * 3], 3, at);
  const float* sh = cloud.sh_rest.data() + r * rest * 3;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < rest; ++k) *at++ = sh[k * 3 + c];
  *at++ = cloud.logit_opacity[r];
  at = std::copy_n(&cloud.log_scale[r * 3], 3, at);
  at = std::copy_n(&cloud.rotation[r * 4], 4, at);
  std::memcpy(to, row, std::size_t(at - row) * sizeof(float));
}

std::string history_line(const std::string& tool, const std::string& options_json) {
  return "ngs " + tool + " " + kVersion + " " + options_json;
}

namespace {

std::vector<LabelSet> sets_of(std::span<const NamedLabels> objects) {
  std::vector<LabelSet> sets;
  for (const NamedLabels& object : objects) sets.push_back({object.object, object.columns});
  return sets;
}

LabelColumns union_of(std::span<const LabelSet> objects) {
  if (objects.empty()) return {};
  LabelColumns all = objects[0].columns;
  for (const LabelSet& object : objects.subspan(1))
    for (const LabelField& f : kLabelFields) {
      LabelColumn& to = all.*f.column;
      const LabelColumn& from = object.columns.*f.column;
      NGS_CHECK(to.size() == from.size(), "every object has one value per row and column");
      for (std::size_t i = 0; i < to.size(); ++i) to[i] = std::max(float(to[i]), from[i]);
    }
  return all;
}

}  // namespace

LabelColumns union_of(std::span<const NamedLabels> objects) {
  const std::vector<LabelSet> sets = sets_of(objects);
  return union_of(std::span<const LabelSet>(sets));
}

namespace {

struct StrictRows {
  const GaussianCloud& cloud;
  const std::vector<std::uint8_t>& keep;
  std::vector<std::string> comments;
};

/// Writes the Inria record and, after it, `columns` of each row by fill(row, to).
template <class Fill>
void write_record(const std::string& path, StrictRows rows, const std::vector<PlyProperty>& columns, const Fill& fill) {
  const GaussianCloud& cloud = rows.cloud;
  const bool is_local = needs_local_origin(cloud);
  if (is_local) rows.comments.push_back(origin_comment(cloud.origin));
  PlyElement element = inria_element(count_kept(cloud.size(), rows.keep), cloud.sh_degree);
  const std::size_t floats = element.properties.size();
  element.properties.insert(element.properties.end(), columns.begin(), columns.end());
  PlyWriter writer(path, element, rows.comments);
  const std::array<double, 3> shift = is_local ? std::array<double, 3>{} : cloud.origin;
  for (std::int64_t i = 0; i < cloud.size(); ++i)
    if (rows.keep.empty() || rows.keep[std::size_t(i)]) {
      std::uint8_t* to = writer.row();
      store_inria_row(cloud, shift, i, to);
      fill(i, to + floats * sizeof(float));
    }
  writer.commit();
}

}  // namespace

void write_strict_ply(const std::string& path, const GaussianCloud& cloud, const std::vector<std::uint8_t>& keep,
                      const std::vector<std::string>& comments, const std::optional<AddedColumn>& added) {
  NGS_CHECK(!added || std::int64_t(added->values.size()) == cloud.size(),
            "the added column has one value per Gaussian");
  std::vector<PlyProperty> columns;
  if (added) columns.push_back({.name = added->name});
  write_record(path, {cloud, keep, comments}, columns, [&](std::int64_t i, std::uint8_t* to) {
    if (added) ply_store_float(added->values[std::size_t(i)], to);
  });
}

std::vector<std::string> render_comments(const GaussianPly& ply) {
  std::vector<std::string> comments;
  for (const std::string& c : ply.comments)
    if (is_render_comment(c) || !vertical_axis_in(c).empty()) comments.push_back(c);
  return comments;
}

std::vector<std::string> further_columns(const GaussianPly& ply) {
  std::vector<std::string> names;
  const SelectedColumns columns = further(ply.rows);
  for (const PlyProperty& p : columns.properties()) names.push_back(p.name);
  return names;
}

void write_strict_ply(const std::string& path, const GaussianPly& ply, const std::vector<std::uint8_t>& keep,
                      const GaussianCloud* edited) {
  const SelectedColumns columns = further(ply.rows);
  write_record(path, {edited != nullptr ? *edited : ply.cloud, keep, render_comments(ply)}, columns.properties(),
               [&](std::int64_t i, std::uint8_t* to) { columns.copy(ply.rows.row(i), to); });
}

void write_labelled_ply(const std::string& path, const GaussianPly& source, std::span<const NamedLabels> objects,
                        const LabelledWrite& options) {
  const std::vector<LabelSet> sets = sets_of(objects);
  write_labelled_ply(path, source, std::span<const LabelSet>(sets), options);
}

void write_labelled_ply(const std::string& path, const GaussianPly& source, std::span<const LabelSet> objects,
                        const LabelledWrite& options) {
  NGS_CHECK(!objects.empty(), "at least one object");
  const LabelColumns all = union_of(objects);
  const std::int64_t rows = std::int64_t(all.label.size());
  const RowSource passthrough(source, options, rows);
  std::vector<Added> added = added_columns(objects, all);
  if (!options.fixed.empty()) added.push_back({std::string(kFixedColumn), nullptr, options.fixed});
  if (!options.floater.empty()) added.push_back({std::string(kFloaterColumn), nullptr, options.floater});
  if (!options.weight.empty()) added.push_back({std::string(kWeightColumn), nullptr, options.weight});

  PlyElement element;
  element.name = "vertex";
  element.count = rows;
  element.properties = passthrough.properties();
  for (const Added& a : added) {
    NGS_CHECK(std::int64_t(a.size()) == rows, "column " + a.name + " has one value per row");
    element.properties.push_back({.name = a.name});
  }
  const bool has_state = !options.state.empty();
  NGS_CHECK(!has_state || std::int64_t(options.state.size()) == rows, "state has one value per row");
  if (has_state) element.properties.push_back({.name = std::string(kStateColumn), .type = PlyType::kUint8});

  PlyWriter writer(path, element, labelled_comments(source, objects, options));
  constexpr std::int64_t kRowsAtOnce = 1 << 17;
  for (std::int64_t i = 0; i < rows; ++i) {
    if (i % kRowsAtOnce == 0) source.file.forget_pages();
    std::uint8_t* to = writer.row();
    passthrough.fill(i, to);
    to += passthrough.row_bytes();
    for (const Added& a : added) {
      ply_store_float(a[std::size_t(i)], to);
      to += sizeof(float);
    }
    if (has_state) *to = options.state[std::size_t(i)];
  }
  writer.commit();
}

void write_ply_rows(const std::string& path, const GaussianPly& source, const std::vector<std::uint8_t>& keep,
                    const std::optional<AddedColumn>& added) {
  const std::size_t n = std::size_t(source.cloud.size());
  NGS_CHECK(keep.size() == n && (!added || added->values.size() == n), "one entry per Gaussian");
  PlyElement element;
  element.name = "vertex";
  element.count = std::int64_t(std::ranges::count_if(keep, [](std::uint8_t k) { return k != 0; }));
  const SelectedColumns kept(source.rows, [&](const std::string& name) { return !added || name != added->name; });
  element.properties = kept.properties();
  if (added) element.properties.push_back({.name = added->name});
  PlyWriter writer(path, element, source.comments);
  constexpr std::size_t kRowsAtOnce = 1 << 17;
  for (std::size_t i = 0; i < n; ++i) {
    if (i % kRowsAtOnce == 0) source.file.forget_pages();
    if (!keep[i]) continue;
    std::uint8_t* to = writer.row();
    kept.copy(source.rows.row(std::int64_t(i)), to);
    if (added) ply_store_float(added->values[i], to + kept.row_bytes());
  }
  writer.commit();
}

}  // namespace ngs::io

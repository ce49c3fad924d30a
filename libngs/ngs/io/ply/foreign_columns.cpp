// Converts columns of other programs to the Inria layout: other names, SH beyond degree 3, and values after activation.
#include <algorithm>
#include <cmath>

#include "ngs/core/formatted.h"
#include "ngs/io/ply/gaussian_columns.h"
#include "ngs/io/ply/selected_columns.h"
#include "ngs/math/sh.h"
#include "ngs/math/stable.h"
#include "ngs/scene/supersplat_state.h"

namespace ngs::io {
namespace {

constexpr std::string_view kScalar = "scalar_", kRest = "f_rest_";
constexpr int kMaxCutDegree = 10;

std::string log_scale_name(int axis) { return "scale_" + std::to_string(axis); }

/// The k of a name f_rest_k; -1 for any other name.
int rest_index(std::string_view name) {
  if (!name.starts_with(kRest) || name.size() > kRest.size() + 4) return -1;
  int k = 0;
  for (const char c : name.substr(kRest.size())) {
    if (c < '0' || c > '9') return -1;
    k = 10 * k + (c - '0');
  }
  return name.size() == kRest.size() ? -1 : k;
}

/// The name in the Inria layout: CloudCompare writes scalar_NAME, other tools the parameters of nerfstudio and gsplat.
/// Other names stay.
std::string inria_name(std::string_view name) {
  constexpr std::pair<std::string_view, std::string_view> kStems[] = {
      {"rotation_", "rot_"},     {"rotations_", "rot_"},     {"quats_", "rot_"},       {"scaling_", "scale_"},
      {"scales_", "scale_"},     {"features_dc_", "f_dc_"},  {"sh0_", "f_dc_"},        {"shN_", "f_rest_"},
      {"features_rest_", kRest}, {"opacities_0", "opacity"}, {"opacity_0", "opacity"}, {"opacities", "opacity"},
      {"means_0", "x"},          {"means_1", "y"},           {"means_2", "z"},         {"rot_w", "rot_0"},
      {"rot_x", "rot_1"},        {"rot_y", "rot_2"},         {"rot_z", "rot_3"},       {"scale_x", "scale_0"},
      {"scale_y", "scale_1"},    {"scale_z", "scale_2"}};
  if (name.size() > kScalar.size() && name.starts_with(kScalar)) name.remove_prefix(kScalar.size());
  for (const auto& [theirs, ours] : kStems)
    if (name.starts_with(theirs) && name.find_first_not_of("0123456789", theirs.size()) == name.npos)
      return std::string(ours) + std::string(name.substr(theirs.size()));
  return std::string(name);
}

/// The finite values of some columns, sorted; empty if one of them is negative.
std::vector<float> sorted_unless_negative(const std::vector<PlyColumn>& columns, std::int64_t rows) {
  std::vector<float> values;
  for (std::int64_t i = 0; i < rows; ++i)
    for (const PlyColumn& column : columns) {
      const float v = column.value_float(i);
      if (v < 0) return {};
      if (std::isfinite(v)) values.push_back(v);
    }
  std::sort(values.begin(), values.end());
  return values;
}

double at_share(const std::vector<float>& sorted, double share) {
  return double(sorted[std::size_t(share * double(sorted.size() - 1))]);
}

/// The largest side of the box of the middle 80 % of the coordinates, per axis.
double bulk_side(const PlyTable& rows) {
  double side = 0;
  for (const char* axis : {"x", "y", "z"}) {
    const PlyColumn column = rows.column(axis);
    std::vector<float> values;
    for (std::int64_t i = 0; column && i < rows.rows; ++i)
      if (const float v = column.value_float(i); std::isfinite(v)) values.push_back(v);
    std::sort(values.begin(), values.end());
    if (!values.empty()) side = std::max(side, at_share(values, 0.9) - at_share(values, 0.1));
  }
  return side;
}

}  // namespace

bool is_gaussian_element(const PlyElement& vertex) {
  return std::ranges::any_of(vertex.properties, [](const PlyProperty& p) {
    return inria_name(p.name) == "scale_0" || p.name == "packed_position";
  });
}

std::string vertical_axis_in(std::string_view comment) {
  std::string text;
  for (const char c : comment)
    if (c != ' ' && c != '_' && c != '\t') text += c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  constexpr std::string_view kKey = "verticalaxis:";
  if (!text.starts_with(kKey)) return {};
  text.erase(0, kKey.size());
  if (text.starts_with("+")) text.erase(0, 1);
  return text == "x" || text == "z" || text == "-x" || text == "-y" || text == "-z" ? text : "";
}

std::string deleted_note(const std::vector<std::uint8_t>& state) {
  const auto deleted = std::ranges::count_if(state, [](std::uint8_t s) { return (s & kDeletedState) != 0; });
  if (deleted == 0) return {};
  return std::to_string(deleted) +
         " Gaussians are marked as deleted (state 4 of SuperSplat) and still used: export the "
         "model from the editor to be without them";
}

bool is_motion_column(std::string_view name) {
  constexpr std::string_view kStems[] = {"motion", "trbf", "omega", "scale_t", "scaling_t", "rot_r", "rotation_r"};
  return name == "t" || std::ranges::any_of(kStems, [&](std::string_view stem) { return name.starts_with(stem); });
}

std::string take_foreign_names(PlyTable& rows) {
  std::string first;
  bool has_rest = false;
  const bool is_inria = rows.find("scale_0") >= 0;  // scalar_NAME is then a column of its own
  for (PlyProperty& p : rows.properties) {
    if (is_inria && p.name.starts_with(kScalar)) continue;
    std::string name = inria_name(p.name);
    if (name == p.name || rows.find(name) >= 0) continue;
    if (first.empty()) first = p.name + " as " + name;
    has_rest |= name.starts_with(kRest) && !p.name.ends_with(name);
    p.name = std::move(name);
  }
  if (first.empty()) return {};
  return "columns are read by their names in 3DGS (" + first + ")" +
         (has_rest ? ", SH of degree 1 and more as f_rest_*: all of red, then green, then blue" : "");
}

int excess_sh_degree(std::size_t rest_columns) {
  for (int degree = 4; degree <= kMaxCutDegree; ++degree)
    if (rest_columns == 3 * std::size_t((degree + 1) * (degree + 1) - 1)) return degree;
  return 0;
}

std::size_t rest_columns_of(const PlyTable& rows) {
  return std::size_t(
      std::ranges::count_if(rows.properties, [](const PlyProperty& p) { return rest_index(p.name) >= 0; }));
}

PlyTable cut_sh(const PlyTable& rows, int degree) {
  const int before = (degree + 1) * (degree + 1) - 1, after = 15;
  const auto is_cut = [&](const std::string& name) {
    const int k = rest_index(name);
    return k >= 0 && k % before >= after;
  };
  PlyTable cut = copy_of(rows, {rows, [&](const std::string& name) { return !is_cut(name); }});
  for (PlyProperty& p : cut.properties)
    if (const int k = rest_index(p.name); k >= 0)
      p.name = std::string(kRest) + std::to_string(k / before * after + k % before);
  return cut;
}

std::string take_plain_colours(PlyTable& rows) {
  constexpr std::string_view kColours[] = {"red", "green", "blue"};
  const bool takes_colours = rows.find("f_dc_0") < 0, takes_alpha = rows.find("opacity") < 0;
  const auto is_integer = [](PlyType type) { return type != PlyType::kFloat32 && type != PlyType::kFloat64; };
  PlyTable out;
  std::vector<PlyProperty> properties = rows.properties;
  std::string names;
  for (PlyProperty& p : properties) {
    const auto colour = std::ranges::find(kColours, p.name);
    const std::string was = p.name;
    if (takes_colours && colour != std::end(kColours))
      p = {.name = "f_dc_" + std::to_string(colour - std::begin(kColours))};
    else if (is_integer(p.type) && (p.name == "opacity" || (takes_alpha && p.name == "alpha")))
      p = {.name = "opacity"};
    else
      continue;
    names += (names.empty() ? "" : " ") + was;
  }
  if (names.empty() || rows.find("scale_0") < 0) return {};
  out.set_properties(std::move(properties));
  out.rows = rows.rows;
  out.owned.resize(std::size_t(out.rows) * out.row_bytes);
  for (std::size_t p = 0; p < out.properties.size(); ++p) {
    const PlyColumn from = rows.column(rows.properties[p].name);
    const bool is_changed = out.properties[p].name != rows.properties[p].name || out.properties[p].type != from.type;
    const bool is_opacity = out.properties[p].name == "opacity";
    double most = is_integer(from.type) ? 2 : 0;
    for (std::int64_t i = 0; is_changed && i < rows.rows; ++i) most = std::max(most, from.value(i));
    const double scale = most < 2 ? 1 : most <= 255 ? 255 : 65535;
    for (std::int64_t i = 0; i < rows.rows; ++i) {
      std::uint8_t* to = out.owned.data() + std::size_t(i) * out.row_bytes + out.offset[p];
      const double v = is_changed ? clamp3(from.value(i) / scale, 0.0, 1.0) : 0;
      if (is_changed)
        ply_store(PlyType::kFloat32, is_opacity ? logit(v) : dc_of_colour(v), to);
      else
        std::memcpy(to, rows.row(i) + rows.offset[p], ply_type_bytes(from.type));
    }
  }
  rows = std::move(out);
  return names + ": colours and opacity without SH and logits, converted";
}

Activated find_activated(const PlyTable& rows) {
  constexpr std::int64_t kFewestRows = 16;  // fewer may lie within any range by chance
  constexpr double kMinRatio = 8;           // of a large length to a small one; logarithms span a smaller ratio
  constexpr double kMinSpan = 0.25;         // of opacities, of their full scale; a constant opacity is no evidence
  constexpr float kLargestLogit = 64;       // training ends far below, and gives some negative ones
  Activated found;
  std::vector<PlyColumn> scales, opacity{rows.column("opacity")};
  for (int axis = 0; axis < 3; ++axis)
    if (const PlyColumn column = rows.column(log_scale_name(axis))) scales.push_back(column);
  if (rows.rows < kFewestRows || scales.empty() || !opacity[0]) return found;
  const std::vector<float> opacities = sorted_unless_negative(opacity, rows.rows);
  const float most = std::int64_t(opacities.size()) == rows.rows ? opacities.back() : INFINITY;
  if (most > kLargestLogit && most <= 255) found.full_opacity = most <= 100 ? 100 : 255;
  const bool is_in_range = most <= 1 || found.full_opacity > 1;
  found.opacity = is_in_range && opacities.back() - opacities.front() >= kMinSpan * found.full_opacity;
  const std::vector<float> lengths = sorted_unless_negative(scales, rows.rows);
  if (std::int64_t(lengths.size()) < kFewestRows) return found;
  found.median_scale = at_share(lengths, 0.5);
  const double high = at_share(lengths, 0.99);
  const bool spread = kMinRatio * at_share(lengths, 0.01) <= high;
  const bool small = high < 1 || std::exp(found.median_scale) > bulk_side(rows);  // too small for logarithms
  found.scale = high > 0 && int(found.opacity) + int(spread) + int(small) >= 2;
  found.opacity |= found.scale && is_in_range;  // programs write both before activation, or both after
  return found;
}

std::string describe(const Activated& activated) {
  std::string text;
  if (activated.scale)
    text =
        "scale_* all > 0, half of them below " + std::to_string(activated.median_scale) + ": lengths, not logarithms";
  if (activated.opacity)
    text += std::string(text.empty() ? "" : "; ") + "opacity 0 to " + formatted("%g", activated.full_opacity) +
            ": activated, not logits";
  return text;
}

PlyTable deactivated(const PlyTable& rows, const Activated& activated) {
  PlyTable out = copy_of(rows, {rows, [](const std::string&) { return true; }});
  for (std::size_t p = 0; p < out.properties.size(); ++p) {
    const std::string& name = out.properties[p].name;
    const bool is_opacity = activated.opacity && name == "opacity";
    const bool is_scale = activated.scale && (name == "scale_0" || name == "scale_1" || name == "scale_2");
    if (!is_opacity && !is_scale) continue;
    const PlyColumn from = rows.column(name);
    for (std::int64_t i = 0; i < rows.rows; ++i) {
      const double v = from.value(i);
      ply_store(out.properties[p].type, is_opacity ? logit(v / activated.full_opacity) : std::log(v),
                out.owned.data() + std::size_t(i) * out.row_bytes + out.offset[p]);
    }
  }
  return out;
}

}  // namespace ngs::io

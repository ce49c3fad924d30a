// Converts columns of other programs to the Inria layout: other names, SH beyond degree 3, and values after activation.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>

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

/// The finite values of some columns times `sign`, sorted; empty if one of them is negative.
std::vector<float> sorted_unless_negative(const std::vector<PlyColumn>& columns, std::int64_t rows, float sign) {
  std::vector<float> values;
  for (std::int64_t i = 0; i < rows; ++i)
    for (const PlyColumn& column : columns) {
      const float v = sign * column.value_float(i);
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

/// A property that gets another name, and other values of a floating-point type.
struct Conversion {
  std::size_t property = 0;
  std::string name;
  std::function<double(double)> value;
};

PlyTable converted(const PlyTable& rows, const std::vector<Conversion>& conversions) {
  PlyTable out;
  std::vector<PlyProperty> properties = rows.properties;
  std::vector<PlyColumn> from;
  for (const Conversion& c : conversions) {
    PlyProperty& p = properties[c.property];
    from.push_back(rows.column(p.name));
    p = {c.name, p.type == PlyType::kFloat64 ? PlyType::kFloat64 : PlyType::kFloat32};
  }
  out.set_properties(std::move(properties));
  out.rows = rows.rows;
  out.owned.resize(std::size_t(out.rows) * out.row_bytes);
  for (std::int64_t i = 0; i < rows.rows; ++i) {
    std::uint8_t* to = out.owned.data() + std::size_t(i) * out.row_bytes;
    for (std::size_t p = 0; p < out.properties.size(); ++p)
      if (out.properties[p].type == rows.properties[p].type)
        std::memcpy(to + out.offset[p], rows.row(i) + rows.offset[p], ply_type_bytes(out.properties[p].type));
    for (std::size_t c = 0; c < from.size(); ++c) {
      const std::size_t p = conversions[c].property;
      ply_store(out.properties[p].type, conversions[c].value(from[c].value(i)), to + out.offset[p]);
    }
  }
  return out;
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
  if (rows.find("scale_0") < 0) return {};
  const bool takes_colours = rows.find("f_dc_0") < 0, takes_alpha = rows.find("opacity") < 0;
  const auto is_integer = [](PlyType type) { return type != PlyType::kFloat32 && type != PlyType::kFloat64; };
  std::vector<Conversion> conversions;
  std::string names;
  for (std::size_t p = 0; p < rows.properties.size(); ++p) {
    const std::string was = rows.properties[p].name;
    const PlyType type = rows.properties[p].type;
    const auto colour = std::ranges::find(kColours, was);
    const bool is_colour = takes_colours && colour != std::end(kColours);
    if (!is_colour && !(is_integer(type) && (was == "opacity" || (takes_alpha && was == "alpha")))) continue;
    const PlyColumn from = rows.column(was);
    double most = is_integer(type) ? 2 : 0;
    for (std::int64_t i = 0; i < rows.rows; ++i) most = std::max(most, from.value(i));
    const double scale = most < 2 ? 1 : most <= 255 ? 255 : 65535;
    const auto to_share = [scale](double v) { return clamp3(v / scale, 0.0, 1.0); };
    if (is_colour)
      conversions.push_back({p, "f_dc_" + std::to_string(colour - std::begin(kColours)),
                             [=](double v) { return double(dc_of_colour(to_share(v))); }});
    else
      conversions.push_back({p, "opacity", [=](double v) { return logit(to_share(v)); }});
    names += (names.empty() ? "" : " ") + was;
  }
  if (names.empty()) return {};
  rows = converted(rows, conversions);
  return names + ": colours and opacity without SH and logits, converted";
}

std::string take_plain_rotations(PlyTable& rows) {
  constexpr std::int64_t kFewestRows = 16, kMostOthers = 100;  // one row of a hundred may be no rotation
  constexpr double kMaxError = 0.03;                           // of the norm; of bytes at most .008
  const struct Code {
    double middle, half;
    const char* what;
  } codes[] = {{128, 128, "bytes"}, {0.5, 0.5, "values in 0..1"}};
  std::array<PlyColumn, 4> from;
  for (std::size_t k = 0; k < 4; ++k)
    if (from[k] = rows.column("rot_" + std::to_string(k)); !from[k]) return {};
  const auto all_rows_but = [&](std::int64_t others, const auto& test) {  // ends at the first row too many
    for (std::int64_t i = 0; i < rows.rows; ++i)
      if (!test(std::array{from[0].value(i), from[1].value(i), from[2].value(i), from[3].value(i)}) && --others < 0)
        return false;
    return rows.rows > 0;
  };
  const auto convert = [&](const std::function<double(double)>& first, const std::function<double(double)>& others) {
    std::vector<Conversion> conversions;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::string name = "rot_" + std::to_string(k);
      conversions.push_back({std::size_t(rows.find(name)), name, k == 0 ? first : others});
    }
    rows = converted(rows, conversions);
  };
  if (all_rows_but(0, [](const auto& q) { return std::ranges::count(q, 0) == 4; })) {
    convert([](double) { return 1; }, [](double) { return 0; });
    return "rot_* are all 0: read as Gaussians that are not turned";
  }
  for (const Code& code : codes) {
    const auto decoded = [&code](double v) { return (v - code.middle) / code.half; };
    const auto is_coded = [&](const auto& q) {
      double norm2 = 0;
      for (const double v : q) norm2 += v < 0 ? INFINITY : decoded(v) * decoded(v);
      return std::abs(std::sqrt(norm2) - 1) < kMaxError;
    };
    if (rows.rows < kFewestRows || !all_rows_but(rows.rows / kMostOthers, is_coded)) continue;
    convert(decoded, decoded);
    return std::string("rot_* are ") + code.what + ": converted to -1..1";
  }
  return {};
}

Activated find_activated(const PlyTable& rows) {
  constexpr std::int64_t kFewestRows = 16;  // fewer may lie within any range by chance
  constexpr double kMinRatio = 8;           // of a large length to a small one; logarithms span a smaller ratio
  constexpr double kMinSpan = 0.01;         // of opacities, of their full scale; a constant opacity is no evidence
  constexpr float kLargestLogit = 64;       // training ends far below, and gives some negative ones
  // Logarithm of an opacity that 1 % exceed: -.08 to 0 in five trained models. Of their logits 22 % or more are above
  // 0.
  constexpr double kNearFull = -0.1;
  Activated found;
  std::vector<PlyColumn> scales, opacity{rows.column("opacity")};
  for (int axis = 0; axis < 3; ++axis)
    if (const PlyColumn column = rows.column(log_scale_name(axis))) scales.push_back(column);
  if (rows.rows < kFewestRows || scales.empty() || !opacity[0]) return found;
  const std::vector<float> opacities = sorted_unless_negative(opacity, rows.rows, 1);
  const float most = std::int64_t(opacities.size()) == rows.rows ? opacities.back() : INFINITY;
  if (most > kLargestLogit && most <= 255) found.full_opacity = most <= 100 ? 100 : 255;
  const bool is_in_range = most <= 1 || found.full_opacity > 1;
  found.opacity = is_in_range && opacities.back() - opacities.front() >= kMinSpan * found.full_opacity;
  found.ones = most == 1 && opacities.front() == 1;
  if (const std::vector<float> negated = sorted_unless_negative(opacity, rows.rows, -1);
      std::int64_t(negated.size()) == rows.rows && at_share(negated, 0.01) < -kNearFull && negated.back() > 1) {
    found.opacity = true;
    found.full_opacity = 0;
  }
  const std::vector<float> lengths = sorted_unless_negative(scales, rows.rows, 1);
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
    text += (text.empty() ? "" : "; ") +
            (activated.full_opacity > 0 ? "opacity 0 to " + formatted("%g", activated.full_opacity) + ": activated"
                                        : std::string("opacity all <= 0 and many near it: logarithms of 0 to 1")) +
            ", not logits";
  return text;
}

PlyTable deactivated(const PlyTable& rows, const Activated& activated) {
  std::vector<Conversion> conversions;
  for (std::size_t p = 0; p < rows.properties.size(); ++p) {
    const std::string& name = rows.properties[p].name;
    if (activated.opacity && name == "opacity")
      conversions.push_back({p, name, [&](double v) {
                               return logit(activated.full_opacity > 0 ? v / activated.full_opacity : std::exp(v));
                             }});
    if (activated.scale && (name == "scale_0" || name == "scale_1" || name == "scale_2"))
      conversions.push_back({p, name, [](double v) { return std::log(v); }});
  }
  return converted(rows, conversions);
}

}  // namespace ngs::io

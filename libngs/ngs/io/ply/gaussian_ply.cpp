#include "ngs/io/ply/gaussian_ply.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "ngs/core/error.h"
#include "ngs/io/capture/foreign_source.h"
#include "ngs/io/files/shell_word.h"
#include "ngs/io/formats/compression/packed_model.h"
#include "ngs/io/formats/splat_format.h"
#include "ngs/io/ply/gaussian_columns.h"
#include "ngs/io/ply/ply_scan.h"
#include "ngs/scene/view_names.h"

namespace ngs::io {
namespace {
constexpr std::string_view kTrainFlags = "train_flags";  // "train_flags antialiasing": proposed for 3DGS

struct Columns {
  std::array<PlyColumn, 3> position, scale, sh_dc;
  std::array<PlyColumn, 4> rotation;
  PlyColumn opacity;
  std::vector<PlyColumn> rest;  // file order: channel-major
};

class Reader {
 public:
  Reader(GaussianPly& ply, const ReadOptions& options) : ply_(ply), name_(ply.file.name()), options_(options) {}

  void read() {
    load_rows();
    interpret_rows();
  }

  /// For a table of decoded rows, from a format other than PLY.
  void interpret_rows() {
    find_columns();
    ply_.cloud.resize(ply_.rows.rows, options_.bands == HigherBands::kRead ? degree() : 0);
    choose_origin();
    find_labels();
    copy_rows();
    check_weight();
    read_comments();
    ply_.health = classify(ply_.cloud);
  }

 private:
  [[noreturn]] void bad(const std::string& message, std::string remedy = {}) const {
    throw Error(ErrorCode::kBadInput, name_ + ": " + message, std::move(remedy));
  }

  void load_rows() {
    ply_.comments = ply_.file.comments();
    if (is_compressed(ply_.file)) {
      ply_.rows = decode_compressed(ply_.file);
      ply_.notes.push_back("compressed.ply: attributes are quantised");
      adapt_foreign_columns();
      return;
    }
    const PlyElement* vertex = ply_.file.find("vertex");
    if (vertex == nullptr) bad("no element 'vertex', expected a Gaussian splatting model");
    ply_.rows = ply_.file.table(*vertex);
    if (ply_.rows.properties.size() != vertex->properties.size())
      ply_.notes.push_back("list properties of the Gaussians are left out");
    for (const PlyElement& e : ply_.file.elements())
      if (&e != vertex) ply_.notes.push_back("element '" + e.name + "' is left out");
    adapt_foreign_columns();
    if (has_3d_filter(ply_.rows)) fuse_filter();
  }

  void adapt_foreign_columns() {
    if (const std::string note = take_foreign_names(ply_.rows); !note.empty()) ply_.notes.push_back(note);
    for (const auto& convert : {take_plain_colours, take_plain_rotations})
      if (const std::string note = convert(ply_.rows); !note.empty()) ply_.notes.push_back(note);
    if (const int degree = excess_sh_degree(rest_columns_of(ply_.rows)); degree > 0) {
      ply_.rows = cut_sh(ply_.rows, degree);
      ply_.notes.push_back("SH of degree 4 and more are left out, 0 to 3 are read");
    }
    Activated activated = find_activated(ply_.rows);
    if (options_.encoding == ValueEncoding::kActivated) {
      activated.opacity |= activated.ones;
      if (!activated)
        bad("scale_* and opacity are already logarithms and logits, expected lengths and opacities in 0..1");
      ply_.rows = deactivated(ply_.rows, activated);
      ply_.notes.push_back(describe(activated) + ": converted");
    } else if (activated) {
      bad(describe(activated) + ", expected values as they are before activation",
          "to convert them: ngs-extract " + shell_word(name_) + " --activated --object-ply converted.ply");
    } else if (activated.ones) {
      ply_.notes.push_back("opacity is 1 in every row, as a logit .73; if the Gaussians are opaque: ngs-extract " +
                           shell_word(name_) + " --activated --object-ply opaque.ply");
    }
  }

  /// Programs that train with a 3D filter render with the opacity compensation. Files written by ngs lack the column.
  void fuse_filter() {
    ply_.rows = fuse_3d_filter(ply_.rows);
    ply_.comments.push_back(kAntialiasedComment);
    ply_.notes.push_back("filter_3D (Mip-Splatting) is applied to scales and opacities, as its renderer does");
  }

  PlyColumn required(const std::string& column) const {
    const PlyColumn found = ply_.rows.column(column);
    if (found) return found;
    const auto& p = ply_.rows.properties;
    const std::string range = p.empty() ? ""
                                        : " (found " + std::to_string(p.size()) + " properties, " + p.front().name +
                                              " ... " + p.back().name + ")";
    bad("vertex property '" + column + "' is missing" + range, remedy_for(column));
  }

  std::string remedy_for(const std::string& missing) const {
    if (const PlyElement* face = ply_.file.find("face"); face != nullptr && face->count > 0)
      return "this is a mesh, not a Gaussian model: export the splat as PLY with the program that trained it";
    if (ply_.rows.find("red") < 0) return {};
    return missing.starts_with("scale_")
               ? "this is a point cloud, not a Gaussian model: ngs-fit makes one from posed photos"
               : "";
  }

  void find_columns() {
    columns_.position = {required("x"), required("y"), required("z")};
    columns_.scale = {required("scale_0"), required("scale_1"), ply_.rows.column("scale_2")};
    for (int k = 0; k < 4; ++k) columns_.rotation[std::size_t(k)] = required("rot_" + std::to_string(k));
    columns_.opacity = required("opacity");
    for (int c = 0; c < 3; ++c) columns_.sh_dc[std::size_t(c)] = required("f_dc_" + std::to_string(c));
    const std::size_t rest = rest_columns_of(ply_.rows);
    if (rest != 0 && rest != 9 && rest != 24 && rest != 45)
      bad(std::to_string(rest) + " properties f_rest_*, expected 0, 9, 24 or 45 (SH degree 0 to 3)");
    for (std::size_t k = 0; k < rest; ++k) columns_.rest.push_back(required("f_rest_" + std::to_string(k)));
    if (!columns_.scale[2])
      ply_.notes.push_back("no scale_2 (a 2DGS model): read as flat Gaussians, 1/1000 of the smaller scale thick");
  }

  int degree() const {
    for (int degree = 0; degree < 3; ++degree)
      if (std::size_t(sh_rest_count(degree)) * 3 == columns_.rest.size()) return degree;
    return 3;
  }

  // Only double coordinates have detail that float would lose. The centre is rounded to float, so that a strict file
  // and its cameras need no more digits than float has.
  void choose_origin() {
    if (const auto named = origin_in(ply_.comments)) {
      ply_.cloud.origin = *named;
      is_relative_ = true;
      ply_.notes.push_back("positions are relative to the origin that the comment ngs-origin names");
    } else if (const auto found = far_origin(columns_.position, ply_.rows.rows)) {
      ply_.cloud.origin = *found;
      ply_.notes.push_back("double positions far from 0 are converted to float relative to their centre");
    }
  }

  /// Calls f(row) for all rows; only a part of a mapped file is in memory at a time.
  template <class F>
  void for_each_row(const F& f) const {
    constexpr std::int64_t kRowsAtOnce = 1 << 17;
    for (std::int64_t i = 0; i < ply_.rows.rows; ++i) {
      if (i % kRowsAtOnce == 0) ply_.file.forget_pages();
      f(i);
    }
    ply_.file.forget_pages();
  }

  /// One pass over all rows: a file with many objects has hundreds of columns, and its rows do not stay in memory.
  void copy_rows() {
    for_each_row([&](std::int64_t i) {
      copy_position(i);
      copy_attributes(i);
      copy_labels(i);
    });
  }

  void copy_position(std::int64_t i) {
    for (std::size_t a = 0; a < 3; ++a) {
      const PlyColumn& column = columns_.position[a];
      const double origin = is_relative_ ? 0 : ply_.cloud.origin[a];
      ply_.cloud.position[std::size_t(i) * 3 + a] =
          column.type == PlyType::kFloat32 && origin == 0 ? column.value_float(i) : float(column.value(i) - origin);
    }
  }

  void copy_attributes(std::int64_t i) {
    GaussianCloud& cloud = ply_.cloud;
    const std::size_t r = std::size_t(i), rest = columns_.rest.size() / 3;
    for (std::size_t k = 0; k < 4; ++k) cloud.rotation[r * 4 + k] = columns_.rotation[k].value_float(i);
    for (std::size_t c = 0; c < 3; ++c) cloud.sh_dc[r * 3 + c] = columns_.sh_dc[c].value_float(i);
    cloud.logit_opacity[r] = columns_.opacity.value_float(i);
    float* scale = &cloud.log_scale[r * 3];
    for (std::size_t k = 0; k < 2; ++k) scale[k] = columns_.scale[k].value_float(i);
    scale[2] = columns_.scale[2] ? columns_.scale[2].value_float(i) : std::min(scale[0], scale[1]) - kLog1000;
    if (options_.bands == HigherBands::kCheckOnly) {
      // A non-finite SH band excludes the row, and so does a non-finite constant band.
      for (const PlyColumn& column : columns_.rest)
        if (!std::isfinite(column.value_float(i))) cloud.sh_dc[r * 3] = NAN;
      return;
    }
    float* to = cloud.sh_rest.data() + r * rest * 3;
    for (std::size_t k = 0; k < rest; ++k)
      for (std::size_t c = 0; c < 3; ++c) to[k * 3 + c] = columns_.rest[c * rest + k].value_float(i);
  }

  void copy_labels(std::int64_t i) {
    const auto row = std::size_t(i);
    for (const auto& [from, to] : wanted_.others) (*to)[row] = from.value_float(i);
    for (const WantedLabel& w : wanted_.labels) {
      const float value = w.from.value_float(i);
      check_range(w, value, i);
      (*w.to)[row] = value;
    }
    if (wanted_.state) ply_.state[row] = state_of(wanted_.state.value_float(i));
    if ((row + 1) % LabelColumn::kPageRows == 0 || i + 1 == ply_.rows.rows) share_views(row);
  }
  static std::uint8_t state_of(float v) { return v >= 0 && v <= 255 ? std::uint8_t(v) : std::uint8_t(0); }

  struct WantedLabel {
    PlyColumn from;
    LabelColumn* to;
    std::string name;
    float most;
  };
  struct Wanted {
    std::vector<WantedLabel> labels;
    std::vector<std::pair<PlyColumn, std::vector<float>*>> others;
    PlyColumn state;
  };

  /// Reads a column into `to`, which stays empty if the column is absent.
  void want(const std::string& column, std::vector<float>& to) {
    const PlyColumn from = ply_.rows.column(column);
    if (from) {
      wanted_.others.push_back({from, &to});
      to.resize(std::size_t(ply_.rows.rows));
    }
  }

  void want_labels(const std::string& suffix, LabelColumns& set) {
    for (const LabelField& f : kLabelFields) {
      const std::string name = std::string(f.name) + suffix;
      const PlyColumn from = ply_.rows.column(name);
      if (!from) continue;
      (set.*f.column).resize(std::size_t(ply_.rows.rows));
      wanted_.labels.push_back({from, &(set.*f.column), name, f.column == &LabelColumns::views ? INFINITY : 1.f});
    }
  }

  static constexpr const char* kLabelAgain = "label the model again: ngs-variance scene.json -o boundary.ply";

  void check_range(const WantedLabel& w, float value, std::int64_t i) const {
    constexpr float kRounding = 1e-4f;  // tolerance for rounding in other programs
    if (std::isfinite(value) && value >= -kRounding && value <= w.most + kRounding) return;
    bad(w.name + " of row " + std::to_string(i) + ": " + std::to_string(value) + ", expected " +
            (std::isinf(w.most) ? "a number of views" : "0 to 1"),
        kLabelAgain);
  }

  void check_weight() const {
    constexpr float kMaxWeight = 0x1p60f;  // more pixels than any set of views has; exact sums can hold it
    const auto wrong = std::ranges::find_if(ply_.weight, [](float w) { return !(w >= 0 && w <= kMaxWeight); });
    if (wrong == ply_.weight.end()) return;
    bad(std::string(kWeightColumn) + " of row " + std::to_string(wrong - ply_.weight.begin()) + ": " +
            std::to_string(*wrong) + ", expected a number of pixels",
        kLabelAgain);
  }

  /// Shares `views` between objects: most Gaussians are seen by the same views for every object.
  void share_views(std::size_t row) {
    for (std::size_t k = 1; k < ply_.objects.size(); ++k) {
      LabelColumn& views = ply_.objects[k].columns.views;
      const LabelColumn& first = ply_.objects[0].columns.views;
      if (views.size() == first.size() && !views.empty()) views.share(first, row);
    }
  }

  // Object names come from the comment if it agrees with the columns, else from the columns.
  std::vector<std::string> object_names() const {
    for (const std::string& comment : ply_.comments) {
      if (!comment.starts_with(kObjectsComment)) continue;
      const auto json = nlohmann::json::parse(comment.substr(kObjectsComment.size()), nullptr, false);
      std::vector<std::string> names;
      if (json.is_array())
        for (const auto& name : json)
          if (name.is_string()) names.push_back(name);
      return names;
    }
    return {};
  }

  /// Object names are used as names of mask folders.
  std::string checked(const std::string& object) const {
    if (!is_folder_name(object)) bad("object name \"" + printable(object) + "\", expected a name that can be a folder");
    return object;
  }

  void find_labels() {
    const std::vector<std::string> names = object_names();
    if (names.size() == 1) {
      ply_.object = checked(names[0]);
      ply_.names_object = true;
    }
    const std::string prefix = std::string(kLabelFields[0].name) + "_";
    const std::vector<std::string> known = column_suffixes(names);
    std::vector<std::string> suffixes;
    for (const PlyProperty& p : ply_.rows.properties) {
      if (!p.name.starts_with(prefix)) continue;
      const std::string suffix = p.name.substr(prefix.size());
      const std::size_t named = std::size_t(std::ranges::find(known, suffix) - known.begin());
      ply_.objects.push_back({checked(named < names.size() ? names[named] : suffix), {}});
      suffixes.push_back("_" + suffix);
    }
    want_labels("", ply_.labels);
    for (std::size_t k = 0; k < suffixes.size(); ++k) want_labels(suffixes[k], ply_.objects[k].columns);
    want(std::string(kFixedColumn), ply_.fixed);
    want(std::string(kWeightColumn), ply_.weight);
    wanted_.state = ply_.rows.column(std::string(kStateColumn));
    if (wanted_.state) ply_.state.resize(std::size_t(ply_.rows.rows));
  }

  void read_comments() {
    for (const std::string& comment : ply_.comments) {
      if (const std::string axis = vertical_axis_in(comment); !axis.empty()) ply_.vertical_axis = axis;
      if (!is_render_comment(comment)) continue;
      ply_.cloud.antialiased |= comment.find("mip") != std::string::npos || comment.find('1') != std::string::npos ||
                                comment.find("true") != std::string::npos || comment.starts_with(kTrainFlags);
    }
    if (std::ranges::any_of(ply_.rows.properties, [](const PlyProperty& p) { return is_motion_column(p.name); }))
      ply_.notes.push_back("a splat that moves: read as its state at the reference time");
    if (ply_.cloud.antialiased) ply_.notes.push_back("trained with antialiasing");
    if (const std::string note = deleted_note(ply_.state); !note.empty()) ply_.notes.push_back(note);
    ply_.rule = rule_in(ply_.comments, name_);
  }

  static constexpr float kLog1000 = 6.9077554f;
  GaussianPly& ply_;
  std::string name_;
  ReadOptions options_;
  Columns columns_;
  Wanted wanted_;
  bool is_relative_ = false;  // positions in the file are relative to an origin
};

}  // namespace

bool is_render_comment(std::string_view comment) {
  return comment.starts_with("SplatRenderMode") || comment.starts_with("antialiased") ||
         (comment.starts_with(kTrainFlags) && comment.find("antialiasing") != comment.npos);
}

std::vector<std::string> column_suffixes(const std::vector<std::string>& objects) {
  std::vector<std::string> suffixes;
  for (const std::string& object : objects) {
    std::string suffix = object;
    for (char& c : suffix) {
      const bool plain =
          (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-';
      if (!plain) c = '_';
    }
    while (std::ranges::find(suffixes, suffix) != suffixes.end()) suffix += "." + std::to_string(suffixes.size() + 1);
    suffixes.push_back(suffix);
  }
  return suffixes;
}

namespace {

GaussianPly read(PlyFile file, const ReadOptions& options = {}) {
  GaussianPly ply;
  ply.file = std::move(file);
  Reader(ply, options).read();
  return ply;
}

GaussianPly read(const std::string& name, DecodedSplat decoded, const ReadOptions& options) {
  if (options.encoding == ValueEncoding::kActivated)
    throw Error(ErrorCode::kBadInput, name + ": not a PLY, expected one whose columns hold activated values",
                "leave out --activated: only a PLY can hold activated values");
  GaussianPly ply;
  ply.file = PlyFile::named(name);
  ply.rows = std::move(decoded.rows);
  ply.notes = std::move(decoded.notes);
  if (decoded.antialiased) ply.comments.push_back(kAntialiasedComment);
  Reader(ply, options).interpret_rows();
  return ply;
}

}  // namespace

GaussianPly read_gaussian_ply(const std::string& path, const ReadOptions& options) {
  MappedFile mapped(path);
  const SplatFormat format = input_format(path, mapped.bytes());
  if (!begins_like_ply(mapped.bytes()) && (format == SplatFormat::kPly || format == SplatFormat::kSog))
    refuse_foreign_file(path);
  if (format == SplatFormat::kSpz || format == SplatFormat::kSog) {
    if (std::optional<PackedPly> packed = unpack_ply(path, mapped.bytes())) {
      GaussianPly ply = read(PlyFile::parse(path, MappedFile(std::move(packed->bytes))), options);
      ply.notes.push_back(packed->note);
      return ply;
    }
  }
  if (format != SplatFormat::kPly) return read(path, decode_splat(format, path, mapped.bytes()), options);
  refuse_known_file(path, mapped.bytes());
  return read(PlyFile::parse(path, std::move(mapped)), options);
}

GaussianPly parse_gaussian_ply(std::string name, Bytes bytes) { return read(PlyFile::parse(std::move(name), bytes)); }

}  // namespace ngs::io

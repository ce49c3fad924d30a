// Counts Gaussians that a run labelled, removed or changed, by the object they belong to: for pipelines/objects.sh.
//
//   ngs_touched IDS BOUNDARY LABELLED ID...
//
// IDS has one byte per Gaussian, in the order of both models: the id of its object, 0 for background. BOUNDARY is the
// input of ngs-joint, LABELLED its output, with an ID for each of their objects. The region is that of
// problem/region.h: Gaussians that partly belong to an object. stdout: a line per ID, tab separated:
//
//   ID OWN OTHERS BACKGROUND REMOVED CHANGED OUTSIDE_GIVEN OUTSIDE
//
// OWN, OTHERS, BACKGROUND: Gaussians with this id, another id or no id that LABELLED assigns to the object. Then
// Gaussians of other objects: REMOVED as floaters; CHANGED in a byte of the object's or the model's columns. Then
// changed Gaussians of other objects or background: OUTSIDE_GIVEN outside the region of BOUNDARY, OUTSIDE outside the
// regions of both files.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>

#include "ngs/core/error.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/problem/region.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs::bench {
namespace {

struct Counts {
  std::int64_t own = 0, others = 0, background = 0, removed = 0, changed = 0, outside_given = 0, outside = 0;
};

std::vector<std::uint8_t> read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<LabelColumns> labels_of(io::GaussianPly& ply) {
  std::vector<LabelColumns> labels;
  for (io::NamedLabels& named : ply.objects) labels.push_back(std::move(named.columns));
  if (labels.empty()) labels.push_back(std::move(ply.labels));
  return labels;
}

/// Columns of the model in both files, for comparison by row.
class ModelColumns {
 public:
  ModelColumns(const io::PlyTable& given, const io::PlyTable& made) : given_(given), made_(made) {
    for (std::size_t p = 0; p < given.properties.size(); ++p) {
      if (given.properties[p].name.starts_with("ngs_")) continue;
      for (std::size_t q = 0; q < made.properties.size(); ++q)
        if (given.properties[p].name == made.properties[q].name)
          columns_.push_back({given.offset[p], made.offset[q], io::ply_type_bytes(given.properties[p].type)});
    }
    if (columns_.empty()) throw Error(ErrorCode::kBadInput, "the models have no column in common");
  }
  bool same(std::int64_t row) const {
    for (const Column& c : columns_)
      if (std::memcmp(given_.row(row) + c.given, made_.row(row) + c.made, c.bytes) != 0) return false;
    return true;
  }

 private:
  struct Column {
    std::size_t given, made, bytes;
  };
  const io::PlyTable &given_, &made_;
  std::vector<Column> columns_;
};

struct Run {
  io::GaussianPly given, made;
  std::vector<LabelColumns> given_labels, made_labels;  // one per object

  Run(const std::string& boundary, const std::string& labelled)
      : given(io::read_gaussian_ply(boundary)),
        made(io::read_gaussian_ply(labelled)),
        given_labels(labels_of(given)),
        made_labels(labels_of(made)) {}

  bool same_labels(std::size_t object, std::size_t row) const {
    return std::ranges::all_of(kLabelColumns, [&](const auto column) {
      const float given = (given_labels[object].*column)[row], made = (made_labels[object].*column)[row];
      return std::memcmp(&given, &made, sizeof given) == 0;
    });
  }
};

std::vector<Counts> count(const std::vector<std::uint8_t>& ids, const Run& run, const std::vector<int>& object_id) {
  const std::size_t rows = ids.size();
  if (std::size_t(run.given.cloud.size()) != rows || std::size_t(run.made.cloud.size()) != rows ||
      run.given_labels.size() != object_id.size() || run.made_labels.size() != object_id.size())
    throw Error(ErrorCode::kInconsistent, "rows or objects differ, expected those of BOUNDARY and IDS");
  const std::vector<std::uint8_t> of_given = region_of(run.given_labels), of_made = region_of(run.made_labels);
  const ModelColumns model(run.given.rows, run.made.rows);
  const io::PlyColumn floater = run.made.rows.column("ngs_floater");
  std::vector<Counts> counts(object_id.size());
  for (std::size_t row = 0; row < rows; ++row) {
    const bool same_model = model.same(std::int64_t(row));
    for (std::size_t k = 0; k < counts.size(); ++k) {
      Counts& c = counts[k];
      const bool own = ids[row] == object_id[k], others = !own && ids[row] != 0;
      if (label_is_foreground(run.made_labels[k].label[row])) ++(own ? c.own : others ? c.others : c.background);
      c.removed += others && floater && floater.value_float(std::int64_t(row)) != 0;
      if (own || (same_model && run.same_labels(k, row))) continue;
      c.changed += others, c.outside_given += !of_given[row], c.outside += !of_given[row] && !of_made[row];
    }
  }
  return counts;
}

int print(int argc, char** argv) {
  std::vector<int> object_id;
  for (int a = 4; a < argc; ++a) object_id.push_back(std::atoi(argv[a]));
  const std::vector<Counts> counts = count(read_bytes(argv[1]), Run(argv[2], argv[3]), object_id);
  for (std::size_t k = 0; k < counts.size(); ++k) {
    std::cout << object_id[k];
    const Counts& c = counts[k];
    for (const std::int64_t n : {c.own, c.others, c.background, c.removed, c.changed, c.outside_given, c.outside})
      std::cout << '\t' << n;
    std::cout << '\n';
  }
  return 0;
}

}  // namespace
}  // namespace ngs::bench

int main(int argc, char** argv) {
  if (argc < 5) {
    std::cerr << "ngs_touched IDS BOUNDARY LABELLED ID...\n";
    return 2;
  }
  try {
    return ngs::bench::print(argc, argv);
  } catch (const ngs::Error& error) {
    std::cerr << "ngs_touched: " << error.what() << '\n';
    return int(error.code());
  }
}

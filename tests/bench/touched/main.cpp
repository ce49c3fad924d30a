// What a run changed, counted by whose Gaussians they are: for pipelines/results.sh ids.
//
//   ngs_touched IDS BOUNDARY LABELLED ID...
//
// IDS has one byte a Gaussian, in the order of both models: the number of its object, 0 for nobody's. BOUNDARY is what
// ngs-joint was given, LABELLED what it made of it, an ID for each object of theirs. The region is problem/region.h's:
// what is partly an object's. stdout: a line for each ID, tab separated:
//
//   ID OWN OTHERS NOBODYS REMOVED CHANGED BEYOND_GIVEN BEYOND
//
// OWN, OTHERS, NOBODYS: Gaussians with this id, another, none, that LABELLED says are the object's. Then rows that do
// not have this id but another: REMOVED as floaters; CHANGED, byte for byte, in the object's columns or the model's;
// of these BEYOND_GIVEN outside of the region of BOUNDARY, BEYOND of either's. Nobody's rows are among the last two.
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
  std::int64_t own = 0, others = 0, nobodys = 0, removed = 0, changed = 0, beyond_given = 0, beyond = 0;
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

/// The model's columns, in the rows of both files.
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
    throw Error(ErrorCode::kInconsistent, "other rows or objects, expected those of the given model and its ids");
  const std::vector<std::uint8_t> of_given = region_of(run.given_labels), of_made = region_of(run.made_labels);
  const ModelColumns model(run.given.rows, run.made.rows);
  const io::PlyColumn floater = run.made.rows.column("ngs_floater");
  std::vector<Counts> counts(object_id.size());
  for (std::size_t row = 0; row < rows; ++row) {
    const bool same_model = model.same(std::int64_t(row));
    for (std::size_t k = 0; k < counts.size(); ++k) {
      Counts& c = counts[k];
      const bool own = ids[row] == object_id[k], others = !own && ids[row] != 0;
      if (label_is_foreground(run.made_labels[k].label[row])) ++(own ? c.own : others ? c.others : c.nobodys);
      c.removed += others && floater && floater.value_float(std::int64_t(row)) != 0;
      if (own || (same_model && run.same_labels(k, row))) continue;
      c.changed += others, c.beyond_given += !of_given[row], c.beyond += !of_given[row] && !of_made[row];
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
    for (const std::int64_t n : {c.own, c.others, c.nobodys, c.removed, c.changed, c.beyond_given, c.beyond})
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

#include "ngs/methods/apart.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "ngs/core/error.h"

namespace ngs {
namespace {

bool owns(const LabelColumns& object, std::size_t row) {
  return object.boundary[row] >= 0.5f || object.prob[row] > 0.5f;
}

/// f(column, floats per row) for every column of a cloud.
template <class F>
void for_each_column(int rest_count, const F& f) {
  f(&GaussianCloud::position, 3), f(&GaussianCloud::rotation, 4), f(&GaussianCloud::log_scale, 3);
  f(&GaussianCloud::logit_opacity, 1), f(&GaussianCloud::sh_dc, 3), f(&GaussianCloud::sh_rest, rest_count * 3);
}

bool same_bits(const GaussianCloud& a, std::int64_t i, const GaussianCloud& b, std::int64_t j) {
  bool same = true;
  for_each_column(a.rest_count(), [&](std::vector<float> GaussianCloud::*column, std::int64_t width) {
    same = same && std::equal((a.*column).begin() + i * width, (a.*column).begin() + (i + 1) * width,
                              (b.*column).begin() + j * width,
                              [](float x, float y) { return std::memcmp(&x, &y, sizeof x) == 0; });
  });
  return same;
}

void append_row(const GaussianCloud& from, std::int64_t row, GaussianCloud& to) {
  for_each_column(from.rest_count(), [&](std::vector<float> GaussianCloud::*column, std::int64_t width) {
    (to.*column).insert((to.*column).end(), (from.*column).begin() + row * width,
                        (from.*column).begin() + (row + 1) * width);
  });
  to.usable.push_back(from.usable[std::size_t(row)]);
}

constexpr std::int64_t kNone = -1, kSeveral = -2;
using Descendants = std::vector<std::vector<std::int64_t>>;  // [parts][model rows]

/// [model rows] the part's row that descends from each, kSeveral where there are more.
std::vector<std::int64_t> descendants(std::int64_t model_rows, const ModelPart& part) {
  std::vector<std::int64_t> found(std::size_t(model_rows), kNone);
  for (std::size_t r = 0; r < part.source_row->size(); ++r) {
    const std::int64_t source = (*part.source_row)[r];
    if (source < 0 || source >= model_rows)
      throw Error(ErrorCode::kBadInput, part.name + ": row " + std::to_string(r) + " descends from row " +
                                            std::to_string(source) + ", expected one of the model's " +
                                            std::to_string(model_rows));
    std::int64_t& at = found[std::size_t(source)];
    at = at == kNone ? std::int64_t(r) : kSeveral;
  }
  const auto lost = std::find(found.begin(), found.end(), kNone);
  if (lost != found.end())
    throw Error(ErrorCode::kBadInput, part.name + ": no row descends from row " +
                                          std::to_string(lost - found.begin()) +
                                          " of the model, expected one for each",
                "join what ngs-joint --apart wrote, before other tools take rows out");
  return found;
}

void check_parts(const GaussianCloud& model, std::size_t objects, const std::vector<ModelPart>& parts) {
  std::vector<const ModelPart*> holder(objects, nullptr);
  for (const ModelPart& part : parts) {
    if (part.cloud->sh_degree != model.sh_degree)
      throw Error(ErrorCode::kInconsistent, part.name + ": SH degree " + std::to_string(part.cloud->sh_degree) +
                                                ", expected the model's, " + std::to_string(model.sh_degree));
    for (const std::size_t object : part.objects) {
      if (holder[object] != nullptr)
        throw Error(ErrorCode::kInconsistent,
                    holder[object]->name + " and " + part.name + " hold the same object, expected each in one part");
      holder[object] = &part;
    }
  }
}

/// Which part changed each Gaussian, kNone: no one.
std::vector<std::int64_t> owners(const GaussianCloud& model, const std::vector<ModelPart>& parts,
                                 const Descendants& row_in) {
  std::vector<std::int64_t> owner(std::size_t(model.size()), kNone);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    std::int64_t twice = 0, other = kNone;
    for (std::size_t i = 0; i < owner.size(); ++i) {
      const std::int64_t row = row_in[p][i];
      if (row != kSeveral && same_bits(model, std::int64_t(i), *parts[p].cloud, row)) continue;
      if (owner[i] != kNone) ++twice, other = owner[i];
      owner[i] = std::int64_t(p);
    }
    if (twice > 0)
      throw Error(ErrorCode::kInconsistent,
                  parts[std::size_t(other)].name + " and " + parts[p].name + ": both changed " +
                      std::to_string(twice) + " Gaussians of the model, expected none",
                  "run their objects together, or every part with --apart and --effect floaters=off");
  }
  return owner;
}

/// Where a Gaussian of the joined model comes from.
struct Row {
  std::int64_t part, row, source;  // part kNone: the model's own row
};

/// The model's rows in order but for those that became several, then these, part by part.
std::vector<Row> joined_rows(const std::vector<ModelPart>& parts, const Descendants& row_in,
                             const std::vector<std::int64_t>& owner) {
  std::vector<Row> rows;
  for (std::size_t i = 0; i < owner.size(); ++i) {
    const auto source = std::int64_t(i);
    const std::int64_t row = owner[i] == kNone ? source : row_in[std::size_t(owner[i])][i];
    if (row != kSeveral) rows.push_back({owner[i], row, source});
  }
  for (std::size_t p = 0; p < parts.size(); ++p)
    for (std::size_t r = 0; r < parts[p].source_row->size(); ++r)
      if (const std::int64_t source = (*parts[p].source_row)[r]; row_in[p][std::size_t(source)] == kSeveral)
        rows.push_back({std::int64_t(p), std::int64_t(r), source});
  return rows;
}

/// Object k's columns, from the part that holds it; `given` are the model's.
LabelColumns joined_labels(std::size_t k, const LabelColumns& given, const std::vector<ModelPart>& parts,
                           const Descendants& row_in, const std::vector<Row>& rows) {
  const LabelColumns* from = &given;
  std::int64_t holder = kNone;
  for (std::size_t p = 0; p < parts.size(); ++p)
    for (std::size_t o = 0; o < parts[p].objects.size(); ++o)
      if (parts[p].objects[o] == k) from = &parts[p].labels[o], holder = std::int64_t(p);
  LabelColumns out;
  for (const auto column : {&LabelColumns::label, &LabelColumns::prob, &LabelColumns::variance,
                            &LabelColumns::views, &LabelColumns::boundary})
    for (const Row& row : rows) {
      const std::int64_t at = holder == kNone       ? row.source
                              : holder == row.part ? row.row
                                                   : row_in[std::size_t(holder)][std::size_t(row.source)];
      (out.*column).push_back((from->*column)[std::size_t(at)]);
    }
  return out;
}

}  // namespace

std::vector<std::vector<std::size_t>> objects_that_meet(const std::vector<LabelColumns>& objects) {
  std::vector<std::size_t> group(objects.size());  // the lowest object of each one's group
  std::iota(group.begin(), group.end(), std::size_t(0));
  const std::size_t rows = objects.empty() ? 0 : objects[0].prob.size();
  for (std::size_t i = 0; i < rows; ++i) {
    std::size_t first = objects.size();
    for (std::size_t k = 0; k < objects.size(); ++k) {
      if (!owns(objects[k], i)) continue;
      if (first == objects.size()) first = k;
      const auto [low, high] = std::minmax(group[first], group[k]);
      if (low != high) std::replace(group.begin(), group.end(), std::size_t(high), std::size_t(low));
    }
  }
  std::vector<std::vector<std::size_t>> groups(objects.size());
  for (std::size_t k = 0; k < objects.size(); ++k) groups[group[k]].push_back(k);
  std::erase_if(groups, [](const std::vector<std::size_t>& g) { return g.empty(); });
  return groups;
}

std::vector<std::uint8_t> held_rows(const std::vector<LabelColumns>& objects, const std::vector<std::size_t>& run) {
  std::vector<std::uint8_t> held(objects.empty() ? 0 : objects[0].prob.size(), 1);
  for (std::size_t i = 0; i < held.size(); ++i) {
    bool own = false, of_run = false, of_others = false;
    for (std::size_t k = 0; k < objects.size(); ++k) {
      const bool in_run = std::find(run.begin(), run.end(), k) != run.end();
      own |= in_run && owns(objects[k], i);
      (in_run ? of_run : of_others) |= objects[k].prob[i] > kLeastForegroundShare || owns(objects[k], i);
    }
    held[i] = !own && (!of_run || of_others);
  }
  return held;
}

Solution join_parts(const GaussianCloud& model, const std::vector<LabelColumns>& labels,
                        std::vector<ModelPart> parts) {
  check_parts(model, labels.size(), parts);
  std::stable_sort(parts.begin(), parts.end(), [](const ModelPart& a, const ModelPart& b) {
    return std::lexicographical_compare(a.objects.begin(), a.objects.end(), b.objects.begin(), b.objects.end());
  });
  Descendants row_in;
  for (const ModelPart& part : parts) row_in.push_back(descendants(model.size(), part));
  const std::vector<std::int64_t> owner = owners(model, parts, row_in);
  const std::vector<Row> rows = joined_rows(parts, row_in, owner);

  Solution result;
  result.cloud.origin = model.origin, result.cloud.antialiased = model.antialiased;
  result.cloud.sh_degree = model.sh_degree;
  for (const Row& row : rows) {
    append_row(row.part == kNone ? model : *parts[std::size_t(row.part)].cloud, row.row, result.cloud);
    if (rows.size() > owner.size()) result.source_row.push_back(row.source);
  }
  for (std::size_t k = 0; k < labels.size(); ++k)
    result.labels.push_back(joined_labels(k, labels[k], parts, row_in, rows));
  result.figures["changed"] = double(owner.size()) - double(std::count(owner.begin(), owner.end(), kNone));
  result.figures["added"] = double(rows.size()) - double(owner.size());
  return result;
}

}  // namespace ngs

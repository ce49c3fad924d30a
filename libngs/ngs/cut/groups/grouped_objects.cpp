#include "ngs/cut/groups/grouped_objects.h"

#include <algorithm>
#include <numeric>

#include "ngs/backend/for_each.h"

namespace ngs {
namespace {

constexpr std::int32_t kNoObject = -2;  // a vote for no object

/// The group with most votes, MaskGroups::kDropped if there is none. Sorts the votes.
std::int32_t most_frequent(std::vector<std::int32_t>& votes) {
  std::sort(votes.begin(), votes.end());
  std::int32_t winner = MaskGroups::kDropped;
  std::ptrdiff_t most = 0;
  for (auto at = votes.begin(); at != votes.end();) {
    const auto next = std::upper_bound(at, votes.end(), *at);
    if (next - at > most) {
      most = next - at;
      winner = std::max(*at, MaskGroups::kDropped);
    }
    at = next;
  }
  return winner;
}

/// The group that most views show each Gaussian in, or MaskGroups::kDropped. Groups of too few views do not vote.
std::vector<std::int32_t> vote(const Exec& exec, int min_views, std::size_t gaussians,
                               const std::vector<ViewGaussians>& views, const MaskGroups& groups) {
  std::vector<std::int32_t> winner(gaussians, MaskGroups::kDropped);
  constexpr std::size_t kChunk = 1 << 14;
  for_each_task(exec, std::int64_t((gaussians + kChunk - 1) / kChunk), [&](std::int64_t chunk) {
    const std::size_t begin = std::size_t(chunk) * kChunk, end = std::min(begin + kChunk, gaussians);
    std::vector<std::vector<std::int32_t>> votes(end - begin);
    for (std::size_t v = 0; v < views.size(); ++v) {
      const std::vector<MaskedGaussian>& seen = views[v].seen;
      auto at = std::ranges::lower_bound(seen, std::uint32_t(begin), {}, &MaskedGaussian::gaussian);
      for (; at != seen.end() && at->gaussian < end; ++at) {
        const std::int32_t group = at->mask == 0 ? kNoObject : groups.group[v][at->mask - 1];
        if (group == kNoObject || (group >= 0 && groups.views[std::size_t(group)] >= min_views))
          votes[at->gaussian - begin].push_back(group);
      }
    }
    for (std::size_t i = 0; i < votes.size(); ++i) winner[begin + i] = most_frequent(votes[i]);
  });
  return winner;
}

/// Numbers the groups by their Gaussians, most first.
void number_objects(const std::vector<std::int32_t>& group, std::size_t groups, GroupedObjects& out) {
  std::vector<std::int64_t> count(groups);
  for (const std::int32_t g : group)
    if (g >= 0) ++count[std::size_t(g)];
  std::vector<std::uint32_t> order(groups), number(groups);
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, [&](std::uint32_t a, std::uint32_t b) { return count[a] > count[b]; });
  for (const std::uint32_t g : order) {
    if (count[g] == 0) break;
    out.objects.push_back({count[g], {}, 0, 0, 0});
    number[g] = std::uint32_t(out.objects.size());
  }
  out.object.clear();
  for (const std::int32_t g : group) out.object.push_back(g >= 0 ? number[std::size_t(g)] : 0);
}

/// The weight of each object in each mask of a view, [objects + 1, masks + 1].
std::vector<double> weights_in(const ViewGaussians& view, const std::vector<std::uint32_t>& object,
                               std::size_t objects) {
  const std::size_t columns = std::size_t(view.masks) + 1;
  std::vector<double> weight((objects + 1) * columns);
  for (const MaskedGaussian& of : view.seen) weight[object[of.gaussian] * columns + of.mask] += double(of.weight);
  return weight;
}

/// How a view shows an object.
struct Shown {
  double weight = 0;            // of the object, px
  bool is_pure = false;         // in one mask, with little else
  std::uint32_t inside_of = 0;  // the larger object in the same mask; 0: none
};

std::vector<Shown> shown_in(const ViewGaussians& view, const GroupedObjects& objects) {
  const std::size_t count = objects.objects.size(), columns = std::size_t(view.masks) + 1;
  const std::vector<double> weight = weights_in(view, objects.object, count);
  const std::vector<MaskContent> content = mask_contents(view, objects);
  std::vector<double> of_mask(columns);
  for (std::size_t k = 0; k <= count; ++k)
    for (std::size_t m = 0; m < columns; ++m) of_mask[m] += weight[k * columns + m];
  std::vector<Shown> shown(count);
  for (std::size_t k = 1; k <= count; ++k) {
    const double* row = &weight[k * columns];
    Shown& of = shown[k - 1];
    of.weight = std::accumulate(row, row + columns, 0.0);
    const auto most = std::size_t(std::max_element(row, row + columns) - row);
    if (most == 0 || row[most] < kMinPurity * of.weight) continue;
    of.is_pure = row[most] >= kMinPurity * of_mask[most];
    if (content[most].object != k) of.inside_of = content[most].object;
  }
  return shown;
}

void measure_confidence(const Exec& exec, const std::vector<ViewGaussians>& views, GroupedObjects& objects) {
  std::vector<std::vector<Shown>> shown(views.size());
  for_each_task(exec, std::ssize(views),
                [&](std::int64_t v) { shown[std::size_t(v)] = shown_in(views[std::size_t(v)], objects); });
  constexpr double kSeen = 0.1, kPart = 0.2;
  for (std::size_t k = 0; k < objects.objects.size(); ++k) {
    GroupedObject& object = objects.objects[k];
    double most = 0;
    for (const auto& view : shown) most = std::max(most, view[k].weight);
    std::vector<std::uint32_t> inside;
    double pure = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (shown[v][k].weight <= 0 || shown[v][k].weight < kSeen * most) continue;
      object.views.push_back(v);
      pure += shown[v][k].is_pure;
      if (shown[v][k].inside_of != 0) inside.push_back(shown[v][k].inside_of);
    }
    const double count = double(std::max<std::size_t>(object.views.size(), 1));
    object.confidence = pure / count;
    std::ranges::sort(inside);
    for (auto at = inside.begin(); at != inside.end();) {
      const auto next = std::upper_bound(at, inside.end(), *at);
      const double share = double(next - at) / count;
      if (share >= kPart && share > object.part_share) {
        object.part_share = share;
        object.part_of = *at;
      }
      at = next;
    }
  }
}

/// Moves objects that are too small or too uncertain to the end.
void separate_doubtful(const ObjectOptions& options, GroupedObjects& out) {
  const auto is_sure = [&](const GroupedObject& object) {
    return object.gaussians >= options.min_gaussians && std::ssize(object.views) >= options.min_views &&
           object.confidence >= options.min_confidence;
  };
  std::vector<std::uint32_t> order(out.objects.size()), number(out.objects.size() + 1);
  std::iota(order.begin(), order.end(), 0u);
  const auto doubtful =
      std::stable_partition(order.begin(), order.end(), [&](std::uint32_t k) { return is_sure(out.objects[k]); });
  out.sure = std::size_t(doubtful - order.begin());
  std::vector<GroupedObject> ordered;
  for (const std::uint32_t k : order) {
    ordered.push_back(std::move(out.objects[k]));
    number[k + 1] = std::uint32_t(ordered.size());
  }
  for (GroupedObject& object : ordered) object.part_of = number[object.part_of];
  out.objects = std::move(ordered);
  for (std::uint32_t& k : out.object) k = number[k];
}

}  // namespace

std::vector<MaskContent> mask_contents(const ViewGaussians& view, const GroupedObjects& objects) {
  const std::size_t count = objects.objects.size(), columns = std::size_t(view.masks) + 1;
  const std::vector<double> weight = weights_in(view, objects.object, count);
  std::vector<MaskContent> content(columns);
  for (std::size_t m = 0; m < columns; ++m) {
    double all = 0, most = 0;
    for (std::size_t k = 0; k <= count; ++k) {
      const double w = weight[k * columns + m];
      all += w;
      if (w <= most) continue;
      most = w;
      content[m].object = std::uint32_t(k);
    }
    content[m].is_known = all > 0;
    if (all > 0) content[m].share = most / all;
  }
  return content;
}

GroupedObjects objects_of_groups(const Exec& exec, const ObjectOptions& options, std::size_t gaussians,
                                 const std::vector<ViewGaussians>& views, const MaskGroups& groups) {
  GroupedObjects out;
  number_objects(vote(exec, options.min_views, gaussians, views, groups), groups.groups(), out);
  measure_confidence(exec, views, out);
  separate_doubtful(options, out);
  return out;
}

}  // namespace ngs

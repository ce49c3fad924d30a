#include "ngs/cut/groups/mask_groups.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "ngs/backend/for_each.h"
#include "ngs/math/union_find.h"

namespace ngs {
namespace {

/// The container of a mask in another view: the number of a mask there (1 .. masks), or one of these values.
constexpr std::int32_t kUnseen = -1, kSplit = -2, kOutside = 0;

/// One row per mask, or per group of masks.
using Containers = std::vector<std::vector<std::int32_t>>;  // [rows][views]

/// Calls f(a, b) for the Gaussians of both lists.
template <class F>
void for_common(const std::vector<MaskedGaussian>& a, const std::vector<MaskedGaussian>& b, const F& f) {
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    if (a[i].gaussian == b[j].gaussian) f(a[i], b[j]);
    const bool step_a = a[i].gaussian <= b[j].gaussian, step_b = b[j].gaussian <= a[i].gaussian;
    i += step_a;
    j += step_b;
  }
}

/// The container in views[u] of a mask of weight `all`; `inside` [masks of u + 1]: its weight in each mask of u.
std::int32_t container_in(const GroupOptions& options, double all, const double* inside, std::size_t masks) {
  double seen = 0;
  std::size_t most = 0;
  for (std::size_t n = 0; n <= masks; ++n) {
    seen += inside[n];
    if (inside[n] > inside[most]) most = n;
  }
  if (!(seen > 0) || seen < options.visible * all) return kUnseen;
  return inside[most] >= options.contained * seen ? std::int32_t(most) : kSplit;
}

/// The containers of the masks of view v, as consecutive rows from `row`.
void find_containers(const GroupOptions& options, const std::vector<ViewGaussians>& views, std::size_t v,
                     std::vector<std::int32_t>* row) {
  const auto masks = std::size_t(views[v].masks);
  std::vector<double> all(masks + 1), inside;
  for (const MaskedGaussian& of : views[v].seen) all[of.mask] += double(of.weight);
  for (std::size_t m = 0; m < masks; ++m) row[m].assign(views.size(), kUnseen);
  for (std::size_t u = 0; u < views.size(); ++u) {
    const auto others = std::size_t(views[u].masks);
    inside.assign((masks + 1) * (others + 1), 0.0);
    if (u != v)
      for_common(views[v].seen, views[u].seen, [&](const MaskedGaussian& mine, const MaskedGaussian& other) {
        inside[mine.mask * (others + 1) + other.mask] += double(mine.weight);
      });
    for (std::size_t m = 1; m <= masks; ++m)
      row[m - 1][u] = u == v ? std::int32_t(m) : container_in(options, all[m], &inside[m * (others + 1)], others);
  }
}

/// Masks that cover several objects.
std::vector<std::uint8_t> split_by_others(const Containers& masks, double share) {
  std::vector<std::uint8_t> dropped(masks.size());
  for (std::size_t m = 0; m < masks.size(); ++m) {
    const auto splits = std::ranges::count(masks[m], kSplit);
    const auto contains = std::ranges::count_if(masks[m], [](std::int32_t n) { return n > kOutside; }) - 1;
    dropped[m] = double(splits) > share * double(splits + contains);
  }
  return dropped;
}

/// The masks or groups that are not dropped, with their containers.
class Nodes {
 public:
  /// `first` [views]: row of a view's first mask.
  Nodes(Containers containers, const std::vector<std::size_t>& first, std::size_t masks)
      : container_(std::move(containers)), first_(first), inside_(masks) {
    const std::size_t words = (first.size() + 63) / 64;
    observed_.assign(size() * words, 0);
    for (std::size_t a = 0; a < size(); ++a)
      for (std::size_t u = 0; u < first.size(); ++u) {
        if (container_[a][u] <= kOutside) continue;
        inside_[row_of(u, container_[a][u])].push_back(std::uint32_t(a));
        observed_[a * words + u / 64] |= std::uint64_t(1) << u % 64;
      }
  }
  std::size_t size() const { return container_.size(); }
  const std::vector<std::int32_t>& containers(std::size_t a) const { return container_[a]; }

  /// Calls f(b, views with the same container, views with containers of both) for nodes b > a with a common container.
  /// `scratch` [nodes] is 0 before and after.
  template <class F>
  void for_partners(std::size_t a, std::vector<std::uint32_t>& scratch, const F& f) const {
    std::vector<std::uint32_t> partners;
    for (std::size_t u = 0; u < first_.size(); ++u) {
      if (container_[a][u] <= kOutside) continue;
      const std::vector<std::uint32_t>& same = inside_[row_of(u, container_[a][u])];
      for (auto b = std::upper_bound(same.begin(), same.end(), std::uint32_t(a)); b != same.end(); ++b)
        if (scratch[*b]++ == 0) partners.push_back(*b);
    }
    const std::size_t words = (first_.size() + 63) / 64;
    for (const std::uint32_t b : partners) {
      int both = 0;
      for (std::size_t w = 0; w < words; ++w)
        both += std::popcount(observed_[a * words + w] & observed_[b * words + w]);
      f(b, int(scratch[b]), both);
      scratch[b] = 0;
    }
  }

 private:
  std::size_t row_of(std::size_t view, std::int32_t mask) const { return first_[view] + std::size_t(mask) - 1; }

  Containers container_;
  const std::vector<std::size_t>& first_;
  std::vector<std::vector<std::uint32_t>> inside_;  // [masks] nodes that it contains, ascending
  std::vector<std::uint64_t> observed_;             // [nodes, words] bit u: view u has a container
};

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// Pairs with consensus that at least `least` views observe.
std::vector<Edge> edges_of(const Exec& exec, const Nodes& nodes, double consensus, int least) {
  constexpr std::size_t kChunk = 64;
  std::vector<std::vector<Edge>> part((nodes.size() + kChunk - 1) / kChunk);
  for_each_task(exec, std::ssize(part), [&](std::int64_t p) {
    std::vector<std::uint32_t> scratch(nodes.size());
    const std::size_t begin = std::size_t(p) * kChunk, end = std::min(begin + kChunk, nodes.size());
    for (std::size_t a = begin; a < end; ++a)
      nodes.for_partners(a, scratch, [&](std::uint32_t b, int same, int both) {
        if (both >= least && same >= consensus * both) part[std::size_t(p)].push_back({std::uint32_t(a), b});
      });
  });
  std::vector<Edge> edges;
  for (const auto& some : part) edges.insert(edges.end(), some.begin(), some.end());
  return edges;
}

/// Minimum numbers of observers, one per round: the percentiles 95, 90, ... over all pairs with a common container,
/// without repetitions, then `least`.
std::vector<int> rounds_of(const Exec& exec, const Nodes& nodes, int views, int least) {
  std::vector<std::vector<std::int64_t>> part(std::size_t(exec.threads) * 4, std::vector<std::int64_t>(views + 1));
  for_each_task(exec, std::ssize(part), [&](std::int64_t p) {
    std::vector<std::uint32_t> scratch(nodes.size());
    for (auto a = std::size_t(p); a < nodes.size(); a += part.size())
      nodes.for_partners(a, scratch, [&](std::uint32_t, int, int both) { ++part[std::size_t(p)][std::size_t(both)]; });
  });
  std::vector<std::int64_t> count(std::size_t(views) + 1);
  for (const auto& some : part)
    for (std::size_t n = 0; n < count.size(); ++n) count[n] += some[n];
  const auto total = double(std::accumulate(count.begin(), count.end(), std::int64_t(0)));
  std::vector<int> rounds;
  for (int percentile = 95; percentile > 0; percentile -= 5) {
    std::int64_t below = 0;
    int observers = 0;
    while (observers < views && double(below += count[std::size_t(observers)]) < percentile / 100.0 * total)
      ++observers;
    if (observers > least && (rounds.empty() || observers < rounds.back())) rounds.push_back(observers);
  }
  rounds.push_back(least);
  return rounds;
}

/// The container of a group in each view: the one that most of its members have there, of equal ones the first.
Containers joined(const Containers& masks, const std::vector<std::uint32_t>& group, std::size_t groups) {
  std::vector<std::vector<std::uint32_t>> members(groups);
  for (std::size_t m = 0; m < masks.size(); ++m) members[group[m]].push_back(std::uint32_t(m));
  Containers out(groups);
  std::vector<std::int32_t> found;
  for (std::size_t g = 0; g < groups; ++g)
    for (std::size_t u = 0; u < masks[0].size(); ++u) {
      found.clear();
      for (const std::uint32_t m : members[g])
        if (masks[m][u] > kOutside) found.push_back(masks[m][u]);
      std::ranges::sort(found);
      std::int32_t best = kUnseen;
      std::ptrdiff_t most = 0;
      for (auto at = found.begin(); at != found.end();) {
        const auto end = std::upper_bound(at, found.end(), *at);
        if (end - at > most) {
          best = *at;
          most = end - at;
        }
        at = end;
      }
      out[g].push_back(best);
    }
  return out;
}

}  // namespace

MaskGroups same_numbers(const std::vector<NumberedMasks>& views) {
  MaskGroups out;
  for (const NumberedMasks& view : views) {
    const auto masks = std::size_t(view.masks);
    out.views.resize(std::max(out.views.size(), masks));
    std::vector<std::uint8_t> shown(masks + 1);
    for (const std::uint16_t number : view.number.data)
      if (number <= masks) shown[number] = 1;
    out.group.emplace_back(masks);
    std::iota(out.group.back().begin(), out.group.back().end(), 0);
    for (std::size_t m = 0; m < masks; ++m) out.views[m] += shown[m + 1];
  }
  return out;
}

MaskGroups group_masks(const Exec& exec, const GroupOptions& options, const std::vector<ViewGaussians>& views) {
  std::vector<std::size_t> first;
  std::size_t masks = 0;
  for (const ViewGaussians& view : views) {
    first.push_back(masks);
    masks += std::size_t(view.masks);
  }
  Containers containers(masks);
  for_each_task(exec, std::ssize(views), [&](std::int64_t v) {
    find_containers(options, views, std::size_t(v), containers.data() + first[std::size_t(v)]);
  });
  const std::vector<std::uint8_t> dropped = split_by_others(containers, options.split);
  std::vector<std::uint32_t> kept;  // masks
  Containers of_kept;
  for (std::size_t m = 0; m < masks; ++m) {
    for (std::size_t u = 0; u < views.size(); ++u)
      if (std::int32_t& n = containers[m][u]; n > kOutside && dropped[first[u] + std::size_t(n) - 1]) n = kUnseen;
    if (dropped[m]) continue;
    kept.push_back(std::uint32_t(m));
    of_kept.push_back(std::move(containers[m]));
  }
  std::vector<std::uint32_t> group(kept.size());
  std::iota(group.begin(), group.end(), 0u);
  std::size_t groups = kept.size();
  std::vector<int> rounds;
  for (std::size_t round = 0; !kept.empty() && (round == 0 || round < rounds.size()); ++round) {
    const Nodes nodes(joined(of_kept, group, groups), first, masks);
    if (round == 0) rounds = rounds_of(exec, nodes, int(views.size()), options.min_observers);
    UnionFind sets(groups);
    for (const auto& [a, b] : edges_of(exec, nodes, options.consensus, rounds[round])) sets.join(a, b);
    std::vector<std::uint32_t> number(groups);
    std::size_t next = 0;
    for (std::size_t g = 0; g < groups; ++g) number[g] = sets.root(std::uint32_t(g)) == g ? std::uint32_t(next++) : 0;
    for (std::uint32_t& g : group) g = number[sets.root(g)];
    groups = next;
  }
  MaskGroups out;
  out.views.assign(groups, 0);
  std::vector<std::int32_t> of_mask(masks, MaskGroups::kDropped);
  for (std::size_t k = 0; k < kept.size(); ++k) of_mask[kept[k]] = std::int32_t(group[k]);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto begin = of_mask.begin() + std::ptrdiff_t(first[v]);
    out.group.emplace_back(begin, begin + views[v].masks);
    std::vector<std::int32_t> here = out.group.back();
    std::ranges::sort(here);
    here.erase(std::unique(here.begin(), here.end()), here.end());
    for (const std::int32_t g : here)
      if (g != MaskGroups::kDropped) ++out.views[std::size_t(g)];
  }
  return out;
}

}  // namespace ngs

#include "ngs/passes/joint/joint_effects.h"

#include <algorithm>

#include "ngs/ops/image/mask_pair.h"
#include "ngs/passes/scene_probe.h"
#include "ngs/problem/scene_measures.h"
#include "ngs/problem/view_list.h"
#include "ngs/stages/optimise/joint_field.h"

namespace ngs {
namespace {

constexpr std::string_view kHalfLevel = "half a level of an 8-bit photo, which none can show";

double gap_without_photos(SceneProbe& probe) {
  return probe.boundary().size() == 0 ? 0 : 1 - probe.label_sample().biou;
}

bool has_no_photo(const Problem& problem) { return photo_count(problem.scene, problem.views) == 0; }

double largest_neighbour_difference(SceneProbe& probe) {
  return neighbour_most_levels(probe.boundary_neighbours(), probe.boundary_colours());
}

double finest_cell(SceneProbe& probe) {
  if (probe.boundary().size() < 2) return 0;
  const TrainingOptions& o = probe.training();
  const Problem& p = probe.problem();
  const double reach = field_reach(o.sample, p.cloud, cameras_of(p.scene, p.views), probe.boundary());
  const double width = rbf_width(probe.exec(), o.rbf, probe.boundary().positions());
  return encoding_cells(probe.exec(), reach, width, probe.boundary().positions(), o.joint.hash_finest);
}

double patch_deviation(SceneProbe& probe) {
  double most = 0;
  for_each_view(probe.problem().monitor, probe.some_views(), [&](std::size_t, std::size_t v) {
    const ViewMasks masks = probe.problem().load_masks(v);
    const ImageF photo = probe.problem().load_photo(v);
    if (!masks.available || photo.empty()) return;
    for (const std::vector<float>& target : masks.target) {
      const std::vector<std::uint8_t> plane = object_pixels(target);
      most = std::max(most, contour_deviation_levels(photo, {plane.data(), masks.width_px, masks.height_px}));
    }
  });
  return most;
}

struct JointPart {
  bool JointSwitches::*member;
  Effect effect;
};

using Switch = JointSwitches;

const JointPart kParts[] = {
    {&Switch::nerf,
     {.name = "nerf",
      .help = "the NeRF and all that needs it",
      .saves = "rays, field, network, L_align, L_smth",
      .needs = "joint",
      .detector = {"without photos: 1 - boundary IoU of the labels as they come with the masks", 0.02,
                   "two points, what masks of one object differ by from tool to tool", gap_without_photos, has_no_photo,
                   "there are photos, beside which it gained nothing"}}},
    {&Switch::boundary,
     {.name = "boundary",
      .help = "boundary set; off: every seen Gaussian",
      .always = "the set is what all else works on; without it there is more to do, not less"}},
    {&Switch::box,
     {.name = "box",
      .help = "box of the boundary; off: the whole image",
      .always = "without it there is more to do, not less"}},
    {&Switch::rbf,
     {.name = "rbf",
      .help = "RBF interpolation; off: nearest feature",
      .saves = "all neighbours of a query but the nearest",
      .needs = "nerf",
      .detector = {"largest colour difference between neighbours, levels", 0.5, kHalfLevel,
                   largest_neighbour_difference}}},
    {&Switch::hash,
     {.name = "hash",
      .help = "hash levels; off: one coarse level",
      .saves = "all levels but one",
      .needs = "nerf",
      .always = "one level costs the network as much"}},
    {&Switch::fine_hash,
     {.name = "fine-hash",
      .help = "hash levels finer than the boundary; off: not",
      .saves = "levels whose cells are below half the boundary's spacing",
      .needs = "nerf",
      .detector = {"side of the finest cell, in spacings of the boundary", kFinestCell,
                   "two cells to a spacing: no finer detail has support", finest_cell}}},
    {&Switch::film,
     {.name = "film",
      .help = "condition on f_inter; off: none",
      .needs = "nerf",
      .always = "without it the same network runs"}},
    {&Switch::align,
     {.name = "align",
      .help = "L_align: colour and opacity",
      .saves = "L_align and its gradients",
      .needs = "nerf",
      .always = "it is what the field is trained by"}},
    {&Switch::variance,
     {.name = "variance",
      .help = "L_align: 7x7 variance",
      .saves = "the patch pass",
      .needs = "align",
      .detector = {"standard deviation of 7x7 patches at the masks' contours, levels", 0.5, kHalfLevel,
                   patch_deviation}}},
    {&Switch::density,
     {.name = "density", .help = "density weights of L_mask", .needs = "nerf", .always = "a by-product of the field"}},
    {&Switch::mask, {.name = "mask", .help = "L_mask", .always = "what the labels are trained by"}},
    {&Switch::cont,
     {.name = "cont",
      .help = "L_cont",
      .saves = "its pass over the neighbours",
      .needs = "joint",
      .detector = {"RMS colour difference of neighbours on the boundary, levels", 0.5, kHalfLevel,
                   [](SceneProbe& probe) {
                     return neighbour_rms_levels(probe.boundary_neighbours(), probe.boundary_colours());
                   }}}},
    {&Switch::smooth,
     {.name = "smooth",
      .help = "L_smth",
      .saves = "two more evaluations of the field",
      .needs = "nerf",
      .detector = {"range of the boundary's colours, levels", 0.5, kHalfLevel,
                   [](SceneProbe& probe) { return colour_range_levels(probe.boundary_colours()); }}}},
    {&Switch::photometric,
     {.name = "photometric",
      .help = "anchor to the photos",
      .saves = "compositing colour, SSIM",
      .detector = {"views that have a photo", 0, "one is enough", [](SceneProbe& probe) { return probe.photos(); }}}},
    {&Switch::region,
     {.name = "region",
      .help = "anchor to all of a photo; off: about the object",
      .saves = "SSIM away from the object",
      .needs = "joint",
      .detector = {"share of the labels' weight outside of the windows", 1e-3,
                   "a thousandth: nothing there is moved by a mask",
                   [](SceneProbe& probe) { return probe.label_sample().outside; }}}},
    {&Switch::sh,
     {.name = "sh",
      .help = "view-dependent colour",
      .saves = "SH bands, their gradients and steps",
      .detector = {"strongest view-dependent colour, levels", 0.5, kHalfLevel,
                   [](SceneProbe& probe) {
                     return view_dependence_levels(probe.problem().cloud, probe.some_cameras(),
                                                   probe.problem().splat.world_unit);
                   }}}},
    {&Switch::antialias,
     {.name = "antialias",
      .help = "the opacity compensation the model was trained with",
      .saves = "the compensation",
      .detector = {"most opacity that it takes, levels", 0.5, kHalfLevel,
                   [](SceneProbe& probe) {
                     return antialias_levels(probe.problem().cloud, probe.some_cameras(), probe.problem().splat);
                   }}}},
    {&Switch::geometry,
     {.name = "geometry",
      .help = "move the Gaussians",
      .always = "gradients that exist anyway; what they move is the result"}},
    {&Switch::mask_geometry,
     {.name = "mask-geometry", .help = "L_mask moves the Gaussians", .always = "gradients that exist anyway"}},
};

}  // namespace

std::vector<Effect> joint_effects() {
  std::vector<Effect> effects{
      {.name = "joint",
       .help = "the steps of Eq. 20; off: labels as they come",
       .saves = "all steps before the photos' edges are followed",
       .detector = {"agreement with the masks gained by refined contours, normal score (0: the photos show edges that "
                    "the model does not, or the masks err to one side)",
                    -kSignificant,
                    "the photos add no edge to the model, and refined contours agree less with the masks",
                    [](SceneProbe& probe) { return probe.edge_gain(); }}}};
  for (const JointPart& part : kParts) effects.push_back(part.effect);
  return effects;
}

JointSwitches joint_switches(const std::function<bool(std::string_view)>& on) {
  JointSwitches switches;
  for (const JointPart& part : kParts) switches.*part.member = on(part.effect.name);
  return switches;
}

}  // namespace ngs

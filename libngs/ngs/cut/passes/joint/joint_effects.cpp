#include "ngs/cut/passes/joint/joint_effects.h"

#include <algorithm>

#include "ngs/cut/passes/scene_probe.h"
#include "ngs/cut/training/joint_field.h"
#include "ngs/ops/image/mask_pair.h"
#include "ngs/problem/scene_measures.h"
#include "ngs/problem/view_list.h"

namespace ngs {
namespace {

constexpr std::string_view kHalfLevel = "half a level: an 8-bit photo cannot show less";

double gap_without_photos(SceneProbe& probe) {
  return probe.boundary().size() == 0 ? 0 : 1 - probe.label_sample().biou;
}

bool has_no_photo(const Problem& problem) { return photo_count(problem.scene, problem.views) == 0; }

double largest_neighbour_difference(SceneProbe& probe) {
  return neighbour_max_levels(probe.boundary_neighbours(), probe.boundary_colours());
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
  for_each_view(probe.problem().monitor, probe.sample_views(), [&](std::size_t, std::size_t v) {
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

using On = JointSwitches;

const JointPart kParts[] = {
    {&On::nerf,
     {.name = kNerfEffect,
      .help = "train a NeRF and the terms that need it",
      .saves = "rays, field, network, L_align, L_smth",
      .needs = kJointEffect,
      .heuristic = {"without photos: 1 - boundary IoU of the closed-form labels with the masks", 0.02,
                    "two points: masks of one object differ as much between tools", gap_without_photos, has_no_photo,
                    "there are photos; in addition to them the NeRF gained nothing"}}},
    {&On::boundary,
     {.name = "boundary",
      .help = "use the boundary set; off: every seen Gaussian",
      .always = "all other parts work on the set; off is more work, not less"}},
    {&On::box,
     {.name = "box",
      .help = "sample in the boundary's box; off: in the whole image",
      .always = "off is more work, not less"}},
    {&On::rbf,
     {.name = "rbf",
      .help = "interpolate features by RBF; off: nearest feature",
      .saves = "all neighbours of a query point except the nearest",
      .needs = kNerfEffect,
      .heuristic = {"largest colour difference between neighbours, levels", 0.5, kHalfLevel,
                    largest_neighbour_difference}}},
    {&On::hash,
     {.name = "hash",
      .help = "multi-level hash encoding; off: one coarse level",
      .saves = "all levels except one",
      .needs = kNerfEffect,
      .always = "with one level the network costs as much"}},
    {&On::fine_hash,
     {.name = "fine-hash",
      .help = "use hash levels finer than the boundary's spacing",
      .saves = "levels with cells below half the boundary's spacing",
      .needs = kNerfEffect,
      .heuristic = {"side of the finest cell, in spacings of the boundary", kFinestCell,
                    "two cells per spacing: finer detail has no support", finest_cell}}},
    {&On::film,
     {.name = "film",
      .help = "condition the network on f_inter",
      .needs = kNerfEffect,
      .always = "off runs the same network"}},
    {&On::align,
     {.name = "align",
      .help = "use the colour and opacity terms of L_align",
      .saves = "L_align and its gradients",
      .needs = kNerfEffect,
      .always = "the field is trained by it"}},
    {&On::variance,
     {.name = "variance",
      .help = "use the 7x7 variance term of L_align",
      .saves = "the pass over the patches",
      .needs = "align",
      .heuristic = {"standard deviation of 7x7 patches at the masks' contours, levels", 0.5, kHalfLevel,
                    patch_deviation}}},
    {&On::density,
     {.name = "density",
      .help = "weight L_mask by density",
      .needs = kNerfEffect,
      .always = "a by-product of the field"}},
    {&On::mask, {.name = "mask", .help = "use L_mask", .always = "the labels are trained by it"}},
    {&On::cont,
     {.name = "cont",
      .help = "use L_cont",
      .saves = "the pass over the neighbours",
      .needs = kJointEffect,
      .heuristic = {"RMS colour difference of neighbours on the boundary, levels", 0.5, kHalfLevel,
                    [](SceneProbe& probe) {
                      return neighbour_rms_levels(probe.boundary_neighbours(), probe.boundary_colours());
                    }}}},
    {&On::smooth,
     {.name = "smooth",
      .help = "use L_smth",
      .saves = "two more evaluations of the field",
      .needs = kNerfEffect,
      .heuristic = {"range of the boundary's colours, levels", 0.5, kHalfLevel,
                    [](SceneProbe& probe) { return colour_range_levels(probe.boundary_colours()); }}}},
    {&On::photometric,
     {.name = "photometric",
      .help = "anchor the colours to the photos",
      .saves = "compositing of colour, and SSIM",
      .heuristic = {"views that have a photo", 0, "one is enough",
                    [](SceneProbe& probe) { return probe.views_with_photo(); }}}},
    {&On::whole_photo,
     {.name = "whole-photo",
      .help = "anchor to the whole photo; off: near the object",
      .saves = "SSIM away from the object",
      .needs = kJointEffect,
      .heuristic = {"share of the labels' weight outside the windows", 1e-3, "a thousandth: masks move nothing there",
                    [](SceneProbe& probe) { return probe.label_sample().outside; }}}},
    {&On::sh,
     {.name = "sh",
      .help = "use view-dependent colour",
      .saves = "SH bands, their gradients and steps",
      .heuristic = {"strongest view-dependent colour, levels", 0.5, kHalfLevel,
                    [](SceneProbe& probe) {
                      return view_dependence_levels(probe.problem().cloud, probe.sample_cameras(),
                                                    probe.problem().splat.world_unit);
                    }}}},
    {&On::antialias,
     {.name = "antialias",
      .help = "use the opacity compensation of the model's training",
      .saves = "the compensation",
      .heuristic = {"largest opacity removed by the compensation, levels", 0.5, kHalfLevel,
                    [](SceneProbe& probe) {
                      return antialias_levels(probe.problem().cloud, probe.sample_cameras(), probe.problem().splat);
                    }}}},
    {&On::geometry,
     {.name = "geometry",
      .help = "move the Gaussians",
      .always = "the gradients exist anyway, and the moved Gaussians are the result"}},
    {&On::mask_geometry,
     {.name = "mask-geometry", .help = "let L_mask move the Gaussians", .always = "the gradients exist anyway"}},
};

}  // namespace

std::vector<Effect> joint_effects() {
  std::vector<Effect> effects{
      {.name = kJointEffect,
       .help = "optimise by Eq. 20; off: closed-form labels",
       .saves = "all steps before contour refinement",
       .heuristic = {"gain of agreement with the masks by contour refinement, normal score (0: the photos show edges "
                     "that the model does not, or the masks err to one side)",
                     -kSignificant, "below it the photos add no edge, and refined contours agree less with the masks",
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

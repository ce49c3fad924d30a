#include "ngs/passes/effects.h"

#include <algorithm>
#include <cstdio>

#include "ngs/core/error.h"
#include "ngs/passes/contours/refined_masks.h"
#include "ngs/passes/effect_probe.h"

namespace ngs {
namespace {

using Fx = JointEffects;
using Probe = EffectProbe;
constexpr auto kAbove = OnWhere::kAbove;
constexpr auto kBefore = EffectPhase::kBefore;
constexpr std::string_view kHalfLevel = "half a level of an 8-bit photo, which none can show";

constexpr EffectInfo kRegistry[] = {
    {"exposure", "take differences of exposure from the photos", &Fx::exposure, "a gain per view and channel", "", kAbove,
     "furthest exposure of a view from the others', percent", 2, "two and a half levels of mid-grey",
     &Probe::exposure, kBefore},
    {"mask-outliers", "ignore masks that the others contradict", &Fx::mask_outliers,
     "the consensus of the others, view by view", "", kAbove,
     "worst view's disagreement, in halves of what would ignore it", 1,
     "half the distance at which a view is ignored", &Probe::trust, kBefore},
    {"floaters", "take floaters before the object out", &Fx::floaters, "search, removal, refit", "", kAbove,
     "share of the object's surface hidden by what stands before it", 1e-3,
     "the search itself leaves alone what hides less (FloaterOptions::least_hidden)", &Probe::front, kBefore},
    {"components", "claim nothing that does not hang together with the object", &Fx::components, "linking what is labelled", "",
     kAbove, "Gaussians that masks claim apart from the object", 0, "one is enough: it may be large", &Probe::components,
     kBefore},
    {"joint", "the steps of Eq. 20; off: labels as they come", &Fx::joint,
     "all steps before the photos' edges are followed", "", OnWhere::kAlways, {}, 0,
     "what replaced it cost up to 5 points of boundary IoU on scenes with inaccurate masks"},
    {"nerf", "the NeRF and all that needs it", &Fx::nerf, "rays, field, network, L_align, L_smth", "joint",
     kAbove, "without photos: 1 - boundary IoU of the labels as they come with the masks", 0.02,
     "two points, what masks of one object differ by from tool to tool; beside photos it gained nothing",
     &Probe::gap_without_photos},
    {"boundary", "boundary set; off: every seen Gaussian", &Fx::boundary, "", "", OnWhere::kAlways, {}, 0,
     "the set is what all else works on; without it there is more to do, not less"},
    {"box", "box of the boundary; off: the whole image", &Fx::box, "", "", OnWhere::kAlways, {}, 0,
     "without it there is more to do, not less"},
    {"rbf", "RBF interpolation; off: nearest feature", &Fx::rbf, "all neighbours of a query but the nearest",
     "nerf", kAbove, "largest colour difference between neighbours, levels", 0.5, kHalfLevel,
     &Probe::most_neighbour},
    {"hash", "hash levels; off: one coarse level", &Fx::hash, "all levels but one", "nerf",
     OnWhere::kAlways, {}, 0, "one level costs the network as much"},
    {"fine-hash", "hash levels finer than the boundary; off: not", &Fx::fine_hash,
     "levels whose cells are below half the boundary's spacing", "nerf", kAbove,
     "side of the finest cell, in spacings of the boundary", kFinestCell,
     "two cells to a spacing: no finer detail has support", &Probe::cells},
    {"film", "condition on f_inter; off: none", &Fx::film, "", "nerf", OnWhere::kAlways, {}, 0,
     "without it the same network runs"},
    {"align", "L_align: colour and opacity", &Fx::align, "L_align and its gradients", "nerf",
     OnWhere::kAlways, {}, 0, "it is what the field is trained by"},
    {"variance", "L_align: 7x7 variance", &Fx::variance, "the patch pass", "align", kAbove,
     "standard deviation of 7x7 patches at the masks' contours, levels", 0.5, kHalfLevel, &Probe::patches},
    {"density", "density weights of L_mask", &Fx::density, "", "nerf", OnWhere::kAlways, {}, 0,
     "a by-product of the field"},
    {"mask", "L_mask", &Fx::mask, "", "", OnWhere::kAlways, {}, 0, "what the labels are trained by"},
    {"cont", "L_cont", &Fx::cont, "its pass over the neighbours", "joint", kAbove,
     "RMS colour difference of neighbours on the boundary, levels", 0.5, kHalfLevel, &Probe::rms_neighbour},
    {"smooth", "L_smth", &Fx::smooth, "two more evaluations of the field", "nerf", kAbove,
     "range of the boundary's colours, levels", 0.5, kHalfLevel, &Probe::colour_range},
    {"photometric", "anchor to the photos", &Fx::photometric, "compositing colour, SSIM", "", kAbove,
     "views that have a photo", 0, "one is enough", &Probe::photos},
    {"region", "anchor to all of a photo; off: about the object", &Fx::region, "SSIM away from the object",
     "joint", kAbove, "share of the labels' weight outside of the windows", 1e-3,
     "a thousandth: nothing there is moved by a mask", &Probe::outside},
    {"sh", "view-dependent colour", &Fx::sh, "SH bands, their gradients and steps", "", kAbove,
     "strongest view-dependent colour, levels", 0.5, kHalfLevel, &Probe::view_dependence},
    {"antialias", "the opacity compensation the model was trained with", &Fx::antialias, "the compensation",
     "", kAbove, "most opacity that it takes, levels", 0.5, kHalfLevel, &Probe::compensation},
    {"geometry", "move the Gaussians", &Fx::geometry, "", "", OnWhere::kAlways, {}, 0,
     "gradients that exist anyway; what they move is the result"},
    {"mask-geometry", "L_mask moves the Gaussians", &Fx::mask_geometry, "", "", OnWhere::kAlways, {}, 0,
     "gradients that exist anyway"},
    {"contours", "contours follow the photos' edges", &Fx::edges, "walks, halving, training on the windows", "",
     kAbove, "views that have a photo", 0, "one is enough; the walk then has its own test", &Probe::photos},
    {"split", "halve what lies across contours", &Fx::split, "the search for it, and the rows it adds",
     "contours", kAbove, "most weight that a Gaussian can have on a wrong side, px", 3,
     "the default of --contour-split: nothing is halved", &Probe::straddling},
    {"contour-iterations", "follow the edges more than once", &Fx::contour_iterations_on, "all rounds but the first", "contours",
     OnWhere::kAlways, {}, 0,
     "what replaced it cost up to 2 points of boundary IoU on scenes with inaccurate masks"},
    {"full-resolution", "all rounds at the full size, after all steps; off: the last alone, after few", &Fx::full_resolution,
     "half of the other rounds' rows, columns and visits, 0.7 of the steps before them", "contour-iterations", kAbove,
     "most of an object that lies in parts narrower than 9 px, share (1: some view has no photo)", 0.03,
     "between solid things (at most 0.02) and small or thin ones (from 0.04), which half the size leaves few pixels of",
     &Probe::narrow},
};

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace

std::span<const EffectInfo> effect_registry() { return kRegistry; }

const EffectInfo* find_effect(std::string_view name) {
  const auto* found = std::find_if(std::begin(kRegistry), std::end(kRegistry),
                                   [&](const EffectInfo& e) { return e.name == name; });
  return found == std::end(kRegistry) ? nullptr : found;
}

bool belongs_to(std::string_view name, std::string_view whole) {
  for (; !name.empty(); name = find_effect(name)->needs)
    if (name == whole) return true;
  return false;
}

std::map<std::string_view, EffectMode> effect_modes(const std::vector<std::string>& entries) {
  std::map<std::string_view, EffectMode> modes;
  for (const std::string& entry : entries) {
    const std::size_t equals = std::min(entry.find('='), entry.size());
    const std::string name = entry.substr(0, equals),
                      value = entry.substr(std::min(equals + 1, entry.size()));
    const EffectInfo* known = find_effect(name);
    if ((known == nullptr && name != "all") || (value != "auto" && value != "on" && value != "off")) {
      std::string names = "all";
      for (const EffectInfo& e : kRegistry) names += ", " + std::string(e.name);
      throw Error(ErrorCode::kUsage, "--effect: '" + entry + "', expected NAME=auto|on|off",
                  "NAME is one of " + names);
    }
    const EffectMode mode = value == "auto" ? EffectMode::kAuto
                            : value == "on" ? EffectMode::kOn
                                            : EffectMode::kOff;
    for (const EffectInfo& e : kRegistry)
      if (known == nullptr || known == &e) modes[e.name] = mode;
  }
  return modes;
}

EffectMode mode_of(std::string_view name, const std::vector<std::string>& entries) {
  const auto modes = effect_modes(entries);
  const auto found = modes.find(name);
  return found == modes.end() ? EffectMode::kAuto : found->second;
}

JointEffects parse_effects(const std::vector<std::string>& entries) {
  JointEffects effects;
  for (const auto& [name, mode] : effect_modes(entries))
    effects.*find_effect(name)->member = mode != EffectMode::kOff;
  return effects;
}

std::string decision_reason(const EffectInfo& e, double measured, bool on) {
  const bool above = (e.on == OnWhere::kAbove) == on;
  return std::string(e.measured) + ": " + short_number(measured) + (above ? " > " : " <= ") +
         short_number(e.threshold);
}

std::string decision_line(const EffectDecision& d) {
  return d.mode + ": " + std::string(d.effect->name) + "=" + (d.on ? "on" : "off") + " (" + d.reason + ")" +
         (d.on || d.effect->saves.empty() ? "" : ", leaves out " + std::string(d.effect->saves));
}

}  // namespace ngs

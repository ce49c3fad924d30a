#pragma once
// Options of ngs-scene orbit: placement, number and field of view of the cameras.
#include <string>
#include <string_view>

#include "ngs/options/field.h"

namespace ngs {

/// Whether cameras are placed outside or inside the model, or near what most of its Gaussians show.
enum class Place : std::uint8_t { kAuto, kOutside, kInside, kNear };
inline constexpr NamedValue<Place> kPlaceNames[] = {
    {Place::kAuto, "auto"}, {Place::kOutside, "outside"}, {Place::kInside, "inside"}, {Place::kNear, "near"}};

enum class UpAxis : std::uint8_t { kAuto, kX, kY, kZ, kMinusX, kMinusY, kMinusZ };
inline constexpr NamedValue<UpAxis> kUpNames[] = {
    {UpAxis::kAuto, "auto"}, {UpAxis::kX, "x"},       {UpAxis::kY, "y"},      {UpAxis::kZ, "z"},
    {UpAxis::kMinusX, "-x"}, {UpAxis::kMinusY, "-y"}, {UpAxis::kMinusZ, "-z"}};

/// The axis that a model's comment names (GaussianPly::vertical_axis), unless another one is chosen.
inline UpAxis up_or(UpAxis chosen, std::string_view of_model) {
  for (const auto& [axis, name] : kUpNames)
    if (chosen == UpAxis::kAuto && name == of_model) return axis;
  return chosen;
}

struct OrbitOptions {
  UpAxis up = UpAxis::kAuto;
  Place place = Place::kAuto;
  std::string around;
  int view_count = 24;
  int max_views = 96;
  double coverage = 0.95;
  double fov_deg = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.around, Text{"around", "X,Y,Z,R",
                            "Place cameras around this ball, in model coordinates; default: the bulk of the model"});
    visit(self.up,
          Choice<UpAxis>{
              "up", "Axis of the model that points upwards; auto: away from a floor or the base of an object, else -y",
              kUpNames});
    visit(self.place,
          Choice<Place>{"place",
                        "Where cameras are placed; auto: inside if that shows more of the surface, as in a room; near: "
                        "inside or, around a scene with surroundings, above its middle and near to it",
                        kPlaceNames});
    visit(self.view_count, Field<int>{"view_count", "", "Number of cameras to start with", 3, 1000});
    visit(self.max_views, Field<int>{"max_views", "", "Most cameras that --coverage may lead to", 3, 1000});
    visit(self.coverage,
          Field<double>{"coverage", "", "Add cameras until three of them see this fraction of the visible surface", 0.0,
                        1.0});
    visit(
        self.fov_deg,
        Field<double>{"fov", "deg", "Field of view along the longer side; 0: 40 from outside, 80 inside", 0.0, 120.0});
  }
};

}  // namespace ngs

#pragma once
// The signed distance to an object's surface, as the renderings from all around support it.
//
// A place gathers what each view shows there. In front of the surface, or where the view shows nothing: free. Within a
// band about the surface: its distance to the plane of the pixel, weighted by the square of the cosine of the viewing
// angle, less behind the surface. Farther behind, or where the view looks into the object: nothing. The distance is the
// weighted mean. A place that only few views see free or near the surface is inside: what no view reaches is filled.
//
// Nothing of the object is behind a plane that it stands on or against, and a view from behind it says nothing about
// what is free: the plane was there. Down to the plane, the object continues as it is at the plane's tolerance.
#include <optional>
#include <vector>

#include "ngs/edit/fill/fill_surface.h"
#include "ngs/mesh/surface/iso_surface.h"
#include "ngs/mesh/surface/surface_views.h"

namespace ngs::mesh {

class DistanceField {
 public:
  /// `band`: world; the views must outlive this object. `planes`: that the object stands on or against.
  DistanceField(const std::vector<SurfaceView>& views, double band, std::vector<FillSurface> planes)
      : views_(views), band_(band), planes_(std::move(planes)) {}

  /// The values of a block of `grid` for iso_surface(): distances in units of the band, in [-1, 1].
  void sample(const SampleGrid& grid, std::array<int, 3> low, std::vector<float>& values) const;

  /// The mean colour [0, 1] sRGB of the views that see a point of the surface with this normal, weighted by the square
  /// of the cosine; nothing if none does.
  std::optional<Vec3<float>> colour(Vec3<double> point, Vec3<double> normal) const;

 private:
  const std::vector<SurfaceView>& views_;
  double band_;
  std::vector<FillSurface> planes_;
};

}  // namespace ngs::mesh

#pragma once
// The standard photometric fit of 3D Gaussian splatting: L1 + DSSIM, clone and split by the view-space gradient,
// prune by opacity and size, opacity resets, SH bands in steps.
//
// The result is a function of (options, seed, views, initial state): its bytes depend neither on exec.threads nor on
// interruptions. FitState contains everything that later steps read.
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/make/fit/fit_density.h"
#include "ngs/ops/losses/photometric.h"
#include "ngs/ops/optim/resident.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/options/field.h"
#include "ngs/render/background.h"
#include "ngs/scene/packed_photo.h"
#include "ngs/scene/scene.h"

namespace ngs {

/// Defaults, including the Adam rates, are those of 3DGS. Only members listed in describe() are options. Step counts
/// of 0 are derived from `steps` (resolved_schedule()).
struct FitOptions {
  int steps = 7000;
  int sh_degree = 3;
  int max_gaussians = 1000000;
  double dssim_weight = 0.2;
  std::string background = {};  // empty: black
  bool antialiased = false;
  int random_points = 20000;
  int sh_every = 0, densify_from = 0, densify_until = 0, densify_every = 0, opacity_reset_every = 3000;
  double densify_gradient = 2e-4, dense_fraction = 0.01, min_opacity = 0.005, max_scale_fraction = 0.1;
  double position_lr = 1.6e-4, position_lr_final = 1.6e-6;
  // A step lowers the opacity logit of Gaussians near its camera: by `near_loss` at the camera, by 0 from `near_reach`
  // of the distance to what it looks at. Otherwise moving light is explained by haze before each camera (decision 086).
  double near_loss = 0.6, near_reach = 0.8;
  double dc_lr = 0.0025, rest_lr = 0.000125, opacity_lr = 0.05, scale_lr = 0.005, rotation_lr = 0.001;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.steps, Field<int>{"steps", "", "Optimisation steps, one view each", 1, 10000000});
    visit(self.sh_degree, Field<int>{"sh_degree", "", "Highest degree of the spherical harmonics", 0, 3});
    visit(self.max_gaussians, Field<int>{"max_gaussians", "", "Maximum number of Gaussians", 1, 1 << 30});
    visit(self.background, background_option());
    visit(self.antialiased, Flag{"antialiased", "Fit with the opacity compensation of Mip-Splatting"});
    visit(self.random_points,
          Field<int>{"random_points", "", "Number of random initial Gaussians if there is no point cloud", 1, 1 << 24});
  }
};

struct FitSchedule {
  int sh_every, densify_from, densify_until, densify_every;
};
FitSchedule resolved_schedule(const FitOptions& options);

/// Estimated cost of a fit: seconds of one core and peak memory. Measured on a current machine, within a factor of two.
struct FitCost {
  double cpu_s = 0, memory_mib = 0;
};
/// `photo_bytes`: memory of all photos in FitView::photo.
FitCost fit_cost(const FitOptions& options, std::span<const Camera> cameras, double photo_bytes);

struct FitView {
  Camera camera;
  PackedPhoto photo;  // of the camera's size
  Split split = Split::kTrain;
};

struct FitPoint {
  float position[3];
  float rgb[3];  // [0, 1]
};

/// The spatial scale of 3DGS: 1.1 times the largest distance of a training camera from their mean; 1 for one camera.
double scene_extent(std::span<const FitView> views);
double scene_extent(std::span<const Camera> cameras);

/// The point nearest to all optical axes. With parallel axes the regulariser decides: it pulls towards the point one
/// extent in front of each camera.
Vec3<double> nearest_to_axes(std::span<const FitView> views);

/// Unit of math/world_unit.h: below 1 if the point that the cameras look at is less than two near planes away.
double fit_world_unit(std::span<const FitView> views);

/// Isotropic Gaussians of opacity 0.1, as wide as the root mean square distance to their 3 nearest neighbours.
/// Of more than `max_gaussians` points, `max_gaussians` are used, evenly spaced in the list.
/// Without points: `random_points` points of random colours in a cube around the point that the cameras look at.
FitState initial_fit(const Exec& exec, const FitOptions& options, std::span<const FitPoint> points,
                     std::span<const FitView> views, std::uint64_t seed);

class Fitter {
 public:
  /// Keeps a reference to `views`; at least one must be a training view.
  Fitter(const FitOptions& options, std::span<const FitView> views, FitState state, std::uint64_t seed);

  /// One optimisation step, always on the same device. Throws Error(kNumeric) for a non-finite gradient.
  void step(const Exec& exec);
  /// Copies the state from the device.
  const FitState& state() const {
    if (arrays_) arrays_->release();
    return state_;
  }
  std::int64_t steps_done() const { return state_.step; }
  PhotometricLoss last_loss() const { return last_loss_; }
  FitState take() { return state(), std::move(state_); }

 private:
  std::size_t view_of_step();
  void start_pass(const Exec& exec, int degree);
  void to_device(const Exec& exec);
  void update_parameters(const Exec& exec);
  void accumulate_gradients(const Exec& exec, const Camera& camera);
  void reset_opacity();
  void fade_near(const Exec& exec, const Camera& camera);

  FitOptions options_;
  FitSchedule schedule_;
  std::span<const FitView> views_;
  FitState state_;
  std::uint64_t seed_;
  double extent_, world_unit_;
  Vec3<double> focus_;
  std::vector<std::size_t> training_;  // indices of views
  std::vector<std::size_t> order_;     // of the current epoch
  std::int64_t order_epoch_ = -1;
  int pass_degree_ = -1;
  std::unique_ptr<Resident> arrays_;         // of the state and gradients
  std::unique_ptr<ResidentImages> photos_;   // by view
  std::unique_ptr<ResidentResults> images_;  // of pass_ and colour_gradient_
  SplatPass pass_;
  PhotometricPass<float> photometric_;
  ImageF colour_gradient_;
  CloudGradients gradients_;
  PhotometricLoss last_loss_;
};

/// Runs up to options.steps, or until a stop request to `monitor`. Calls `every(fitter)` after each step.
void run_fit(const Exec& exec, Monitor& monitor, Fitter& fitter, const FitOptions& options,
             const std::function<void(const Fitter&)>& every);

struct FitScore {
  double psnr_db = 0, ssim = 0;
  int views = 0;
};
/// Mean PSNR and SSIM of the render, clamped to [0, 1], over the views of one split; zeros without views.
FitScore score_fit(const Exec& exec, const FitOptions& options, const GaussianCloud& cloud,
                   std::span<const FitView> views, Split split);

}  // namespace ngs

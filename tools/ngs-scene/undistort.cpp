#include "ngs/capture/undistort.h"

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <set>

#include "commands.h"
#include "ngs/backend/for_each.h"
#include "ngs/core/folded_name.h"
#include "ngs/io/capture/capture_source.h"
#include "ngs/io/capture/sparse_points.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/image/mask_names.h"
#include "ngs/io/image/masks.h"
#include "ngs/options/field.h"
#include "ngs/scene/view_names.h"
#include "shared/tool.h"

namespace ngs::scene_tool {
namespace {

namespace fs = std::filesystem;

struct UndistortOptions {
  int jpeg_quality = 95;
  bool original_world = false;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.jpeg_quality,
          Field<int>{"jpeg_quality", "", "JPEG quality for JPEG photos; others become PNGs", 1, 100});
    visit(self.original_world, Flag{"original_world", "Undo the applied_transform of transforms.json"});
  }
};

struct UndistortedView {
  Camera distorted, pinhole;
  const Lens* lens;  // null: pinhole, files are copied
};

bool is_jpeg(const std::string& name) {
  const std::string ending = lower_case(fs::path(name).extension().string());
  return ending == ".jpg" || ending == ".jpeg";
}

void make_folder_of(const std::string& path) {
  std::error_code error;
  fs::create_directories(fs::path(path).parent_path(), error);
  if (error) throw Error(ErrorCode::kEnvironment, path + ": " + error.message() + ", expected a folder to write to");
}

/// Keeps 8 or 16 bits. Writes an RGB JPEG if `jpeg_quality` is not 0, otherwise a PNG.
void write_samples(const std::string& path, const io::RawMask& picture, int jpeg_quality) {
  const bool narrow = picture.bits == 8;
  if (!narrow) {
    ImageU16 image(picture.width_px, picture.height_px, picture.channels);
    image.data = picture.data;
    return io::write_png16(path, image);
  }
  const bool grey_jpeg = jpeg_quality > 0 && picture.channels == 1;
  ImageU8 image(picture.width_px, picture.height_px, grey_jpeg ? 3 : picture.channels);
  for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = std::uint8_t(picture.data[grey_jpeg ? i / 3 : i]);
  if (jpeg_quality == 0) return io::write_png(path, image);
  const std::vector<std::uint8_t> bytes = io::encode_jpeg(image, jpeg_quality);
  io::write_file(path, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

io::RawMask undistorted_picture(const io::RawMask& picture, const UndistortedView& view, Resampling resampling) {
  io::RawMask out = picture;
  out.width_px = view.pinhole.width_px;
  out.height_px = view.pinhole.height_px;
  out.data = undistorted({}, picture.samples(), {view.distorted, *view.lens}, view.pinhole, resampling);
  return out;
}

/// True for binary masks, whose contour may be interpolated; ids and bands must not be interpolated.
bool is_two_valued(const io::RawMask& mask) {
  std::set<std::uint16_t> values;
  for (const std::uint16_t value : mask.data)
    if (values.insert(value).second && values.size() > 2) return false;
  return mask.channels == 1 && values.size() == 2 && *values.begin() == 0;
}

/// The mask at the photo's size; contours of binary masks are interpolated to subpixel precision.
io::RawMask undistorted_mask(const std::string& path, const UndistortedView& view) {
  if (io::is_exr(path))
    throw Error(ErrorCode::kBadInput, path + ": an EXR mask, expected PNG or JPEG for a camera with distortion",
                "save it as a PNG");
  const io::RawMask mask = io::read_mask_raw(path, io::Palette::kIndices);
  const bool binary = is_two_valued(mask);
  io::RawMask out = undistorted_picture(mask, view, binary ? Resampling::kBilinear : Resampling::kNearest);
  if (!binary) return out;
  const std::uint16_t high = *std::ranges::max_element(mask.data);
  for (std::uint16_t& value : out.data) value = 2 * value >= high ? high : 0;
  return out;
}

void copy_bytes(const std::string& from, const std::string& to) {
  const io::MappedFile file = io::map_regular_file(from);
  io::write_file(to, file.text());
}

std::string as_png(const std::string& path) { return image_stem(path) + ".png"; }

/// Last folder name of a path, with or without trailing slash.
std::string last_folder(const std::string& path) {
  return fs::path(fs::path(path) / "").parent_path().filename().string();
}

class Undistortion {
 public:
  Undistortion(cli::Run& run, const UndistortOptions& options, io::CaptureSource source, std::string folder)
      : run_(run), options_(options), source_(std::move(source)), folder_(std::move(folder)) {
    for (const SceneView& view : source_.capture.views) {
      const auto lens = source_.capture.lenses.find(view.camera.name);
      const bool distorted = lens != source_.capture.lenses.end();
      UndistortedView& s =
          views_.emplace_back(UndistortedView{view.camera, view.camera, distorted ? &lens->second : nullptr});
      if (!distorted) continue;
      s.pinhole = undistorted_camera({view.camera, lens->second});
      if (!is_jpeg(view.camera.name)) s.pinhole.name = as_png(view.camera.name);
    }
  }

  std::size_t distorted() const { return source_.capture.lenses.size(); }
  Json sizes() const {
    std::map<std::string, std::size_t> count;
    for (const UndistortedView& v : views_)
      if (v.lens)
        ++count[io::to_string({v.distorted.width_px, v.distorted.height_px}) + " -> " +
                io::to_string({v.pinhole.width_px, v.pinhole.height_px})];
    return count;
  }
  std::size_t write_photos() const {
    const auto timed = run_.monitor().scope("photos");
    return write_each([this](std::size_t v) { return std::vector<std::string>{source_.capture.views[v].image_path}; },
                      [this](std::size_t v, const std::string& path) {
                        const UndistortedView& view = views_[v];
                        const std::string to = folder_ + "/images/" + view.pinhole.name;
                        make_folder_of(to);
                        if (!view.lens) return copy_bytes(path, to);
                        const io::RawMask photo = io::read_mask_raw(path, io::Palette::kColours);
                        write_samples(to, undistorted_picture(photo, view, Resampling::kBilinear),
                                      is_jpeg(to) ? options_.jpeg_quality : 0);
                      });
  }
  /// Masks of `masks_dir`, or if empty the masks named in the source.
  std::size_t write_masks(const std::string& masks_dir) const {
    const auto timed = run_.monitor().scope("masks");
    Scene scene;
    scene.views = source_.capture.views;
    if (!masks_dir.empty()) {
      for (SceneView& view : scene.views) view.mask_path.clear();
      for (const std::string& object : io::match_masks(masks_dir, {}, scene.views).objects)
        scene.objects.push_back({.name = object});
    }
    const std::string name = masks_dir.empty() ? "masks" : last_folder(masks_dir);
    return write_each([&](std::size_t v) { return io::mask_files(scene, v); },
                      [&](std::size_t v, const std::string& path) {
                        const std::string below = masks_dir.empty()
                                                      ? image_stem(views_[v].distorted.name) + ".png"
                                                      : fs::path(path).lexically_relative(masks_dir).generic_string();
                        const std::string to = folder_ + "/" + name + "/" + below;
                        make_folder_of(to);
                        if (!views_[v].lens) return copy_bytes(path, to);
                        write_samples(as_png(to), undistorted_mask(path, views_[v]), 0);
                      });
  }
  void write_cameras() const {
    std::vector<Camera> cameras;
    for (const UndistortedView& view : views_) cameras.push_back(view.pinhole);
    std::vector<SparsePoint> points;
    for (const char* name : {"points3D.bin", "points3D.txt"})
      if (const std::string path = (fs::path(source_.file) / name).generic_string();
          points.empty() && io::is_regular_file(path))
        points = io::read_points(path);
    io::write_colmap_text(folder_ + "/sparse/0", cameras, points);
  }

 private:
  /// Calls write(view, path) for the files of all views, kParallelViews at a time; returns the number of files.
  template <class Files, class Write>
  std::size_t write_each(const Files& files, const Write& write) const {
    constexpr int kParallelViews = 4;  // each needs memory for two copies of a photo
    Exec exec = run_.exec();
    exec.threads = std::min(exec.threads, kParallelViews);
    std::mutex mutex;
    std::size_t count = 0;
    std::int64_t done = 0;
    for_each_task(exec, std::ssize(views_), [&](std::int64_t v) {
      std::size_t own = 0;
      for (const std::string& path : files(std::size_t(v)))
        if (!path.empty()) {
          write(std::size_t(v), path);
          ++own;
        }
      const std::lock_guard lock(mutex);
      count += own;
      run_.monitor().progress(++done, std::ssize(views_));
    });
    return count;
  }

  cli::Run& run_;
  const UndistortOptions& options_;
  io::CaptureSource source_;
  std::string folder_;
  std::vector<UndistortedView> views_;
};

/// Input folders with equal names would share one output folder.
void require_distinct_names(const std::vector<std::string>& folders) {
  std::set<std::string> seen{"images", "sparse"};
  for (const std::string& folder : folders)
    if (!seen.insert(last_folder(folder)).second)
      throw Error(ErrorCode::kUsage, folder + ": duplicate folder name, expected unique names",
                  "rename one of the folders, or run ngs-scene undistort twice");
}

}  // namespace

int undistort_command(int argc, char** argv) {
  cli::Tool tool("ngs-scene undistort", "Remove lens distortion from the photos, masks and cameras of a capture.",
                 {"ngs-scene undistort captures/shoe -o captures/shoe-straight",
                  "ngs-scene undistort transforms.json --masks masks --masks truth -o straight"});
  UndistortOptions options;
  tool.options(options);
  const cli::Argument& source = tool.argument("source", "COLMAP folder, transforms.json, or a folder with one of them");
  const cli::Input& images = tool.optional_input("--images", "folder of photos; default: images/ next to the cameras");
  const cli::Inputs& masks = tool.inputs("--masks", "folders of masks; default: masks/ next to the cameras");
  const cli::Output& out = tool.output_dir("-o,--output", "folder for images/, sparse/0 and the masks' folders");

  return tool.run(argc, argv, [&](cli::Run& run) {
    require_distinct_names(masks.paths);
    io::CaptureRequest request;
    request.source = source.value;
    request.images_dir = images.path;
    request.original_world = options.original_world;
    request.distortion = io::Distortion::kKept;
    io::CaptureSource capture = io::read_capture(request);
    for (const std::string& note : capture.capture.notes) run.info(note);
    std::vector<std::string> folders = masks.paths;
    if (const std::string found = (fs::path(capture.base) / "masks").generic_string();
        !masks && fs::is_directory(found))
      folders.push_back(found);
    if (folders.empty()) folders.emplace_back();  // masks named in the source
    const std::size_t views = capture.capture.views.size();
    const Undistortion undistortion(run, options, std::move(capture), out.path);
    if (undistortion.distorted() == 0)
      run.monitor().warn(source.value + ": no camera has lens distortion, all files are copied");
    run.result() = {{"views", views}, {"distorted", undistortion.distorted()}, {"sizes", undistortion.sizes()}};
    if (run.dry_run()) {
      run.plan({{"views", views}});
      return cli::kDone;
    }
    const std::size_t photos = undistortion.write_photos();
    std::size_t mask_files = 0;
    for (const std::string& folder : folders) mask_files += undistortion.write_masks(folder);
    undistortion.write_cameras();
    run.result()["photos"] = photos;
    run.result()["masks"] = mask_files;
    if (photos < views) run.monitor().warn(std::to_string(views - photos) + " views have no photo");
    return cli::kDone;
  });
}

}  // namespace ngs::scene_tool

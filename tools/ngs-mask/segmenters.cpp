#include "segmenters.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>
#include <sstream>

#include "ngs/backend/for_each.h"
#include "ngs/core/error.h"
#include "ngs/eval/eval_stage.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/image/image_file.h"
#include "ngs/ops/image/grab_cut.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/ops/image/pixel_window.h"
#include "shared/os/files.h"
#include "shared/run/child_process.h"

namespace ngs::cli {
namespace {

namespace fs = std::filesystem;

/// A temporary folder, removed with this object or at the end of the process.
struct ScratchFolder {
  std::string path;
  io::UnfinishedFile cleanup;
  ScratchFolder() : path(os::temporary_path("ngs-mask-XXXXXX")) {
    if (!os::make_temporary_folder(path))
      throw Error(ErrorCode::kEnvironment, path + ": cannot be created: " + std::strerror(errno),
                  "set TMPDIR to a writable folder");
    cleanup.track(path.c_str());
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
};

constexpr int kPoints = 3;  // points per label in the prompts of a program

Json prompts_json(const std::string& view, const ViewPrompt& prompt, const std::string& mask) {
  Json json{{"ngs_prompts", 1}, {"view", view}, {"width", prompt.width_px}, {"height", prompt.height_px}};
  json["points"] = Json::array();
  for (const PromptPoint& p : prompt_points(prompt, kPoints))
    json["points"].push_back({{"object", p.object}, {"x", p.x + 0.5}, {"y", p.y + 0.5}});
  const std::array<int, 4> box = object_box(prompt);
  if (!prompt.by_hand || box[2] > 0) json["boxes"] = Json::array({box});
  if (prompt.by_hand && !std::ranges::count(prompt.hint, PixelHint::kLikelyObject)) json["box_of_marks"] = true;
  if (!mask.empty()) json["mask"] = mask;
  return json;
}

ImageU8 likely_object(const ViewPrompt& prompt) {
  ImageU8 mask(prompt.width_px, prompt.height_px, 1);
  for (std::size_t p = 0; p < mask.data.size(); ++p) mask.data[p] = is_object(prompt.hint[p]) ? 255 : 0;
  return mask;
}

io::RawMask read_output(const std::string& path, io::ImageSize expected, io::Palette palette, const std::string& who) {
  const auto refuse = [&](const std::string& found) {
    throw Error(ErrorCode::kBadInput,
                who + ": " + found + ", expected " + (palette == io::Palette::kMask ? "a mask" : "an id map") + " of " +
                    io::to_string(expected) + " px, " +
                    (palette == io::Palette::kMask ? "0 or 255, as PNG at {out}" : "as PNG at {out}"));
  };
  std::error_code status;
  if (!fs::exists(path, status)) refuse("it wrote no file");
  if (fs::symlink_status(path, status).type() != fs::file_type::regular) refuse("it did not write a regular file");
  const io::ImageSize size = with_context(who, [&] { return io::read_image_size(path); });
  if (size != expected) refuse("it wrote " + io::to_string(size) + " px");
  return with_context(who, [&] { return io::read_mask_raw(path, palette); });
}

ImageU16 id_map_of(const io::RawMask& raw, const std::string& who) {
  ImageU16 ids(raw.width_px, raw.height_px, 1);
  const std::vector<std::uint32_t> labels = label_ids(raw.samples());
  for (std::size_t p = 0; p < labels.size(); ++p) {
    if (labels[p] > 0xffff)
      throw Error(ErrorCode::kBadInput,
                  who + ": it wrote the id " + std::to_string(labels[p]) + ", expected ids up to 65535");
    ids.data[p] = std::uint16_t(labels[p]);
  }
  return ids;
}

struct CallFiles {
  std::string image, prompts, out, mask;  // mask: not written for prompts by hand
};

struct CommandSegmenter {
  std::vector<std::string> words;
  bool is_persistent;  // one process for all calls, which reads one line of JSON per call
  double time_s;
  const Scene& scene;
  PhotoLoader load;
  Run& run;
  ScratchFolder folder{};
  std::int64_t calls = 0;
  std::optional<LineProgram> program{};

  PixelMask segment(std::size_t view, const ViewPrompt& prompt) {
    const std::string& name = scene.views[view].camera.name;
    const auto write_prompts = [&](const std::string& mask) {
      if (!prompt.by_hand) io::write_png(mask, likely_object(prompt));
      return prompts_json(name, prompt, prompt.by_hand ? "" : mask);
    };
    const std::optional<io::RawMask> raw =
        call(view, {prompt.width_px, prompt.height_px}, io::Palette::kMask, write_prompts);
    return raw ? object_pixels(raw->samples()) : PixelMask(prompt.hint.size());
  }

  std::optional<ImageU16> everything(std::size_t view, io::ImageSize size) {
    const std::string& name = scene.views[view].camera.name;
    const std::optional<io::RawMask> raw = call(view, size, io::Palette::kIndices, [&](const std::string&) {
      return Json{{"ngs_prompts", 1},
                  {"view", name},
                  {"width", size.width_px},
                  {"height", size.height_px},
                  {"everything", true}};
    });
    if (!raw) return {};
    return id_map_of(*raw, who(view));
  }

  std::string who(std::size_t view) const {
    return "--segmenter " + words[0] + " on view " + scene.views[view].camera.name;
  }

  /// What the program writes for a view; `write_prompts` gets the path of the expected mask and returns the prompts.
  /// nullopt after a stop request.
  template <class WritePrompts>
  std::optional<io::RawMask> call(std::size_t view, io::ImageSize size, io::Palette palette,
                                  const WritePrompts& write_prompts) {
    const std::string base = folder.path + "/" + std::to_string(calls++);
    const CallFiles files{base + "-image.png", base + "-prompts.json", base + "-out.png", base + "-mask.png"};
    const auto& [image, prompts, out, mask] = files;
    io::UnfinishedFile cleanup[4];
    for (int i = 0; const std::string& file : {image, prompts, out, mask}) cleanup[i++].track(file.c_str());
    io::write_png(image, load(view));
    io::write_file(prompts, write_prompts(mask).dump(1) + "\n");
    const std::optional<ChildResult> ended =
        is_persistent ? request_mask(scene.views[view].camera.name, files, who(view)) : run_once(files);
    if (ended && ended->end == ChildResult::End::kStopped) return {};
    if (ended) check(*ended, who(view));
    io::RawMask found = read_output(out, size, palette, who(view));
    for (const std::string& file : {image, prompts, out, mask}) fs::remove(file);
    return found;
  }

  ChildLimits limits() const {
    return {.time_s = time_s, .stop = [this] { return run.monitor().stop_requested(); }};
  }

  ChildResult run_once(const CallFiles& files) const {
    return run_child(fill_placeholders(words, {{"image", files.image}, {"prompts", files.prompts}, {"out", files.out}}),
                     limits());
  }

  /// Sends one request; nullopt: the response is {"ok": true}.
  std::optional<ChildResult> request_mask(const std::string& view, const CallFiles& files, const std::string& who) {
    if (!program) program.emplace(words);
    const Json request{{"view", view}, {"image", files.image}, {"prompts", files.prompts}, {"out", files.out}};
    const LineProgram::Response line =
        program->request(request.dump(-1, ' ', false, Json::error_handler_t::replace), limits());
    if (line.ended) return line.ended;
    const Json response = Json::parse(line.line, nullptr, false);
    if (response.is_object() && response.contains("ok") && response["ok"] == true) return std::nullopt;
    const bool explained = response.is_object() && response.contains("error") && response["error"].is_string();
    throw Error(explained ? ErrorCode::kEnvironment : ErrorCode::kBadInput,
                who + ": it responded " +
                    (explained ? response["error"].get<std::string>() : line.line.substr(0, 200)) +
                    ", expected {\"ok\":true}",
                "run the program by hand on one photo");
  }

  void check(const ChildResult& child, const std::string& who) const {
    if (child.end == ChildResult::End::kExited && child.code == 0 && !is_persistent) return;
    std::ostringstream found;
    if (child.end == ChildResult::End::kTimedOut) found << "not finished after " << time_s << " s";
    if (child.end == ChildResult::End::kSignalled) found << "ended by signal " << child.code;
    if (child.end == ChildResult::End::kExited) found << "exit code " << child.code;
    const std::string last_line = child.output_tail.substr(child.output_tail.rfind('\n') + 1);
    throw Error(ErrorCode::kEnvironment,
                who + ": " + found.str() +
                    (is_persistent ? ", expected a line of JSON" : ", expected exit code 0 and a mask") +
                    (last_line.empty() ? "" : "; its last output: " + last_line),
                child.end == ChildResult::End::kTimedOut ? "raise the limit with --segmenter-timeout-s"
                                                         : "run the program by hand on one photo");
  }
};

std::shared_ptr<CommandSegmenter> command_of(const SegmenterOptions& options, const Scene& scene, PhotoLoader load,
                                             Run& run) {
  const std::vector<std::string> words = split_command(options.segmenter);
  const auto has = [&](const std::string& placeholder) {
    return std::any_of(words.begin() + 1, words.end(),
                       [&](const std::string& w) { return w.find(placeholder) != w.npos; });
  };
  const bool is_persistent = !has("{image}") && !has("{prompts}") && !has("{out}");
  for (const char* placeholder : {"{image}", "{prompts}", "{out}"})
    if (!is_persistent && !has(placeholder))
      throw Error(ErrorCode::kUsage,
                  "--segmenter '" + options.segmenter + "': no " + placeholder +
                      ", expected all of {image} {prompts} {out}, or none",
                  "for example --segmenter 'python3 sam.py {image} {prompts} {out}'");
  return std::shared_ptr<CommandSegmenter>(
      new CommandSegmenter{words, is_persistent, options.segmenter_timeout_s, scene, std::move(load), run});
}

constexpr int kMinWindow = 48;            // px
constexpr int kCutsByHand = 5;            // iterations for prompts by hand
constexpr double kSpeck = 0.01;           // fraction of the mask: smaller holes are filled
constexpr std::int64_t kMinCertain = 64;  // certain pixels per label to fit a window's colour models

ImageU8 cropped(const ImageU8& image, const PixelWindow& win) {
  ImageU8 out(win.w, win.h, image.channels);
  out.data = ngs::cropped(image.data, image.width_px, image.channels, win);
  return out;
}

ViewPrompt cropped(const ViewPrompt& prompt, const PixelWindow& win) {
  return {win.w, win.h, ngs::cropped(prompt.hint, prompt.width_px, 1, win), prompt.by_hand};
}

/// True if the window has enough certain pixels of both labels, and uncertain pixels.
bool can_be_cut(const ViewPrompt& prompt) {
  std::int64_t count[4] = {};
  for (const PixelHint hint : prompt.hint) ++count[std::size_t(hint)];
  return std::min(count[0], count[1]) >= kMinCertain && count[2] + count[3] > 0;
}

/// A window, its part inside the photo, and the mask of that part.
struct WindowCut {
  int left, top;
  PixelWindow part;
  PixelMask mask = {};  // empty: not segmented
};

std::vector<WindowCut> windows_over(const ImageU8& photo, int window_px) {
  std::vector<WindowCut> cuts;
  const int step = std::max(1, window_px / 2);
  for (int top = -step; top < photo.height_px; top += step)
    for (int left = -step; left < photo.width_px; left += step)
      cuts.push_back(
          {left,
           top,
           {std::max(0, left), std::max(0, top), std::min(photo.width_px, left + window_px) - std::max(0, left),
            std::min(photo.height_px, top + window_px) - std::max(0, top)}});
  return cuts;
}

/// Each pixel gets the mean of its windows, weighted by a tent; pixels without a segmented window keep `whole`.
PixelMask mean_of(const std::vector<WindowCut>& cuts, int window_px, int width_px, PixelMask whole) {
  std::vector<float> votes(whole.size()), weights(whole.size());
  const auto tent = [&](int i) { return 1 - std::abs(2 * (float(i) + 0.5f) / float(window_px) - 1); };
  for (const WindowCut& cut : cuts) {
    const PixelWindow& win = cut.part;
    for (int y = 0; y < win.h && !cut.mask.empty(); ++y)
      for (int x = 0; x < win.w; ++x) {
        const float weight = tent(win.x0 + x - cut.left) * tent(win.y0 + y - cut.top);
        const std::size_t p = std::size_t(win.y0 + y) * std::size_t(width_px) + std::size_t(win.x0 + x);
        votes[p] += weight * float(cut.mask[win.at(x, y)]);
        weights[p] += weight;
      }
  }
  for (std::size_t p = 0; p < whole.size(); ++p)
    if (weights[p] > 0) whole[p] = votes[p] > 0.5f * weights[p];
  return whole;
}

/// Segments the whole photo and, in parallel, overlapping windows (none if window_px is 0) with local colour models:
/// a dark foot can be object in a dark room.
PixelMask cut_windows(const Exec& exec, const ImageU8& photo, const ViewPrompt& prompt, int window_px,
                      const GrabCutOptions& options) {
  std::vector<WindowCut> cuts;
  if (window_px > 0) cuts = windows_over(photo, window_px);
  PixelMask whole;
  for_each_task(exec, std::int64_t(cuts.size()) + 1, [&](std::int64_t i) {
    if (i == 0) {
      whole = grab_cut(photo, prompt, options);
      return;
    }
    WindowCut& cut = cuts[std::size_t(i - 1)];
    const ViewPrompt part = cropped(prompt, cut.part);
    if (can_be_cut(part)) cut.mask = grab_cut(cropped(photo, cut.part), part, options);
  });
  return mean_of(cuts, window_px, photo.width_px, std::move(whole));
}

}  // namespace

Segmenter command_segmenter(const SegmenterOptions& options, const Scene& scene, PhotoLoader load, Run& run) {
  const auto command = command_of(options, scene, std::move(load), run);
  return [command](std::size_t view, const ViewPrompt& prompt) { return command->segment(view, prompt); };
}

EverythingSegmenter everything_segmenter(const SegmenterOptions& options, const Scene& scene, PhotoLoader load,
                                         Run& run) {
  const auto command = command_of(options, scene, std::move(load), run);
  return [command](std::size_t view, io::ImageSize size) { return command->everything(view, size); };
}

Segmenter grab_cut_segmenter(const Exec& exec, const SegmenterOptions& options, PhotoLoader load, std::uint64_t seed) {
  return [=](std::size_t view, const ViewPrompt& prompt) {
    GrabCutOptions cut{.seed = seed};
    if (prompt.by_hand) cut.iterations = kCutsByHand;
    const ImageU8 photo = load(view);
    int window_px = 0;
    if (options.window > 0) {
      const std::array<int, 4> box = object_box(prompt);
      const double size = std::sqrt(double(box[2] - box[0]) * double(box[3] - box[1]));
      window_px = std::max(kMinWindow, int(std::lround(options.window * size)));
    }
    PixelMask mask = cut_windows(exec, photo, prompt, window_px, cut);
    return keep_seeded_pieces(prompt, std::move(mask), kSpeck);
  };
}

}  // namespace ngs::cli

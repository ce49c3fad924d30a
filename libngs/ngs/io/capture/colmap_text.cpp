#include "ngs/core/error.h"
#include "ngs/core/parse_number.h"
#include "ngs/io/capture/colmap.h"
#include "ngs/io/capture/colmap_model.h"
#include "ngs/io/capture/pose.h"
#include "ngs/io/files/text_lines.h"
#include "ngs/io/ply/ply_scan.h"

namespace ngs::io {
namespace {

constexpr std::string_view kBlank = " \t\r";

/// Lines with their numbers; skips comments, which begin with '#'.
class Lines {
 public:
  Lines(std::string_view text, std::string object) : rest_(without_byte_order_mark(text)), object_(std::move(object)) {
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
      throw Error(ErrorCode::kBadInput, object_ + ": text in UTF-16, expected UTF-8",
                  "convert it: iconv -f UTF-16 -t UTF-8 FILE");
  }

  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end + 1);
    ++number_;
    return true;
  }
  bool peek(std::string_view& line) const {
    line = rest_.substr(0, rest_.find('\n'));
    return !rest_.empty();
  }
  bool next_record(std::string_view& line) {
    while (next(line)) {
      const std::size_t first = line.find_first_not_of(kBlank);
      if (first != std::string_view::npos && line[first] != '#') return true;
    }
    return false;
  }
  std::string where() const { return object_ + ": line " + std::to_string(number_); }

 private:
  std::string_view rest_;
  std::string object_;
  int number_ = 0;
};

class Words {
 public:
  Words(std::string_view line, std::string where) : rest_(line), where_(std::move(where)) {}

  std::string_view next() {
    skip_blank();
    const std::string_view word = rest_.substr(0, rest_.find_first_of(kBlank));
    rest_.remove_prefix(word.size());
    return word;
  }
  /// The rest of the line: a name may contain blanks.
  std::string rest() {
    skip_blank();
    const std::size_t last = rest_.find_last_not_of(kBlank);
    return std::string(rest_.substr(0, last == std::string_view::npos ? 0 : last + 1));
  }
  template <class T>
  T number(const char* what) {
    const std::string_view word = next();
    T value{};
    if (!parse_number(word, value))
      throw Error(ErrorCode::kBadInput, where_ + ": \"" + printable(word) + "\", expected " + what);
    return value;
  }
  bool done() {
    skip_blank();
    return rest_.empty();
  }

 private:
  void skip_blank() { rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlank), rest_.size())); }

  std::string_view rest_;
  std::string where_;
};

ColmapCameras read_cameras(std::string_view text, const ColmapReading& reading) {
  Lines lines(text, reading.folder + "/cameras.txt");
  ColmapCameras cameras;
  std::string_view line;
  while (lines.next_record(line)) {
    Words words(line, lines.where());
    const auto id = words.number<std::int64_t>("a camera id");
    const std::string name(words.next());
    const ColmapModel* model = find_colmap_model_by_name(name);
    if (model == nullptr) refuse_colmap_model(name, lines.where(), reading.folder);
    const auto width = words.number<std::uint64_t>("a width"), height = words.number<std::uint64_t>("a height");
    std::vector<double> parameters;
    for (int p = 0; p < model->parameters; ++p) parameters.push_back(words.number<double>("a camera parameter"));
    if (!words.done())
      throw Error(ErrorCode::kBadInput, lines.where() + ": more than the " + std::to_string(model->parameters) +
                                            " parameters of " + name + ", expected no more");
    if (!cameras.emplace(id, intrinsics_of({*model, width, height, parameters}, lines.where(), reading)).second)
      throw Error(ErrorCode::kBadInput, lines.where() + ": camera " + std::to_string(id) + " twice, expected once");
  }
  return cameras;
}

/// Whether a file without the images' second lines has the next image here: it ends with a name, points with an id.
bool is_image_line(std::string_view line) {
  constexpr std::size_t kNumbers = 9;  // id, pose, camera id
  std::vector<std::string_view> words;
  for (Words all(line, {}); words.empty() || !words.back().empty();) words.push_back(all.next());
  words.pop_back();
  const auto is_number = [](std::string_view word) {
    double value = 0;
    return parse_number(word, value);
  };
  return words.size() > kNumbers && std::all_of(words.begin(), words.begin() + kNumbers, is_number) &&
         (words.size() % 3 != 0 || !is_number(words.back()));
}

/// Checks the second line of an image: triples x y id, or nothing.
void check_points_line(std::string_view line, const std::string& where) {
  std::size_t count = 0;
  for (Words all(line, where); !all.next().empty();) ++count;
  if (count == 0) return;
  if (count % 3 != 0)
    throw Error(
        ErrorCode::kBadInput,
        where + ": " + std::to_string(count) + " words, expected the image's points as x y id triples or an empty line",
        "images.txt has two lines per image; the second may be empty but must be there");
  Words words(line, where);
  words.number<double>("a point's x");
  words.number<double>("a point's y");
  words.number<std::int64_t>("a point's id");
}

}  // namespace

Capture parse_colmap_text(std::string_view cameras, std::string_view images, const std::string& object,
                          Distortion distortion) {
  const ColmapCameras intrinsics = read_cameras(cameras, {object, distortion});
  Lines lines(images, object + "/images.txt");
  Capture capture;
  capture.format = "COLMAP text";
  std::string_view line;
  while (lines.next_record(line)) {
    const std::string where = lines.where();
    Words words(line, where);
    words.number<std::int64_t>("an image id");
    double pose[7];
    for (double& value : pose) value = words.number<double>("a pose number");
    const auto camera_id = words.number<std::int64_t>("a camera id");
    const std::string name = words.rest();
    const auto found = intrinsics.find(camera_id);
    if (found == intrinsics.end())
      throw Error(ErrorCode::kBadInput,
                  where + ": camera " + std::to_string(camera_id) + ", expected one of cameras.txt");
    SceneView& view = capture.views.emplace_back();
    set_intrinsics(found->second, name, capture, view);
    view.camera.rotation = rotation_from_quaternion(pose, where);
    view.camera.translation = vec3(pose + 4);
    if (lines.peek(line) && is_image_line(line)) continue;
    if (lines.next(line)) check_points_line(line, lines.where());
  }
  finish_capture(capture, object + "/images.txt");
  return capture;
}

}  // namespace ngs::io

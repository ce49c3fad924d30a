#pragma once
// The marked views of a run: listed before it starts, and drawn with their strokes for the page.
#include <string>
#include <vector>

#include "ngs/edit/select/touched_pieces.h"
#include "ngs/edit/select/view_agreement.h"
#include "ngs/scene/scene.h"
#include "shared/run/run.h"

namespace ngs::ngs_tool {

struct StrokeFiles {
  std::string scene;  // scene file with the views
  std::string view;   // view of the strokes; empty: as given in each file
  const std::vector<std::string>& strokes;
};

/// Reads the strokes and returns one line per marked view: its name and its numbers of object and background strokes.
/// `scene` empty: the pictures do not exist yet, so that the files are read without the views. Throws the errors of the
/// readers and kUsage for strokes of no view.
std::string strokes_text(cli::Run& run, const std::string& scene, const std::string& view,
                         const std::vector<std::string>& strokes);

/// Writes the picture of every marked view with its strokes, STEM.png, to the folder, which it replaces.
void write_marked_views(cli::Run& run, const StrokeFiles& files, const std::string& folder);

// Handles renders that a user painted on in place instead of on a copy.

/// Writes hashes of the images in `folder` to the file `record`.
void record_pictures(const std::string& folder, const std::string& record);

/// Names of images in a folder of renders that are the user's work.
struct PaintedPictures {
  std::vector<std::string> in_place;  // differ from `record`: they must be rendered again, because strokes are read as
                                      // the difference
  std::vector<std::string> other_format;  // saved next to a render in another format: 0000.jpg
  std::vector<std::string> unknown;       // called like no render

  std::vector<std::string> all() const;  // in_place and other_format
};

/// Copies images in place and in another format to the folder `copies`. Finds none without a record.
PaintedPictures rescue_painted(const std::string& folder, const std::string& record, const std::string& copies);

/// `strokes` with images in `folder`, and the folder itself, replaced by their copies, plus the copies of `painted`
/// that are not among them.
std::vector<std::string> strokes_on_copies(const std::vector<std::string>& strokes, const std::string& folder,
                                           const std::string& copies, const PaintedPictures& painted);

/// `strokes` without the files in `folder`, which were painted in place.
std::vector<std::string> not_in_folder(const std::vector<std::string>& strokes, const std::string& folder);

// Checks labels against the strokes of ngs cut.
class StrokeCheck {
 public:
  /// `scene`: a file. Throws like cli::read_prompts() and rasterise().
  StrokeCheck(cli::Run& run, const std::string& scene, const std::string& view,
              const std::vector<std::string>& strokes);

  /// Agreement of these labels [N]; without `all_pieces`, components that no stroke touches are ignored.
  StrokeAgreement of(const GaussianCloud& cloud, const std::vector<float>& label, bool all_pieces) const;

 private:
  struct Marked {
    Camera camera;
    ViewPrompt prompt;
  };
  StrokeAgreement agreement(const GaussianCloud& cloud, std::vector<float> label, bool all_pieces) const;

  cli::Run& run_;
  Scene scene_;
  std::vector<Marked> marked_;
};

/// "0003.png: 87 % of the background stroke at 412,530 is object; 0007.png: ...", three at most.
std::string broken_text(const StrokeAgreement& agreement);

}  // namespace ngs::ngs_tool

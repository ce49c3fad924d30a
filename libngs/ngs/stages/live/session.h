#pragma once
// A visit to one model: a person marks objects on views of it and sees at once which Gaussians are theirs.
//
// Strokes on a view -> its mask (live_mask.h), begun from what the object's other views say there -> evidence of that
// view alone -> labels, by the sums of the other views that were kept. A further stroke on the same view changes of its
// mask only what is connected to the stroke, and only to the stroke's side; what it leaves as it was is not worked out
// again. Of the Gaussians that the labels select, those of pieces that no stroke touches are left out
// (select/touched_pieces.h), unless the marks ask for all pieces. No files, no clock in any result: the same strokes
// give the same masks and labels for any number of threads.
#include <mutex>

#include "ngs/stages/live/frame_cache.h"

namespace ngs::live {

inline constexpr int kSegmentedSide_px = 512;    // the longer side of a view as it is segmented; a smaller one stays
inline constexpr std::size_t kMostObjects = 16;  // each takes 70 bytes a Gaussian
inline constexpr std::size_t kMostStepsBack = 200;

/// The camera that strokes on `look` are segmented and lifted at.
Camera segmented_camera(const Look& look);

/// What a stroke did.
struct StrokeAnswer {
  double mask_s = 0, lift_s = 0;
  double coverage = 0;   // of the view by its mask
  bool is_first = true;  // on its view; else a correction
};

/// Functions that change something are called by one thread at a time; marks() and shown() by any.
class Session {
 public:
  /// The model must outlive it. Begins with one object without strokes.
  Session(const Exec& exec, const Model& model);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// kUsage for an object that is not there, and for strokes on the object of which no pixel shows anything of the
  /// model. A view is the same where the look is, to the last digit.
  StrokeAnswer mark(int object, const Look& look, const std::vector<PromptStroke>& strokes);
  int add_object(const std::string& name);  // kUsage beyond kMostObjects
  void remove_object(int id);
  void edit_object(int id, const std::string& name, const std::string& colour);  // empty: stays
  void activate(int id);
  void show_all_pieces(bool all);
  bool undo();  // false: there is nothing to undo
  bool redo();
  /// Steps back end here.
  void forget_steps();
  std::size_t steps_back() const { return before_.size(); }
  std::size_t steps_again() const { return after_.size(); }

  /// From marks that were kept: views with look, strokes, mask and name. The rest is worked out again.
  void restore(Marks marks);

  std::shared_ptr<const Marks> marks() const;
  std::shared_ptr<const std::vector<ShownObject>> shown() const;
  const Model& model() const { return model_; }
  /// The picture of a marked view as it is segmented.
  ImageU8 picture(const Camera& camera) const;

 private:
  /// An object's sums, and the views that are in them.
  struct Kept {
    int id;
    ObjectEvidence evidence;
    MarkedViews views;
    std::shared_ptr<const ObjectLabels> labels;      // of all pieces
    std::shared_ptr<const ObjectLabels> touched;     // of those that strokes touch
    std::shared_ptr<const ObjectLabels> touched_of;  // labels that `touched` was made from
  };

  void segment(MarkedView& view, const MarkedView* before, const MarkedViews& others, ObjectEvidence& sums);
  void correct(MarkedView& view, const MarkedView& before, const HandPrompt& added);
  Kept& kept(int id);
  void bring_up_to_date(Kept& kept, const ObjectMarks& object);
  void leave_out_untouched(Kept& kept) const;
  void publish(Marks marks);
  void step(Marks marks);
  const ObjectMarks& object(int id) const;

  const Exec exec_;
  const Model model_;
  FrameCache recent_;
  std::vector<Kept> kept_;
  std::vector<std::shared_ptr<const Marks>> before_, after_;
  mutable std::mutex mutex_;  // of what is published
  std::shared_ptr<const Marks> marks_;
  std::shared_ptr<const std::vector<ShownObject>> shown_;
};

}  // namespace ngs::live

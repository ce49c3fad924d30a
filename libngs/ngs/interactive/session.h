#pragma once
// An interactive session on one model: a user marks objects on its views and sees at once which Gaussians are selected.
//
// Strokes on a view -> its mask (live_mask.h), initialised by the labels of the object's other views -> evidence of
// that view alone -> labels, with the cached sums of the other views. Background strokes alone correct the selection
// that is seen in the view, as further strokes do. A further stroke on the same view changes the mask only in pixels
// connected to the stroke, and only towards the stroke's side; unchanged pixels are not recomputed. Pieces that no
// stroke touches are removed from the selection (select/touched_pieces.h), unless Marks::all_pieces is set. Results
// depend on no file and no clock: equal strokes give equal results for any number of threads.
#include <mutex>

#include "ngs/interactive/frame.h"

namespace ngs::live {

inline constexpr int kSegmentedSide_px = 512;   // longer side of a segmented view; smaller views keep their size
inline constexpr std::size_t kMaxObjects = 16;  // each takes 70 bytes per Gaussian
inline constexpr std::size_t kMaxStepsBack = 200;
inline constexpr std::size_t kMaxEditSteps = 4;  // cached results of edits by hand, 5 bytes per Gaussian each

/// The camera that strokes on a view are segmented and lifted at.
Camera at_segmented_size(const Camera& camera, int longer_side_px = kSegmentedSide_px);

struct StrokeAnswer {
  double mask_s = 0, lift_s = 0;
  double coverage = 0;   // fraction of the view that its mask covers
  bool is_first = true;  // the first stroke on its view; else a correction
};

/// Functions that change the session must be called by one thread at a time; marks() and shown() by any.
class Session {
 public:
  /// The model must outlive the session. Starts with one object without strokes.
  Session(const Exec& exec, const Model& model);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Throws kUsage for an unknown object, and if no pixel under the object strokes shows the model. Strokes belong to
  /// the same view if their poses are exactly equal, whatever the size of the window.
  StrokeAnswer mark(int object, const Viewpoint& drawn_on, const std::vector<PromptStroke>& drawn_strokes);
  int add_object(const std::string& name);  // throws kUsage beyond kMaxObjects
  void remove_object(int id);
  void edit_object(int id, const std::string& name, const std::string& colour);  // empty: unchanged
  void edit_by_hand(int id, const HandEdit& edit);                               // throws kUsage for a locked object
  void set_hidden(int id, bool hidden);
  void set_locked(int id, bool locked);
  void keep_dropped(int id, bool keep);
  void activate(int id);
  void show_all_pieces(bool all);
  bool undo();  // false: there is nothing to undo
  bool redo();
  void forget_steps();
  std::size_t steps_back() const { return before_.size(); }
  std::size_t steps_again() const { return after_.size(); }

  /// Restores saved marks: views with viewpoint, strokes, mask and name. Everything else is recomputed.
  void restore(Marks marks);

  std::shared_ptr<const Marks> marks() const;
  std::shared_ptr<const std::vector<ShownObject>> shown() const;
  const Model& model() const { return model_; }
  /// The render of a marked view that is segmented.
  ImageU8 picture(const Camera& camera) const;

 private:
  struct CachedObject {
    int id;
    WeightSums<> sums;
    MarkedViews views;
    std::shared_ptr<const ObjectLabels> labels;      // of all pieces
    std::shared_ptr<const ObjectLabels> touched;     // of the pieces that strokes touch
    std::shared_ptr<const ObjectLabels> touched_of;  // the labels that `touched` was made from
    std::vector<std::pair<HandEdits, std::shared_ptr<const ObjectLabels>>> steps;  // results of edits, latest first
    std::shared_ptr<const ObjectLabels> steps_of;                                  // the labels that the edits change
    std::shared_ptr<const ObjectLabels> unblocked;          // without the Gaussians of locked and hidden objects
    std::vector<std::shared_ptr<const void>> unblocked_of;  // what `unblocked` was made from
  };

  void segment(MarkedView& view, const MarkedView* before, const MarkedViews& others, WeightSums<>& sums);
  void correct(MarkedView& view, const MarkedView& before, const HandPrompt& added);
  CachedObject& cached(int id);
  void update(CachedObject& cache, const ObjectMarks& object);
  void remove_untouched(CachedObject& cache) const;
  std::shared_ptr<const ObjectLabels> with_edits_of(CachedObject& cache, const ObjectMarks& object,
                                                    bool all_pieces) const;
  std::shared_ptr<const ObjectLabels> edited(CachedObject& cache, const ObjectMarks& object, bool all_pieces,
                                             const std::vector<std::shared_ptr<const ObjectLabels>>& blocked) const;
  ShownObject show(const ObjectMarks& object, bool all_pieces,
                   const std::vector<std::shared_ptr<const ObjectLabels>>& blocked);
  ObjectMarks& changeable(Marks& marks, int id) const;
  void publish(Marks marks);
  void step(Marks marks);
  const ObjectMarks& object(int id) const;

  const Exec exec_;
  const Model model_;
  FrameCache recent_;
  std::vector<CachedObject> cached_objects_;
  std::vector<std::shared_ptr<const Marks>> before_, after_;
  mutable std::mutex mutex_;  // guards marks_ and shown_
  std::shared_ptr<const Marks> marks_;
  std::shared_ptr<const std::vector<ShownObject>> shown_;
};

}  // namespace ngs::live

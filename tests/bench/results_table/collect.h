#pragma once
// From the lines that a question of tests/bench/results prints to a result. Fields are separated by tabs:
//
//   meta   KEY VALUE                      question, title, commit, machine, command, defaults, seconds
//   column NAME UNIT KEY SHOW [DIGITS] [WHERE_KEY=VALUE]      DIGITS as 4, or 2g for significant ones; label has none
//   row    KEY=VALUE...                   VALUE is a number where a column shows KEY as one
//          scores=FILE                    adds iou, biou and biou_005 of a metrics.json of ngs-eval
//          times=FILE                     adds wall_s, cpu_s and peak_mib of a tool's report
//   rows   benchmark|stability FILE      see readers.h
#include <istream>

#include "result.h"

namespace ngs::results {

/// Numbers are kept to seven significant digits. Throws kBadInput for a line that is none of these, two rows with the
/// same labels and the same "run", and a file that cannot be read.
Result collect(std::istream& lines);

}  // namespace ngs::results

#pragma once
// Builds a result from the lines printed by a question of tests/bench/results. Fields are separated by tabs:
//
//   meta   KEY VALUE                      question, title, commit, machine, command, defaults, seconds
//   column NAME UNIT KEY SHOW [DIGITS] [WHERE_KEY=VALUE]      DIGITS as 4, or 2g for significant ones; label has none
//   row    KEY=VALUE...                   VALUE is a number if a non-label column shows KEY
//          scores=FILE                    adds iou, biou and biou_005 of a metrics.json of ngs-eval
//          halves=FILE                   adds the scores of a metrics.json of ngs-eval --halves (readers.h)
//          times=FILE                     adds wall_s, cpu_s and peak_mib of a tool's report
//   rows   benchmark|stability FILE      see readers.h
#include <istream>

#include "result.h"

namespace ngs::results {

/// Rounds numbers to seven significant digits. Throws kBadInput for an unknown line, two rows with the same labels and
/// "run", or an unreadable file.
Result collect(std::istream& lines);

}  // namespace ngs::results

#pragma once
// Changes a label column value by value.
#include "ngs/scene/labels/label_column.h"

namespace ngs::test {

/// value = f(value) of every row.
template <class F>
void change(LabelColumn& column, const F& f) {
  for (std::size_t row = 0; row < column.size(); ++row) column[row] = f(float(column[row]));
}

}  // namespace ngs::test

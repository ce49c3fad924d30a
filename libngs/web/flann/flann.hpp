#pragma once
// All of it is in algorithms/kdtree_single_index.h.

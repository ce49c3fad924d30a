#pragma once
// The part of OpenMP that ngs uses; omp.cpp runs it.
extern "C" {
int omp_get_num_threads();
int omp_get_thread_num();
int omp_get_max_threads();
void omp_set_num_threads(int threads);  // once, before the first parallel region
}

#include <cstdlib>

#include "ngs/os/plain_number.h"

namespace ngs::os {

// The tools keep the locale that a program starts with, "C".
float plain_strtof(const char* text, char** stop) { return std::strtof(text, stop); }
double plain_strtod(const char* text, char** stop) { return std::strtod(text, stop); }

}  // namespace ngs::os

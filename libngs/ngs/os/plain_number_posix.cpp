#include <locale.h>
#include <stdlib.h>

#include "ngs/os/plain_number.h"

namespace ngs::os {
namespace {

locale_t plain_locale() {
  static const locale_t plain = newlocale(LC_ALL_MASK, "C", nullptr);
  return plain;
}

}  // namespace

float plain_strtof(const char* text, char** stop) { return strtof_l(text, stop, plain_locale()); }
double plain_strtod(const char* text, char** stop) { return strtod_l(text, stop, plain_locale()); }

}  // namespace ngs::os

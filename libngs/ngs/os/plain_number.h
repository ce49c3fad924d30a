#pragma once
// strtof() and strtod() with '.' in every locale.

namespace ngs::os {

float plain_strtof(const char* text, char** stop);
double plain_strtod(const char* text, char** stop);

}  // namespace ngs::os

#pragma once
// File names that differ only in spelling: macOS stores "ü" as "u" and a combining mark (NFD), other systems as one
// character (NFC), and systems differ in whether case matters.
#include <string>
#include <string_view>

namespace ngs {

/// `name` (UTF-8) with composed letters of the Latin, Greek, Cyrillic, kana and Hangul scripts decomposed as in NFD,
/// and ASCII letters in lower case. Bytes that are not UTF-8 stay as they are.
std::string folded_name(std::string_view name);

/// ASCII letters in lower case.
std::string lower_case(std::string_view name);

}  // namespace ngs

// Windows: all text is UTF-8 and all files are binary, as elsewhere; abort() ends with 134, as in a shell elsewhere,
// not with 3, which is that of a file. The manifest makes UTF-8 the code page of arguments, of the environment and of
// file names; this file does the rest before main.
#include <fcntl.h>
#include <io.h>
#include <windows.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cwchar>
#include <initializer_list>

namespace {

[[gnu::constructor(101)]] void end_aborts_as_elsewhere() {
  std::signal(SIGABRT, [](int) { TerminateProcess(GetCurrentProcess(), 134); });
}

[[gnu::constructor(101)]] void prepare_streams() {
  _fmode = _O_BINARY;
  for (const int descriptor : {0, 1, 2}) _setmode(descriptor, _O_BINARY);
  std::setvbuf(stderr, nullptr, _IONBF, 0);  // a pipe would get its lines at the end
  SetConsoleOutputCP(CP_UTF8);
  for (const DWORD stream : {STD_OUTPUT_HANDLE, STD_ERROR_HANDLE}) {
    DWORD mode = 0;
    if (GetConsoleMode(GetStdHandle(stream), &mode))
      SetConsoleMode(GetStdHandle(stream), mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
  }
}

/// The code point at the start of `text`, and its length in bytes; 0: the text ends too early, -1: it is not UTF-8.
int code_point(const unsigned char* text, std::size_t bytes, unsigned& point) {
  const int length = text[0] < 0x80   ? 1
                     : text[0] < 0xC2 ? -1
                     : text[0] < 0xE0 ? 2
                     : text[0] < 0xF0 ? 3
                     : text[0] < 0xF5 ? 4
                                      : -1;
  if (length < 0) return -1;
  point = length == 1 ? text[0] : text[0] & (0x7Fu >> length);
  for (int i = 1; i < length; ++i) {
    if (std::size_t(i) == bytes) return 0;
    if ((text[i] & 0xC0) != 0x80) return -1;
    point = point << 6 | (text[i] & 0x3Fu);
  }
  const bool is_short = (length == 3 && point < 0x800) || (length == 4 && point < 0x10000);
  return is_short || point > 0x10FFFF || (point >= 0xD800 && point < 0xE000) ? -1 : length;
}

}  // namespace

// libstdc++ makes a path of a std::string by this function. That of Windows' C library cannot read UTF-8. A code point
// beyond 16 bits is two units: the first call reads all but one of its bytes, and `state` holds the second unit until
// the next.
extern "C" std::size_t mbrtowc(wchar_t* unit, const char* text, std::size_t bytes, std::mbstate_t* state) {
  static std::mbstate_t own{};
  if (state == nullptr) state = &own;
  if (text == nullptr) return *state = 0;
  if (bytes == 0) return std::size_t(-2);
  if (*state != 0) {
    if (unit != nullptr) *unit = wchar_t(*state);
    *state = 0;
    return 1;
  }
  unsigned point = 0;
  const int length = code_point(reinterpret_cast<const unsigned char*>(text), bytes, point);
  if (length == 0) return std::size_t(-2);
  if (length < 0) {
    errno = EILSEQ;
    return std::size_t(-1);
  }
  const bool is_pair = point >= 0x10000;
  if (is_pair) *state = std::mbstate_t(0xDC00 + ((point - 0x10000) & 0x3FF));
  if (unit != nullptr) *unit = wchar_t(is_pair ? 0xD800 + ((point - 0x10000) >> 10) : point);
  return point == 0 ? 0 : std::size_t(is_pair ? length - 1 : length);
}

/// In the C library this is in one object with mbrtowc.
extern "C" std::size_t mbrlen(const char* text, std::size_t bytes, std::mbstate_t* state) {
  static std::mbstate_t own{};
  return mbrtowc(nullptr, text, bytes, state != nullptr ? state : &own);
}

// Holds a file open as most programs of Windows do, which forbids others to write or replace it: tests/ci/windows-archive.sh
#include <stdio.h>
#include <windows.h>

int main(int argc, char** argv) {
  const HANDLE file = argc < 2 ? INVALID_HANDLE_VALUE
                               : CreateFileA(argv[1], GENERIC_READ, FILE_SHARE_READ, NULL, OPEN_EXISTING, 0, NULL);
  if (file == INVALID_HANDLE_VALUE) return 1;
  puts("open");
  fflush(stdout);
  Sleep(60000);
  return 0;
}

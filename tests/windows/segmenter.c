// A segmenter for ngs-mask (pipelines/segmenters/README.md) that copies masks of a folder, where view N is called
// 000N.png: segmenter.exe MASKS {image} {out} {prompts}, or segmenter.exe MASKS kept running:
// tests/ci/windows-archive.sh
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <windows.h>

/// The text of a key in a line of JSON without escapes.
static void value_of(const char* line, const char* key, char* to) {
  char start[32];
  snprintf(start, sizeof start, "\"%s\":\"", key);
  const char* begin = strstr(line, start);
  *to = 0;
  if (begin != NULL) sscanf(begin + strlen(start), "%1023[^\"]", to);
}

int main(int argc, char** argv) {
  char line[1 << 16], view[1024], out[1024], mask[2048];
  if (argc == 5) {  // the image is FOLDER/N-image.png
    const char* name = argv[2];
    for (const char* c = argv[2]; *c; ++c)
      if (*c == '/' || *c == '\\') name = c + 1;
    snprintf(mask, sizeof mask, "%s/%04d.png", argv[1], atoi(name));
    return CopyFileA(mask, argv[3], FALSE) ? 0 : 1;
  }
  while (fgets(line, sizeof line, stdin) != NULL) {
    value_of(line, "view", view), value_of(line, "out", out);
    snprintf(mask, sizeof mask, "%s/%s", argv[1], view);
    puts(CopyFileA(mask, out, FALSE) ? "{\"ok\":true}" : "{\"error\":\"no mask\"}");
    fflush(stdout);
  }
  return 0;
}

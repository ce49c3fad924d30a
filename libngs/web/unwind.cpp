// Emscripten's libunwind for threads keeps what a handler asks in a variable of the thread, where Debian's Clang 14
// writes to an address of all threads: no exception is caught. Here it is one variable. A catch (...), all that tasks
// of parallel loops have, asks nothing, so that threads do not meet in it.
#include <cstdint>

namespace {

struct Exception {
  std::uint64_t kind;
  void (*clean_up)(int reason, Exception*);
};
constexpr int kCleanUp = 2, kCaughtElsewhere = 1;

}  // namespace

extern "C" {

int __gxx_personality_wasm0(int version, int phase, std::uint64_t kind, void* exception, void* context);

struct LandingPad {
  std::uintptr_t index, data, selector;
} __wasm_lpad_context;

int _Unwind_CallPersonality(Exception* exception) {
  __wasm_lpad_context.selector = 0;
  return __gxx_personality_wasm0(1, kCleanUp, exception->kind, exception, &__wasm_lpad_context);
}
int _Unwind_RaiseException(Exception* exception) { __builtin_wasm_throw(0, exception); }
void _Unwind_DeleteException(Exception* exception) {
  if (exception->clean_up != nullptr) exception->clean_up(kCaughtElsewhere, exception);
}
void _Unwind_SetGR(void*, int index, std::uintptr_t value) {
  if (index == 1) __wasm_lpad_context.selector = value;
}
std::uintptr_t _Unwind_GetIP(void*) { return __wasm_lpad_context.index + 2; }  // counted from 1, less 1
std::uintptr_t _Unwind_GetLanguageSpecificData(void*) { return __wasm_lpad_context.data; }
std::uintptr_t _Unwind_GetRegionStart(void*) { return 0; }
void _Unwind_SetIP(void*, std::uintptr_t) {}

}  // extern "C"

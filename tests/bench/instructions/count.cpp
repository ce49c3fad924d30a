// A qemu plug-in that counts executed instructions per function. Writes a line per function, count and mangled name, to
// FILE of QEMU_PLUGIN's argument out=FILE. tests/bench/instructions.sh compiles and loads it. Declares the used part of
// qemu's include/qemu/qemu-plugin.h, version 1.
#include <cstdint>
#include <cstdio>
#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

extern "C" {

struct qemu_plugin_tb;
struct qemu_plugin_insn;
size_t qemu_plugin_tb_n_insns(const qemu_plugin_tb*);
qemu_plugin_insn* qemu_plugin_tb_get_insn(const qemu_plugin_tb*, size_t);
const char* qemu_plugin_insn_symbol(const qemu_plugin_insn*);
void qemu_plugin_register_vcpu_tb_trans_cb(std::uint64_t, void (*)(std::uint64_t, qemu_plugin_tb*));
void qemu_plugin_register_vcpu_tb_exec_inline(qemu_plugin_tb*, int operation, void* counter, std::uint64_t);
void qemu_plugin_register_atexit_cb(std::uint64_t, void (*)(std::uint64_t, void*), void*);

[[gnu::visibility("default")]] int qemu_plugin_version = 1;
}

namespace {

struct Counts {
  std::mutex mutex;
  std::map<std::string, std::uint64_t*> of;  // by function; pointers into `storage`, which are stable
  std::deque<std::uint64_t> storage;
  std::string path;
};
Counts counts;

/// Attributes a translation block to the function of its first instruction; a call ends the block.
void translated(std::uint64_t, qemu_plugin_tb* block) {
  const char* symbol = qemu_plugin_insn_symbol(qemu_plugin_tb_get_insn(block, 0));
  const std::scoped_lock lock(counts.mutex);
  std::uint64_t*& counter = counts.of[symbol == nullptr ? "?" : symbol];
  if (counter == nullptr) counter = &counts.storage.emplace_back(0);
  constexpr int kAdd = 0;
  qemu_plugin_register_vcpu_tb_exec_inline(block, kAdd, counter, qemu_plugin_tb_n_insns(block));
}

void at_exit(std::uint64_t, void*) {
  std::FILE* out = std::fopen(counts.path.c_str(), "w");
  if (out == nullptr) return std::perror(counts.path.c_str());
  for (const auto& [name, count] : counts.of)
    std::fprintf(out, "%llu %s\n", static_cast<unsigned long long>(*count), name.c_str());
  std::fclose(out);
}

}  // namespace

extern "C" [[gnu::visibility("default")]] int qemu_plugin_install(std::uint64_t id, const void*, int words,
                                                                  char** word) {
  constexpr std::string_view kOut = "out=";
  for (int i = 0; i < words; ++i)
    if (std::string_view(word[i]).substr(0, kOut.size()) == kOut) counts.path = word[i] + kOut.size();
  if (counts.path.empty()) return std::fputs("count: no out=FILE\n", stderr), 1;
  qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
  qemu_plugin_register_atexit_cb(id, at_exit, nullptr);
  return 0;
}

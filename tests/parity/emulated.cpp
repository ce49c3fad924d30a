#include "parity/emulated.h"

namespace ngs {
template class LaunchedSplatOps<test::HostLauncher>;
template class LaunchedFieldOps<test::HostLauncher>;
template class LaunchedLossOps<test::HostLauncher>;
template class LaunchedArrays<test::HostLauncher>;
}  // namespace ngs

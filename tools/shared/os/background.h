#pragma once
// Work in the background.
#include <functional>
#include <thread>

namespace ngs::os {

/// Runs `work` in a thread; in a browser, which has one, before it returns, and the thread is none.
std::thread in_background(const std::function<void()>& work);

}  // namespace ngs::os

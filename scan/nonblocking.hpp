// STATIOND_NONBLOCKING marks what the scan thread calls, after `noexcept` in the declaration; overriders and
// definitions inherit it. clang 20 and later then proves that it neither allocates, locks, throws nor calls
// what may (-Wfunction-effects), and RealtimeSanitizer watches it run (preset rtsan). Other compilers see
// nothing. Owned by nobody.
// STATIOND_TRUSTED(statement) exempts one statement from both; beside each use stands why it is harmless.
#pragma once

#if defined(__has_cpp_attribute) && defined(__clang__)
#if __has_cpp_attribute(clang::nonblocking)
#define STATIOND_HAS_NONBLOCKING
#endif
#endif

#ifdef STATIOND_HAS_NONBLOCKING
#define STATIOND_NONBLOCKING [[clang::nonblocking]]
#if __has_feature(realtime_sanitizer)
#include <sanitizer/rtsan_interface.h>
#define STATIOND_UNWATCHED const __rtsan::ScopedDisabler unwatched;
#else
#define STATIOND_UNWATCHED
#endif
#define STATIOND_TRUSTED(...)                                                                   \
  do {                                                                                          \
    _Pragma("clang diagnostic push") _Pragma("clang diagnostic ignored \"-Wfunction-effects\"") \
        STATIOND_UNWATCHED __VA_ARGS__;                                                         \
    _Pragma("clang diagnostic pop")                                                             \
  } while (false)
#else
#define STATIOND_NONBLOCKING
#define STATIOND_TRUSTED(...) \
  do {                        \
    __VA_ARGS__;              \
  } while (false)
#endif

#pragma once

/// TAUT_SANITIZED is defined in builds with checks of addresses or threads, by GCC and by clang.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TAUT_SANITIZED 1
#elif defined(__has_feature)  // clang's way to say so; libraries define it for GCC, as 0
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define TAUT_SANITIZED 1
#endif
#endif

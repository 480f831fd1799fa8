#include "scenes/program/interrupt.h"

#include <atomic>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <initializer_list>

namespace taut {
namespace {

volatile std::sig_atomic_t received = 0;
std::atomic<std::int64_t> received_at{0};  // [ns]; a signal handler may write it, being free of locks
static_assert(std::atomic<std::int64_t>::is_always_lock_free);

std::int64_t now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{1'000'000'000} * time.tv_sec + time.tv_nsec;
}

void note(int signal) {
  if (received == 0) received_at = now();
  received = signal;
}

void handle(int signal, void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

}  // namespace

InterruptGuard::InterruptGuard() {
  received = 0, received_at = 0;
  for (int signal : {SIGINT, SIGTERM}) handle(signal, note, static_cast<int>(SA_RESETHAND));
}

InterruptGuard::~InterruptGuard() {
  for (int signal : {SIGINT, SIGTERM}) handle(signal, SIG_DFL, 0);
}

int InterruptGuard::signal() { return received; }

double InterruptGuard::age() {
  const std::int64_t at = received_at;
  return at == 0 ? 0 : 1e-9 * static_cast<double>(now() - at);
}

}  // namespace taut

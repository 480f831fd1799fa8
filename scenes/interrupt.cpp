#include "scenes/interrupt.h"

#include <csignal>
#include <initializer_list>

namespace taut {
namespace {

volatile std::sig_atomic_t received = 0;

void note(int signal) { received = signal; }

void handle(int signal, void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

}  // namespace

InterruptGuard::InterruptGuard() {
  received = 0;
  for (int signal : {SIGINT, SIGTERM}) handle(signal, note, static_cast<int>(SA_RESETHAND));
}

InterruptGuard::~InterruptGuard() {
  for (int signal : {SIGINT, SIGTERM}) handle(signal, SIG_DFL, 0);
}

int InterruptGuard::signal() { return received; }

}  // namespace taut

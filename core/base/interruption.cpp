#include "core/base/interruption.h"

namespace taut::detail {
namespace {

thread_local const InterruptScope::Question* present = nullptr;

}  // namespace

InterruptScope::InterruptScope(const Question* question) : outer_(present) {
  present = question && *question ? question : nullptr;
}
InterruptScope::~InterruptScope() { present = outer_; }

const InterruptScope::Question* InterruptScope::current() { return present; }

bool interrupted() { return present && (*present)(); }

}  // namespace taut::detail

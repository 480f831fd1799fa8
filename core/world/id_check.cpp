#include "core/world/id_check.h"

#include <string>

#include "core/base/check.h"

void taut::detail::fail_for_id(const char* kind, int index) {
  fail(std::string(kind) + " id", std::string("no such ") + kind, index);
}

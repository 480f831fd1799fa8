#pragma once

#include <stdexcept>
#include <string>

namespace taut::testing {

/// What a call is refused with by std::invalid_argument; empty if it is not.
std::string refusal(auto call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

}  // namespace taut::testing

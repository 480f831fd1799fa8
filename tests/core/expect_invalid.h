#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <stdexcept>
#include <string>

namespace taut::testing {

/// Expects std::invalid_argument whose message has all `parts`: the name of the thing and its value.
template <typename Action>
void expect_invalid(Action&& action, std::initializer_list<const char*> parts) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    const std::string message = error.what();
    for (const char* part : parts)
      EXPECT_NE(message.find(part), std::string::npos) << "\"" << message << "\" lacks \"" << part << "\"";
    return;
  }
  ADD_FAILURE() << "nothing was thrown; expected a message with \"" << *parts.begin() << "\"";
}

}  // namespace taut::testing

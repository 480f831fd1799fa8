#pragma once

#include <gtest/gtest.h>

#include <string>

#include "scenes/import/imported_model.h"

/// Of models that tests write as texts.
namespace taut::testing {

inline bool notes(const ImportedModel& model, const std::string& what) {
  for (const ImportNotice& notice : model.notices)
    if (notice.text().find(what) != std::string::npos) return true;
  return false;
}

/// What `import` does throws ImportError with the message, which begins with `place`.
template <typename Import>
void expect_refused(Import import, const std::string& message, const std::string& place = "") {
  try {
    (void)import();
    ADD_FAILURE() << "is not refused: " << message;
  } catch (const ImportError& error) {
    EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).rfind(place, 0), 0u) << error.what();
  }
}

}  // namespace taut::testing

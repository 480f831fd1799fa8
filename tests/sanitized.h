#pragma once

namespace taut::testing {

/// Whether the library has checks of addresses or threads: some twenty times slower, and with a malloc of its
/// own.
bool sanitized();

}  // namespace taut::testing

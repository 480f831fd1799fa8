#include <exception>

#include "scenes/accuracy/reference_case.h"
#include "tests/fuzz/input_file.h"

// Reference cases, as `taut accuracy` reads them.

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace taut::fuzz;
  static InputFile file;
  file.set(text_of(data, size));
  try {
    const taut::reference::Case reference = taut::reference::load_case(file.path());
    reference.world.validate();
  } catch (const std::exception&) {  // anything but a crash
  }
  return 0;
}

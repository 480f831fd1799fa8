#include "scenes/files/scene_file.h"
#include "scenes/import/imported_model.h"
#include "tests/fuzz/input_file.h"

// Texts of models of robots.  What is no model is refused with file and line; what is one is a document that
// the reader of scene files takes or refuses.

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace taut;
  using namespace taut::fuzz;
  static const std::string file = source_dir() + "/scenes/examples/fuzz.xml";
  try {
    const ImportedModel model = import_model_text(text_of(data, size), file);
    if (model.document["bodies"].size() > 200) return 0;
    (void)parse_scene(model.document.dump(), file);
  } catch (const ImportError& error) {
    if (std::string_view(error.what()).find(":") == std::string_view::npos)
      found("a model was refused without a place");
  } catch (const SceneFileError& error) {
    if (error.problems().empty()) found("a scene was refused without a problem");
  }
  return 0;
}
